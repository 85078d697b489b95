#include "fab/strips/strips.h"

#include <algorithm>
#include <map>
#include <span>

#include <fmt/format.h>

#include "fab/strips/fit.h"
#include "fab/strips/split.h"
#include "fab/strips/unfold.h"

namespace leafcutter::fab {

namespace {

// Cells of the next strip that a tab may lie on, at most.
constexpr std::size_t kMostBeyond = 16;

// Tells each strip which one it goes on into; `next_quads` are the first of those.
void link_strips(const std::vector<int>& next_quads, std::span<Strip> strips) {
    std::map<int, const Strip*> by_first;
    for (const Strip& strip : strips) {
        by_first.emplace(strip.quads.front(), &strip);
    }
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const auto next = by_first.find(next_quads[i]);
        if (next_quads[i] < 0 || next == by_first.end()) {
            continue;
        }
        const std::vector<int>& quads = next->second->quads;
        const std::size_t count = std::min(kMostBeyond, quads.size());
        strips[i].next = next->second->id;
        strips[i].beyond.assign(quads.begin(), quads.begin() + static_cast<std::ptrdiff_t>(count));
    }
}

void add_strips(const geometry::QuadMesh& mesh,
                Family family,
                geometry::ThreadEnds ends,
                std::vector<Strip>& strips) {
    int number = 0;
    const std::size_t first = strips.size();
    std::vector<int> next_quads;
    for (geometry::Thread& thread : geometry::trace_threads(mesh, family, ends)) {
        Strip strip;
        strip.id = fmt::format("{}{}", family == Family::Weft ? 'W' : 'P', ++number);
        strip.family = family;
        strip.closed = thread.closed;
        strip.quads = std::move(thread.quads);
        next_quads.push_back(thread.next);
        for (const int quad : strip.quads) {
            const int cylinder = mesh.addresses[static_cast<std::size_t>(quad)].cylinder;
            const auto& known = strip.cylinders;
            if (std::find(known.begin(), known.end(), cylinder) == known.end()) {
                strip.cylinders.push_back(cylinder);
            }
        }
        strips.push_back(std::move(strip));
    }
    link_strips(next_quads, {strips.begin() + static_cast<std::ptrdiff_t>(first), strips.end()});
}

Piece to_piece(const Strip& strip, const CutPiece& cut, double tab_mm, std::string id) {
    Piece piece;
    piece.id = std::move(id);
    piece.strip = strip.id;
    piece.family = strip.family;
    piece.first_cell = cut.run.first;
    piece.cell_count = cut.run.count;
    const auto cells = static_cast<std::ptrdiff_t>(cut.run.count);
    piece.left.assign(cut.flat.left.begin(), cut.flat.left.begin() + cells + 1);
    piece.right.assign(cut.flat.right.begin(), cut.flat.right.begin() + cells + 1);
    piece.bend.assign(cut.flat.bend.begin(), cut.flat.bend.begin() + cells);
    piece.fold_deg.assign(cut.flat.fold_deg.begin(), cut.flat.fold_deg.begin() + cells);
    piece.fold_rises.assign(cut.flat.fold_rises.begin(), cut.flat.fold_rises.begin() + cells);
    piece.end_tab.length_mm = cut.has_tab ? tab_mm : 0.0;
    piece.outline = cut.fitted.outline;
    piece.cut_left = cut.fitted.left;
    piece.cut_right = cut.fitted.right;
    return piece;
}

SplitOptions split_options(const FitParams& fit, const PieceLimits& limits) {
    SplitOptions options;
    options.fit.clearance_mm = fit.clearance_mm;
    options.fit.crimp_thickness_mm = fit.crimp ? limits.thickness_mm : 0.0;
    options.fit.min_width_mm = limits.min_width_mm;
    options.fit.tab_mm = fit.tab_mm;
    options.usable_sheet = limits.usable_sheet;
    options.rotation = limits.rotation;
    options.max_piece_mm = fit.max_piece_mm;
    options.self_gap_mm = limits.self_gap_mm;
    return options;
}

}  // namespace

std::vector<Strip> make_strips(const geometry::QuadMesh& mesh, ColumnRuns columns) {
    std::vector<Strip> strips;
    const auto warp_ends = columns == ColumnRuns::Through ? geometry::ThreadEnds::Through
                                                          : geometry::ThreadEnds::AtCriticalLeaves;
    add_strips(mesh, Family::Weft, geometry::ThreadEnds::AtCriticalLeaves, strips);
    add_strips(mesh, Family::Warp, warp_ends, strips);
    return strips;
}

std::vector<Piece> make_pieces(Strip& strip,
                               const geometry::QuadMesh& mesh,
                               const PieceRules& rules,
                               std::vector<std::string>& warnings) {
    const auto& [fit, limits, crossings] = rules;
    const std::vector<WalkedCell> cells = walk_cells(mesh, strip);
    Parting parting = part_strip(mesh, cells, strip, split_options(fit, limits));
    std::vector<Piece> pieces;
    bool narrow = false;
    bool too_large = false;
    for (const CutPiece& cut : parting.pieces) {
        std::string id = fmt::format("{}.{}", strip.id, pieces.size() + 1);
        narrow = narrow || cut.fitted.narrow_rungs > 0;
        too_large = too_large || !cut.fits_sheet;
        pieces.push_back(to_piece(strip, cut, fit.tab_mm, std::move(id)));
    }
    strip.pieces.clear();
    for (const Piece& piece : pieces) {
        strip.pieces.push_back(piece.id);
    }
    const auto warn = [&](bool applies, std::string_view what) {
        if (applies) {
            warnings.push_back(fmt::format("{}: {}", strip.id, what));
        }
    };
    warn(parting.overlaps > 0, "parted where it would have lain on itself");
    warn(narrow, fmt::format("narrower than {:g} mm in places", limits.min_width_mm));
    warn(too_large, "a cell larger than the sheet");
    return pieces;
}

}  // namespace leafcutter::fab
