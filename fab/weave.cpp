#include "fab/weave.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

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

// Row -1 is the one below row 0.
std::uint8_t at(const Matrix& matrix, int row, int col) {
    const auto& line =
        matrix[(static_cast<std::size_t>(row + 1) + matrix.size() - 1) % matrix.size()];
    return line[static_cast<std::size_t>(col) % line.size()] != 0 ? 1 : 0;
}

using Edge = std::pair<int, int>;

// The quad that meets each directed edge; its neighbour meets it reversed.
std::map<Edge, int> edge_owners(const geometry::QuadMesh& mesh) {
    std::map<Edge, int> owners;
    for (std::size_t quad = 0; quad < mesh.quads.size(); ++quad) {
        const auto& corners = mesh.quads[quad];
        for (std::size_t i = 0; i < 4; ++i) {
            owners[{corners[i], corners[(i + 1) % 4]}] = static_cast<int>(quad);
        }
    }
    return owners;
}

}  // namespace

Weave weave_cells(const geometry::QuadMesh& mesh, const WeaveParams& params) {
    const Matrix matrix = pattern_matrix(params);
    Weave weave;
    weave.warp_on_top.reserve(mesh.quads.size());
    for (const geometry::QuadAddress& address : mesh.addresses) {
        weave.warp_on_top.push_back(at(matrix, address.row, address.col));
    }
    const std::map<Edge, int> owners = edge_owners(mesh);
    for (std::size_t quad = 0; quad < mesh.quads.size(); ++quad) {
        const auto& [a, b, c, d] = mesh.quads[quad];
        const geometry::QuadAddress& address = mesh.addresses[quad];
        const std::array<std::pair<Edge, std::uint8_t>, 3> next = {{
            {{c, b}, at(matrix, address.row, address.col + 1)},
            {{d, c}, at(matrix, address.row + 1, address.col)},
            {{b, a}, at(matrix, address.row - 1, address.col)},
        }};
        for (std::size_t side = 0; side < next.size(); ++side) {
            const auto neighbour = owners.find(next[side].first);
            if (neighbour == owners.end()) {
                continue;
            }
            // Across the folds of a pillowcase a column meets another one of the same row, and both
            // see the seam. Elsewhere what is below has looked up already.
            const auto other = static_cast<std::size_t>(neighbour->second);
            const bool folded = side > 0 && mesh.addresses[other].row == address.row &&
                                mesh.addresses[other].cylinder == address.cylinder;
            if (folded ? other < quad : side == 2) {
                continue;
            }
            if (weave.warp_on_top[other] != next[side].second) {
                weave.seams.push_back({static_cast<int>(quad), neighbour->second});
            }
        }
    }
    return weave;
}

}  // namespace leafcutter::fab
