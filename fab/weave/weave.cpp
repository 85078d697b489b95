#include "fab/weave/weave.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "fab/weave/pattern_starts.h"
#include "geometry/quads/quad_edges.h"

namespace leafcutter::fab {

namespace {

using Matrix = std::vector<std::vector<int>>;

constexpr std::size_t kMostShifts = 64;

// Rows of the matrix follow rows of the grid, 1 = warp on top.
Matrix pattern_matrix(const WeaveParams& params) {
    switch (params.pattern) {
        case WeavePattern::Plain:
            return {{0, 1}, {1, 0}};
        case WeavePattern::Twill2x2:
            return {{1, 1, 0, 0}, {0, 1, 1, 0}, {0, 0, 1, 1}, {1, 0, 0, 1}};
        case WeavePattern::DoubleWarp:
            return {{1}};
        case WeavePattern::DoubleWeft:
            return {{0}};
        case WeavePattern::Satin5:
            return {{1, 0, 0, 0, 0},
                    {0, 0, 1, 0, 0},
                    {0, 0, 0, 0, 1},
                    {0, 1, 0, 0, 0},
                    {0, 0, 0, 1, 0}};
        case WeavePattern::Basket2x2:
            return {{1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 1}, {0, 0, 1, 1}};
        case WeavePattern::Matrix:
            break;
    }
    return params.matrix;
}

// Of a cylinder against the pattern's own beginning.
struct Shift {
    int row = 0;
    int col = 0;
};

int wrapped(int value, std::size_t period) {
    const int size = static_cast<int>(period);
    return (value % size + size) % size;
}

std::uint8_t cell_of(const Matrix& matrix, int row, int col) {
    const auto& line = matrix[static_cast<std::size_t>(wrapped(row, matrix.size()))];
    return line[static_cast<std::size_t>(wrapped(col, line.size()))] != 0 ? 1 : 0;
}

// Whether shifted like this the pattern is the same.
bool is_period(const Matrix& matrix, int row_shift, int col_shift) {
    for (int row = 0; row < static_cast<int>(matrix.size()); ++row) {
        for (int col = 0; col < static_cast<int>(matrix.front().size()); ++col) {
            if (cell_of(matrix, row, col) != cell_of(matrix, row + row_shift, col + col_shift)) {
                return false;
            }
        }
    }
    return true;
}

// Shifts that give different patterns; only the first where there are more than can be tried.
std::vector<Shift> different_shifts(const Matrix& matrix) {
    const int rows = static_cast<int>(matrix.size());
    const int cols = static_cast<int>(matrix.front().size());
    std::vector<char> period(matrix.size() * matrix.front().size(), 0);
    const auto at = [cols](int row, int col) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) +
               static_cast<std::size_t>(col);
    };
    for (int row = 0; row < rows; ++row) {
        for (int col = 0; col < cols; ++col) {
            period[at(row, col)] = is_period(matrix, row, col) ? 1 : 0;
        }
    }
    std::vector<Shift> shifts;
    for (int row = 0; row < rows; ++row) {
        for (int col = 0; col < cols; ++col) {
            const auto like = [&](const Shift& known) {
                return period[at(wrapped(row - known.row, matrix.size()),
                                 wrapped(col - known.col, matrix.front().size()))] != 0;
            };
            if (std::none_of(shifts.begin(), shifts.end(), like)) {
                shifts.push_back({row, col});
            }
        }
    }
    shifts.resize(shifts.size() > kMostShifts ? 1 : shifts.size());
    return shifts;
}

class Weaver {
public:
    Weaver(const geometry::QuadMesh& mesh, Matrix matrix)
        : mesh_(mesh),
          matrix_(std::move(matrix)),
          shifts_(different_shifts(matrix_)),
          neighbours_(geometry::find_neighbours(mesh.quads)) {
        for (const geometry::QuadAddress& address : mesh.addresses) {
            const auto cylinder = static_cast<std::size_t>(address.cylinder);
            shift_.resize(std::max(shift_.size(), cylinder + 1));
        }
    }

    Weave run() {
        Weave weave;
        weave.shortest = shift_cylinders();
        weave.warp_on_top.reserve(mesh_.quads.size());
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            weave.warp_on_top.push_back(top(quad, shift_of(quad), Shift{}));
        }
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            for (std::size_t side = 0; side < 4; ++side) {
                const geometry::QuadSide& behind = seen_from(quad, side);
                if (behind.quad >= 0 && breaks(quad, side, shift_of(quad), shift_behind(behind))) {
                    weave.seams.push_back({static_cast<int>(quad), behind.quad});
                    weave.seam_mm += side_length(quad, side);
                }
            }
        }
        return weave;
    }

private:
    // What lies behind the sides a-b, b-c, c-d and d-a of a quad.
    static constexpr std::array<Shift, 4> kSteps{{{-1, 0}, {0, 1}, {1, 0}, {0, -1}}};

    std::size_t cylinder_of(std::size_t quad) const {
        return static_cast<std::size_t>(mesh_.addresses[quad].cylinder);
    }
    const Shift& shift_of(std::size_t quad) const { return shift_[cylinder_of(quad)]; }
    const Shift& shift_behind(const geometry::QuadSide& behind) const {
        return shift_of(static_cast<std::size_t>(behind.quad));
    }

    // 1 where the pattern says warp, a step aside from the quad.
    std::uint8_t top(std::size_t quad, const Shift& shift, const Shift& step) const {
        const geometry::QuadAddress& address = mesh_.addresses[quad];
        return cell_of(matrix_, address.row + shift.row + step.row,
                       address.col + shift.col + step.col);
    }

    // Whether the pattern of either side of an edge does not go on behind it.
    bool breaks(std::size_t quad, std::size_t side, const Shift& own, const Shift& others) const {
        const geometry::QuadSide& behind = neighbours_.across[quad][side];
        const auto other = static_cast<std::size_t>(behind.quad);
        const Shift& back = kSteps[static_cast<std::size_t>(behind.side)];
        return top(other, others, Shift{}) != top(quad, own, kSteps[side]) ||
               top(quad, own, Shift{}) != top(other, others, back);
    }

    double side_length(std::size_t quad, std::size_t side) const {
        const auto& corners = mesh_.quads[quad];
        const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& {
            return mesh_.vertices[static_cast<std::size_t>(corners[i % 4])];
        };
        return (corner(side + 1) - corner(side)).norm();
    }

    // What lies behind a side, for one of the two quads that meet there: the one below or to the
    // left. Where two lower or two upper sides meet, at folds and junctions, the first.
    geometry::QuadSide seen_from(std::size_t quad, std::size_t side) const {
        const geometry::QuadSide& behind = neighbours_.across[quad][side];
        const bool forward = side == 1 || side == 2;
        const bool back = behind.side == 1 || behind.side == 2;
        const bool looks =
            behind.quad >= 0 && (forward == back ? static_cast<int>(quad) < behind.quad : forward);
        return looks ? behind : geometry::QuadSide{};
    }

    // Where cells are shared between cylinders, each begins the pattern where it goes on best, all
    // in all. Returns whether no other beginnings break it at fewer places.
    bool shift_cylinders() {
        using Cylinders = std::pair<std::size_t, std::size_t>;
        std::map<Cylinders, std::vector<std::pair<std::size_t, std::size_t>>> junctions;
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            for (std::size_t side = 0; side < 4; ++side) {
                const geometry::QuadSide behind = seen_from(quad, side);
                if (behind.quad < 0) {
                    continue;
                }
                const std::size_t other = cylinder_of(static_cast<std::size_t>(behind.quad));
                if (other != cylinder_of(quad)) {
                    junctions[{cylinder_of(quad), other}].emplace_back(quad, side);
                }
            }
        }
        std::vector<StartCost> costs;
        for (const auto& [cylinders, sides] : junctions) {
            costs.push_back(
                {static_cast<int>(cylinders.first), static_cast<int>(cylinders.second), {}});
            for (const Shift& one : shifts_) {
                for (const Shift& other : shifts_) {
                    costs.back().cost.push_back(static_cast<double>(
                        std::count_if(sides.begin(), sides.end(), [&](const auto& place) {
                            return breaks(place.first, place.second, one, other);
                        })));
                }
            }
        }
        const PatternStarts starts =
            choose_starts(static_cast<int>(shift_.size()), static_cast<int>(shifts_.size()), costs);
        for (std::size_t cylinder = 0; cylinder < shift_.size(); ++cylinder) {
            shift_[cylinder] = shifts_[static_cast<std::size_t>(starts.start[cylinder])];
        }
        return starts.proven && (shifts_.size() > 1 || is_constant());
    }

    // Every beginning gives the same.
    bool is_constant() const { return is_period(matrix_, 0, 1) && is_period(matrix_, 1, 0); }

    const geometry::QuadMesh& mesh_;
    Matrix matrix_;
    std::vector<Shift> shifts_;
    geometry::QuadNeighbours neighbours_;
    std::vector<Shift> shift_;  // Per cylinder.
};

}  // namespace

Weave weave_cells(const geometry::QuadMesh& mesh, const WeaveParams& params) {
    return Weaver(mesh, pattern_matrix(params)).run();
}

int pattern_period(const WeaveParams& params) {
    return static_cast<int>(pattern_matrix(params).front().size());
}

}  // namespace leafcutter::fab
