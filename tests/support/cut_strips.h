// Strips of a quad mesh parted into pieces by rule, without unfolding: for tests of what only asks
// where joints are.

#pragma once

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "fab/strips/strip.h"
#include "fab/strips/windings.h"
#include "geometry/quads/threads.h"

namespace leafcutter::test {

struct Cutting {
    int most_cells = 1 << 20;  // Of a piece.
    std::function<int(int strip)> opening = [](int) {
        return 0;
    };                     // Cell that closed ones begin at.
    double tab_mm = 0.5;   // A cell is 1 mm long.
    bool through = false;  // Warp strips go on through critical leaves, however far.
};

struct CutStrips {
    std::vector<fab::Strip> strips;
    std::vector<fab::Piece> pieces;
};

inline std::vector<fab::Strip> whole_strips(const geometry::QuadMesh& mesh, bool through) {
    std::vector<fab::Strip> strips;
    for (const fab::Family family : {fab::Family::Weft, fab::Family::Warp}) {
        const auto threads = geometry::trace_threads(
            mesh, family,
            through ? geometry::ThreadEnds::Through : geometry::ThreadEnds::AtCriticalLeaves);
        const char letter = family == fab::Family::Weft ? 'W' : 'P';
        for (std::size_t i = 0; i < threads.size(); ++i) {
            fab::Strip strip;
            strip.id = fmt::format("{}{}", letter, i + 1);
            strip.family = family;
            strip.closed = threads[i].closed;
            strip.quads = threads[i].quads;
            const auto next = std::find_if(threads.begin(), threads.end(), [&](const auto& t) {
                return t.quads.front() == threads[i].next;
            });
            if (threads[i].next >= 0 && next != threads.end()) {
                strip.next = fmt::format("{}{}", letter, next - threads.begin() + 1);
            }
            strips.push_back(std::move(strip));
        }
    }
    return strips;
}

inline CutStrips cut_strips(const geometry::QuadMesh& mesh, const Cutting& cutting = {}) {
    CutStrips result;
    result.strips = whole_strips(mesh, cutting.through);
    for (std::size_t i = 0; i < result.strips.size(); ++i) {
        fab::Strip& strip = result.strips[i];
        const int count = static_cast<int>(strip.quads.size());
        const std::vector<int> windings = fab::winding_joints(mesh, strip);
        const int first = !windings.empty() ? windings.front()
                          : strip.closed    ? cutting.opening(static_cast<int>(i)) % count
                                            : 0;
        for (int done = 0; done < count;) {
            fab::Piece piece;
            piece.id = fmt::format("{}.{}", strip.id, strip.pieces.size() + 1);
            piece.strip = strip.id;
            piece.family = strip.family;
            piece.first_cell = (first + done) % count;
            piece.cell_count = std::min(cutting.most_cells, count - done);
            for (const int cell : windings) {
                const int behind = (cell - piece.first_cell + count) % count;
                piece.cell_count =
                    behind > 0 ? std::min(piece.cell_count, behind) : piece.cell_count;
            }
            for (int rung = 0; rung <= piece.cell_count; ++rung) {
                piece.left.emplace_back(rung, 0.5);
                piece.right.emplace_back(rung, -0.5);
            }
            done += piece.cell_count;
            const bool joined = done < count || strip.closed || !strip.next.empty();
            piece.end_tab.length_mm = joined ? cutting.tab_mm : 0.0;
            strip.pieces.push_back(piece.id);
            result.pieces.push_back(std::move(piece));
        }
    }
    return result;
}

}  // namespace leafcutter::test
