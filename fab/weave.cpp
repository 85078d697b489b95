#include "fab/weave.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "geometry/quads/quad_edges.h"

namespace leafcutter::fab {

namespace {

using Matrix = std::vector<std::vector<int>>;

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

class Weaver {
public:
    Weaver(const geometry::QuadMesh& mesh, Matrix matrix)
        : mesh_(mesh),
          matrix_(std::move(matrix)),
          neighbours_(geometry::find_neighbours(mesh.quads)) {
        for (const geometry::QuadAddress& address : mesh.addresses) {
            const auto cylinder = static_cast<std::size_t>(address.cylinder);
            shifts_.resize(std::max(shifts_.size(), cylinder + 1));
        }
    }

    Weave run() {
        shift_cylinders();
        Weave weave;
        weave.warp_on_top.reserve(mesh_.quads.size());
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            weave.warp_on_top.push_back(top(quad, shift_of(quad), Shift{}));
        }
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            for (std::size_t side = 0; side < 4; ++side) {
                const std::size_t other = seen_from(quad, side);
                if (other < mesh_.quads.size() &&
                    weave.warp_on_top[other] != top(quad, shift_of(quad), kSteps[side])) {
                    weave.seams.push_back({static_cast<int>(quad), static_cast<int>(other)});
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
    const Shift& shift_of(std::size_t quad) const { return shifts_[cylinder_of(quad)]; }

    // 1 where the pattern says warp, a step aside from the quad.
    std::uint8_t top(std::size_t quad, const Shift& shift, const Shift& step) const {
        const geometry::QuadAddress& address = mesh_.addresses[quad];
        const auto wrapped = [](int value, std::size_t size) {
            const int period = static_cast<int>(size);
            return static_cast<std::size_t>((value % period + period) % period);
        };
        const auto& line = matrix_[wrapped(address.row + shift.row + step.row, matrix_.size())];
        return line[wrapped(address.col + shift.col + step.col, line.size())] != 0 ? 1 : 0;
    }

    // The quad behind a side, if this is the one of the two that looks: the one below or to the
    // left. Where two lower or two upper sides meet, at folds and junctions, the first.
    std::size_t seen_from(std::size_t quad, std::size_t side) const {
        const geometry::QuadSide& behind = neighbours_.across[quad][side];
        const bool forward = side == 1 || side == 2;
        const bool back = behind.side == 1 || behind.side == 2;
        const auto other = static_cast<std::size_t>(behind.quad);
        const bool looks = behind.quad >= 0 && (forward == back ? quad < other : forward);
        return looks ? other : mesh_.quads.size();
    }

    // Where cells are shared between cylinders, each cylinder begins the pattern so that it goes on
    // from those before it, as far as it can.
    void shift_cylinders() {
        const auto junctions = pairs_across();
        std::vector<char> placed(shifts_.size(), 0);
        for (std::size_t first = 0; first < placed.size(); ++first) {
            if (placed[first] != 0) {
                continue;
            }
            placed[first] = 1;
            std::vector<std::size_t> queue{first};
            for (std::size_t i = 0; i < queue.size(); ++i) {
                for (const auto& [key, pairs] : junctions) {
                    if (key.first == queue[i] && placed[key.second] == 0) {
                        placed[key.second] = 1;
                        shifts_[key.second] = best_shift(pairs);
                        queue.push_back(key.second);
                    }
                }
            }
        }
    }

    struct Pair {
        std::size_t quad = 0;
        std::size_t side = 0;
        std::size_t other = 0;
    };
    using Junctions = std::map<std::pair<std::size_t, std::size_t>, std::vector<Pair>>;

    // Neighbouring quads of different cylinders, from both.
    Junctions pairs_across() const {
        Junctions junctions;
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            for (std::size_t side = 0; side < 4; ++side) {
                const int behind = neighbours_.across[quad][side].quad;
                const auto other = static_cast<std::size_t>(behind);
                if (behind >= 0 && cylinder_of(other) != cylinder_of(quad)) {
                    junctions[{cylinder_of(quad), cylinder_of(other)}].push_back(
                        {quad, side, other});
                }
            }
        }
        return junctions;
    }

    Shift best_shift(const std::vector<Pair>& pairs) const {
        Shift best;
        std::size_t most = 0;
        for (int row = 0; row < static_cast<int>(matrix_.size()); ++row) {
            for (int col = 0; col < static_cast<int>(matrix_.front().size()); ++col) {
                const Shift shift{row, col};
                const auto goes_on = [&](const Pair& pair) {
                    return top(pair.other, shift, Shift{}) ==
                           top(pair.quad, shift_of(pair.quad), kSteps[pair.side]);
                };
                const auto count =
                    static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), goes_on));
                if (count > most) {
                    most = count;
                    best = shift;
                }
            }
        }
        return best;
    }

    const geometry::QuadMesh& mesh_;
    Matrix matrix_;
    geometry::QuadNeighbours neighbours_;
    std::vector<Shift> shifts_;  // Per cylinder.
};

}  // namespace

Weave weave_cells(const geometry::QuadMesh& mesh, const WeaveParams& params) {
    return Weaver(mesh, pattern_matrix(params)).run();
}

}  // namespace leafcutter::fab
