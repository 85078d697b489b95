// Which rotations a part may have on its sheet: any, single angles, or intervals of angles.

#pragma once

#include <cstddef>
#include <initializer_list>
#include <numbers>
#include <span>
#include <vector>

namespace leafcutter::fab {

inline constexpr double kDegree = std::numbers::pi / 180.0;  // In radians.

// Degrees, counter-clockwise; from <= to. A single angle where both are the same.
struct AngleInterval {
    double from_deg = 0.0;
    double to_deg = 0.0;
};

class Rotations {
public:
    Rotations() = default;  // Any.
    Rotations(std::initializer_list<double> angles_deg);
    explicit Rotations(const std::vector<double>& angles_deg);  // Empty: any.
    explicit Rotations(std::vector<AngleInterval> intervals);   // Empty or a whole turn: any.

    bool empty() const { return intervals_.empty(); }  // Any rotation is allowed.
    bool is_list() const;                              // Single angles only.
    std::size_t size() const { return intervals_.size(); }
    double operator[](std::size_t i) const { return intervals_[i].from_deg; }
    double front() const { return intervals_.front().from_deg; }
    std::span<const AngleInterval> intervals() const { return intervals_; }

    bool allows(double angle_deg, double tolerance_deg) const;
    double nearest(double angle_deg) const;

    // As much of a turn by `by_deg` as does not leave the interval of `angle_deg`, which is
    // allowed.
    double step(double angle_deg, double by_deg) const;

    // The allowed angle at a share in [0, 1) of all intervals put together; single angles count as
    // much as one degree.
    double at_share(double share) const;

    // Single angles that stand for all: those of a list, and of intervals the ends and some
    // between.
    std::vector<double> samples() const;

    // For a sheet that is itself turned by `-by_deg`.
    Rotations shifted(double by_deg) const;

private:
    std::vector<AngleInterval> intervals_;
};

}  // namespace leafcutter::fab
