#include "geometry/reached_points.h"

#include <array>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "geometry/closest_point.h"
#include "geometry/error.h"
#include "geometry/surface_distance.h"

namespace leafcutter::geometry {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

std::size_t at(Eigen::Index index) {
    return static_cast<std::size_t>(index);
}

// Rows are taken in one after the other, each by the cheapest alternating path. Row and column 0 of
// its tables stand for none.
class Assignment {
public:
    explicit Assignment(const Eigen::MatrixXd& cost)
        : cost_(cost),
          row_price_(at(cost.rows()) + 1, 0.0),
          column_price_(at(cost.cols()) + 1, 0.0),
          row_of_(at(cost.cols()) + 1, 0) {
        for (std::size_t row = 1; row < row_price_.size(); ++row) {
            take_in(row);
        }
    }

    std::vector<int> columns() const {
        std::vector<int> columns(row_price_.size() - 1, -1);
        for (std::size_t column = 1; column < row_of_.size(); ++column) {
            if (row_of_[column] > 0) {
                columns[row_of_[column] - 1] = static_cast<int>(column) - 1;
            }
        }
        return columns;
    }

private:
    double slack(std::size_t row, std::size_t column) const {
        return cost_(static_cast<Eigen::Index>(row) - 1, static_cast<Eigen::Index>(column) - 1) -
               row_price_[row] - column_price_[column];
    }

    void take_in(std::size_t row) {
        row_of_[0] = row;
        least_.assign(row_of_.size(), kFar);
        before_.assign(row_of_.size(), 0);
        used_.assign(row_of_.size(), 0);
        std::size_t column = 0;
        do {
            column = grow_tree(column);
        } while (row_of_[column] != 0);
        while (column != 0) {
            row_of_[column] = row_of_[before_[column]];
            column = before_[column];
        }
    }

    // Adds a column to the tree; returns the one to add next.
    std::size_t grow_tree(std::size_t column) {
        used_[column] = 1;
        std::size_t next = 0;
        double step = kFar;
        for (std::size_t c = 1; c < row_of_.size(); ++c) {
            if (used_[c] != 0) {
                continue;
            }
            const double now = slack(row_of_[column], c);
            if (now < least_[c]) {
                least_[c] = now;
                before_[c] = column;
            }
            if (least_[c] < step) {
                step = least_[c];
                next = c;
            }
        }
        for (std::size_t c = 0; c < row_of_.size(); ++c) {
            if (used_[c] != 0) {
                row_price_[row_of_[c]] += step;
                column_price_[c] -= step;
            } else {
                least_[c] -= step;
            }
        }
        return next;
    }

    const Eigen::MatrixXd& cost_;
    std::vector<double> row_price_;
    std::vector<double> column_price_;
    std::vector<std::size_t> row_of_;  // Per column.
    std::vector<double> least_;
    std::vector<std::size_t> before_;
    std::vector<char> used_;
};

}  // namespace

std::vector<int> assign_columns(const Eigen::MatrixXd& cost) {
    return Assignment(cost).columns();
}

std::vector<ReachedPoint> reached_points(const TriangleMesh& mesh,
                                         std::span<const int> wanted,
                                         std::span<const Eigen::Vector3d> points,
                                         const Context& context) {
    if (wanted.size() > points.size()) {
        throw Error(ErrorKind::BadOption, "too-many-near",
                    fmt::format("foliation.singularities: {} wanted, but this foliation has {}; "
                                "ask for fewer, or choose another foliation.mode",
                                wanted.size(), points.size()));
    }
    std::vector<int> triangle_of;
    const ClosestPoint closest(mesh);
    for (const Eigen::Vector3d& point : points) {
        triangle_of.push_back(closest.query(point).triangle);
    }
    SurfaceDistance search(mesh);
    Eigen::MatrixXd distance(wanted.size(), points.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        context.check();
        std::vector<double> of_vertex(mesh.positions.size(), kFar);
        for (const SurfaceDistance::Reached& reached : search.from(wanted.subspan(k, 1))) {
            of_vertex[static_cast<std::size_t>(reached.vertex)] = reached.distance;
        }
        for (std::size_t p = 0; p < points.size(); ++p) {
            std::array<Eigen::Vector3d, 3> corners;
            std::array<double, 3> distances{};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto v = static_cast<std::size_t>(
                    mesh.triangles[static_cast<std::size_t>(triangle_of[p])][i]);
                corners[i] = mesh.positions[v];
                distances[i] = of_vertex[v];
            }
            distance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)) =
                distance_inside(corners, distances, points[p]);
        }
    }
    std::vector<ReachedPoint> reached;
    const std::vector<int> chosen = assign_columns(distance.cwiseAbs2());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        reached.push_back(
            {wanted[k], chosen[k], distance(static_cast<Eigen::Index>(k), chosen[k])});
    }
    return reached;
}

}  // namespace leafcutter::geometry
