// An order of assembly that is easy to see through: cylinder by cylinder all warp strips, then the
// weft strips, each closed at once; joints between cylinders last. Nobody has asked whether hands
// can do it.

#pragma once

#include <algorithm>
#include <set>

#include "fab/weave/assembly.h"

namespace leafcutter::test {

inline fab::Assembly simple_assembly(const geometry::QuadMesh& mesh,
                                     const std::vector<fab::Strip>& strips,
                                     const std::vector<fab::Piece>& pieces) {
    using fab::AssemblyMove;
    using fab::MoveKind;
    fab::Assembly assembly;
    std::set<int> placed;
    const auto joint = [](int region, std::size_t strip, const std::string& piece,
                          const std::string& onto) {
        AssemblyMove move;
        move.kind = MoveKind::Join;
        move.region = region;
        move.strip = static_cast<int>(strip);
        move.piece = piece;
        move.onto = onto;
        return move;
    };
    const auto tab_of = [&](const std::string& id) -> std::string {
        for (const fab::Piece& piece : pieces) {
            if (piece.id == id) {
                return piece.end_tab.length_mm > 0.0 ? piece.end_tab.onto : std::string();
            }
        }
        return {};
    };
    for (std::size_t cylinder = 0; cylinder < mesh.grids.size(); ++cylinder) {
        if (mesh.grids[cylinder].rows == 0) {
            continue;
        }
        const int region = static_cast<int>(assembly.regions.size());
        assembly.regions.emplace_back();
        assembly.regions.back().cylinders = {static_cast<int>(cylinder)};
        for (const fab::Family family : {fab::Family::Warp, fab::Family::Weft}) {
            for (std::size_t i = 0; i < strips.size(); ++i) {
                const fab::Strip& strip = strips[i];
                const auto& quad = static_cast<std::size_t>(strip.quads.front());
                if (strip.family != family ||
                    mesh.addresses[quad].cylinder != static_cast<int>(cylinder)) {
                    continue;
                }
                for (std::size_t k = 0; k + 1 < strip.pieces.size(); ++k) {
                    assembly.moves.push_back(
                        joint(region, i, strip.pieces[k], strip.pieces[k + 1]));
                }
                AssemblyMove lay;
                lay.region = region;
                lay.strip = static_cast<int>(i);
                lay.pieces = strip.pieces;
                for (std::size_t cell = 0; family == fab::Family::Weft && cell < strip.quads.size();
                     ++cell) {
                    lay.cells.push_back(static_cast<int>(cell));
                }
                assembly.moves.push_back(lay);
                ++assembly.laid;
                if (strip.closed && !strip.pieces.empty()) {
                    assembly.moves.push_back(
                        joint(region, i, strip.pieces.back(), strip.pieces.front()));
                    assembly.moves.back().kind = MoveKind::Close;
                    assembly.moves.back().in_place = true;
                }
            }
        }
    }
    for (std::size_t i = 0; i < strips.size(); ++i) {
        if (strips[i].next.empty() || strips[i].pieces.empty()) {
            continue;
        }
        const std::string onto = tab_of(strips[i].pieces.back());
        if (!onto.empty()) {
            const int last = static_cast<int>(assembly.regions.size()) - 1;
            assembly.moves.push_back(joint(last, i, strips[i].pieces.back(), onto));
            assembly.moves.back().in_place = true;
        }
    }
    return assembly;
}

}  // namespace leafcutter::test
