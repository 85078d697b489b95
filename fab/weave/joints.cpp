#include "fab/weave/joints.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <unordered_map>

namespace leafcutter::fab {

namespace {

constexpr double kTouchMm = 1e-6;

Eigen::Vector2d middle(const Piece& piece, std::size_t rung) {
    return 0.5 * (piece.left[rung] + piece.right[rung]);
}

}  // namespace

std::vector<std::vector<int>> pieces_of_strips(std::span<const Strip> strips,
                                               std::span<const Piece> pieces) {
    std::unordered_map<std::string_view, int> numbers;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        numbers.emplace(pieces[i].id, static_cast<int>(i));
    }
    std::vector<std::vector<int>> result;
    for (const Strip& strip : strips) {
        result.emplace_back();
        for (const std::string& id : strip.pieces) {
            result.back().push_back(numbers.at(id));
        }
    }
    return result;
}

std::vector<StripJoint> joints_of(std::span<const Strip> strips, std::span<const Piece> pieces) {
    const std::vector<std::vector<int>> own = pieces_of_strips(strips, pieces);
    std::unordered_map<std::string_view, int> numbers;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        numbers.emplace(strips[i].id, static_cast<int>(i));
    }
    std::vector<StripJoint> joints;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const int strip = static_cast<int>(i);
        const auto join = [&](int piece, int onto) {
            joints.push_back(
                {piece, onto, strip, strip, pieces[static_cast<std::size_t>(onto)].first_cell});
        };
        for (std::size_t k = 0; k + 1 < own[i].size(); ++k) {
            join(own[i][k], own[i][k + 1]);
        }
        const auto next = numbers.find(strips[i].next);
        if (own[i].empty()) {
            continue;
        }
        if (strips[i].closed) {
            join(own[i].back(), own[i].front());
        } else if (next != numbers.end()) {
            const auto& others = own[static_cast<std::size_t>(next->second)];
            joints.push_back({own[i].back(), others.front(), strip, next->second, -1});
        }
    }
    return joints;
}

int cells_under_tab(const StripJoint& joint, std::span<const Piece> pieces) {
    const Piece& onto = pieces[static_cast<std::size_t>(joint.onto)];
    const double tab = std::max(pieces[static_cast<std::size_t>(joint.piece)].end_tab.length_mm,
                                onto.start_tab.length_mm);
    double length = 0.0;
    int cells = 0;
    while (cells < onto.cell_count && length < tab - kTouchMm) {
        const auto rung = static_cast<std::size_t>(cells);
        length += (middle(onto, rung + 1) - middle(onto, rung)).norm();
        ++cells;
    }
    return cells;
}

}  // namespace leafcutter::fab
