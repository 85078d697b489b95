#include "fab/weave/weave.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "fab/weave/pattern_starts.h"
#include "geometry/quads/quad_edges.h"

namespace leafcutter::fab {

namespace {

using Matrix = PatternMatrix;

constexpr std::size_t kMostShifts = 64;

// Of a cylinder against the pattern's own beginning.
struct Shift {
    int row = 0;
    int col = 0;
    bool turned = false;  // By 180 degrees.
};

struct Step {
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

std::uint8_t shifted_cell(const Matrix& matrix, const Shift& shift, int row, int col) {
    const int way = shift.turned ? -1 : 1;
    return cell_of(matrix, shift.row + way * row, shift.col + way * col);
}

bool same_pattern(const Matrix& matrix, const Shift& one, const Shift& other) {
    for (int row = 0; row < static_cast<int>(matrix.size()); ++row) {
        for (int col = 0; col < static_cast<int>(matrix.front().size()); ++col) {
            if (shifted_cell(matrix, one, row, col) != shifted_cell(matrix, other, row, col)) {
                return false;
            }
        }
    }
    return true;
}

// Beginnings that give different patterns; only the first where there are more than can be tried.
std::vector<Shift> different_shifts(const Matrix& matrix) {
    const int rows = static_cast<int>(matrix.size());
    const int cols = static_cast<int>(matrix.front().size());
    std::vector<Shift> shifts;
    for (const bool turned : {false, true}) {
        for (int row = 0; row < rows; ++row) {
            for (int col = 0; col < cols; ++col) {
                const Shift shift{row, col, turned};
                const auto like = [&](const Shift& known) {
                    return same_pattern(matrix, known, shift);
                };
                if (shifts.size() <= kMostShifts &&
                    std::none_of(shifts.begin(), shifts.end(), like)) {
                    shifts.push_back(shift);
                }
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
            weave.warp_on_top.push_back(top(quad, shift_of(quad), Step{}));
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
    static constexpr std::array<Step, 4> kSteps{{{-1, 0}, {0, 1}, {1, 0}, {0, -1}}};

    std::size_t cylinder_of(std::size_t quad) const {
        return static_cast<std::size_t>(mesh_.addresses[quad].cylinder);
    }
    const Shift& shift_of(std::size_t quad) const { return shift_[cylinder_of(quad)]; }
    const Shift& shift_behind(const geometry::QuadSide& behind) const {
        return shift_of(static_cast<std::size_t>(behind.quad));
    }

    // 1 where the pattern says warp, a step aside from the quad.
    std::uint8_t top(std::size_t quad, const Shift& shift, const Step& step) const {
        const geometry::QuadAddress& address = mesh_.addresses[quad];
        return shifted_cell(matrix_, shift, address.row + step.row, address.col + step.col);
    }

    // Whether the pattern of either side of an edge does not go on behind it.
    bool breaks(std::size_t quad, std::size_t side, const Shift& own, const Shift& others) const {
        const geometry::QuadSide& behind = neighbours_.across[quad][side];
        const auto other = static_cast<std::size_t>(behind.quad);
        const Step& back = kSteps[static_cast<std::size_t>(behind.side)];
        return top(other, others, Step{}) != top(quad, own, kSteps[side]) ||
               top(quad, own, Step{}) != top(other, others, back);
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
    bool is_constant() const {
        return same_pattern(matrix_, {}, {0, 1, false}) && same_pattern(matrix_, {}, {1, 0, false});
    }

    const geometry::QuadMesh& mesh_;
    Matrix matrix_;
    std::vector<Shift> shifts_;
    geometry::QuadNeighbours neighbours_;
    std::vector<Shift> shift_;  // Per cylinder.
};

}  // namespace

Weave weave_cells(const geometry::QuadMesh& mesh, const WeaveParams& params) {
    const std::optional<int> limit = float_limit(params);
    Weave weave = Weaver(mesh, pattern_matrix(params)).run();
    weave.floats = limit_floats(mesh, limit, weave.warp_on_top);
    return weave;
}

}  // namespace leafcutter::fab
