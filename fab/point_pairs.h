// Which points of the plane go where, summed up for the motion that takes them there as well as
// least squares can: Umeyama, "Least-squares estimation of transformation parameters between two
// point patterns", IEEE PAMI 13(4), 1991.

#pragma once

#include <Eigen/Core>

#include "geometry/plane.h"

namespace leafcutter::fab {

class PointPairs {
public:
    void add(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
        ++count_;
        from_sum_ += from;
        to_sum_ += to;
        from_squares_ += from.squaredNorm();
        to_squares_ += to.squaredNorm();
        dots_ += from.dot(to);
        crosses_ += geometry::turn_of(from, to);
    }

    // Not before the first pair.
    double count() const { return count_; }
    Eigen::Vector2d from() const { return from_sum_ / count_; }
    Eigen::Vector2d to() const { return to_sum_ / count_; }

    // Sums about the means: of squares, and of products, whose direction is the cosine and the sine
    // of the best turn.
    double from_squares() const { return from_squares_ - count_ * from().squaredNorm(); }
    double to_squares() const { return to_squares_ - count_ * to().squaredNorm(); }
    Eigen::Vector2d products() const {
        const Eigen::Vector2d p = from();
        const Eigen::Vector2d q = to();
        return {dots_ - count_ * p.dot(q), crosses_ - count_ * geometry::turn_of(p, q)};
    }

private:
    double count_ = 0.0;
    Eigen::Vector2d from_sum_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d to_sum_ = Eigen::Vector2d::Zero();
    double from_squares_ = 0.0;
    double to_squares_ = 0.0;
    double dots_ = 0.0;
    double crosses_ = 0.0;
};

}  // namespace leafcutter::fab
