#include "fab/strips/strips.h"

#include <algorithm>
#include <map>
#include <span>
#include <type_traits>

#include <fmt/format.h>

#include "fab/strips/fit.h"
#include "fab/strips/notches.h"
#include "fab/strips/split.h"
#include "fab/strips/unfold.h"
#include "fab/strips/windings.h"
#include "fab/weave/thickness.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Cells of the next strip that a tab may lie on, at most.
constexpr std::size_t kMostBeyond = 16;

// Widening by less is not worth telling.
constexpr double kToldMm = 0.05;

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
        const auto place = static_cast<std::size_t>(next->second - strips.data());
        strips[place].follows = true;
        strips[i].beyond.assign(quads.begin(), quads.begin() + static_cast<std::ptrdiff_t>(count));
    }
}

void add_strips(const geometry::QuadMesh& mesh,
                Family family,
                std::vector<geometry::Thread> threads,
                std::vector<Strip>& strips) {
    int number = 0;
    const std::size_t first = strips.size();
    std::vector<int> next_quads;
    for (geometry::Thread& thread : threads) {
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

Piece to_piece(const Strip& strip, CutPiece& cut, double kerf_mm, std::string id) {
    Piece piece;
    piece.id = std::move(id);
    piece.strip = strip.id;
    piece.family = strip.family;
    piece.first_cell = cut.run.first;
    piece.cell_count = cut.run.count;
    const auto own = [&](const auto& values, int more) {
        const auto begin = values.begin() + cut.before;
        return std::decay_t<decltype(values)>(begin, begin + cut.run.count + more);
    };
    piece.left = own(cut.flat.left, 1);
    piece.right = own(cut.flat.right, 1);
    piece.bend = own(cut.flat.bend, 0);
    piece.fold_deg = own(cut.flat.fold_deg, 0);
    piece.fold_rises = own(cut.flat.fold_rises, 0);
    piece.start_tab.length_mm = cut.fitted.start_tab_mm;
    piece.end_tab.length_mm = cut.fitted.end_tab_mm;
    if (cut.fitted.arrow) {
        piece.end_tab.slit_at_mm = cut.fitted.arrow->slit_at_mm;
        piece.end_tab.slit_width_mm = cut.fitted.arrow->slit_width_mm;
    }
    piece.outline = without_notches(cut.fitted.outline, kerf_mm);
    piece.cut_left = std::move(cut.fitted.left);
    piece.cut_right = std::move(cut.fitted.right);
    return piece;
}

double mean_width(const Unfolded& flat) {
    double sum = 0.0;
    for (std::size_t i = 0; i < flat.left.size(); ++i) {
        sum += (flat.left[i] - flat.right[i]).norm();
    }
    return sum / static_cast<double>(flat.left.size());
}

// Crimp allowance per cell of the strip.
std::vector<double> crimp_of(const Unfolded& flat, const Strip& strip, const PieceRules& rules) {
    std::vector<double> lengths;
    for (std::size_t i = 0; i < strip.quads.size(); ++i) {
        lengths.push_back(
            (flat.left[i + 1] + flat.right[i + 1] - flat.left[i] - flat.right[i]).norm() / 2.0);
    }
    const CrimpRule rule{.own_mm = rules.limits.thickness_mm,
                         .crossed_mm = rules.limits.crossed_mm,
                         .gap_mm = 2.0 * rules.fit.clearance_mm,
                         .min_radius_mm = rules.limits.min_radius_mm};
    std::vector<double> extra = crimp_extra_mm(rules.crossings, lengths, rule, strip.closed);
    for (std::size_t i = 0; i < extra.size(); ++i) {
        extra[i] = std::min(extra[i], kMaxCrimp * lengths[i]);
    }
    return extra;
}

SplitOptions split_options(const FitParams& fit, const PieceLimits& limits) {
    SplitOptions options;
    options.clearance_mm = fit.clearance_mm;
    options.min_width_mm = limits.min_width_mm;
    options.min_length_mm = limits.min_length_mm;
    options.joint = fit.joint;
    options.tab_mm = fit.tab_mm;
    options.usable_sheet = limits.usable_sheet;
    options.rotation = limits.rotation;
    options.max_piece_mm = fit.max_piece_mm;
    options.self_gap_mm = limits.self_gap_mm;
    return options;
}

// What the maker should know about a strip's pieces.
void tell_of(const Parting& parting,
             const Strip& strip,
             const PieceRules& rules,
             std::vector<std::string>& warnings) {
    const PieceLimits& limits = rules.limits;
    double least = limits.min_width_mm;
    double widened = 0.0;
    bool still_narrow = false;
    bool too_large = false;
    bool too_short = false;
    bool no_arrow = false;
    for (const CutPiece& cut : parting.pieces) {
        const Fitted& fitted = cut.fitted;
        least = std::min(least, fitted.narrow.least_mm);
        widened = std::max(widened, fitted.narrow.widened_mm);
        still_narrow = still_narrow || !cut.widened;
        too_large = too_large || !cut.fits_sheet;
        too_short = too_short || fitted.length_mm < limits.min_length_mm;
        no_arrow = no_arrow ||
                   (rules.fit.joint == Joint::Slot && fitted.end_tab_mm > 0.0 && !fitted.arrow);
    }
    const auto warn = [&](bool applies, std::string_view what) {
        if (applies) {
            warnings.push_back(fmt::format("{}: {}", strip.id, what));
        }
    };
    warn(parting.overlaps > 0, "parted where it would have lain on itself");
    warn(widened > kToldMm && !still_narrow,
         fmt::format("down to {:.2f} mm wide; widened to {:g} mm there", std::max(0.0, least),
                     limits.min_width_mm));
    warn(still_narrow, fmt::format("narrower than {:g} mm in places, down to {:.2f} mm",
                                   limits.min_width_mm, std::max(0.0, least)));
    warn(too_large, "a cell larger than the sheet");
    warn(too_short, fmt::format("a piece shorter than {:g} mm", limits.min_length_mm));
    warn(no_arrow, "too narrow for an arrow and slit: glue its tabs");
}

// An extremely thin strip's width and where it is that thin.
struct Hopeless {
    double width_mm = 0.0;  // On average.
    double part = 0.0;      // Of its length.
};

Hopeless hopelessness(const Strip& strip, const geometry::QuadMesh& mesh, double min_width_mm) {
    Strip own = strip;
    own.beyond.clear();
    const int count = static_cast<int>(own.quads.size());
    const Unfolded flat = unfold(mesh, walk_cells(mesh, own), {0, count});
    FitOptions fit;
    fit.min_width_mm = min_width_mm;
    const Fitted fitted = fit_piece(flat, {0, count}, fit);
    return {mean_width(flat),
            fitted.between_mm > 0.0 ? fitted.narrow.hopeless_mm / fitted.between_mm : 1.0};
}

}  // namespace

std::vector<Strip> make_strips(const geometry::QuadMesh& mesh,
                               ColumnRuns columns,
                               const ThroughLimits& limits) {
    using geometry::ThreadEnds;
    std::vector<Strip> strips;
    add_strips(mesh, Family::Weft,
               geometry::trace_threads(mesh, Family::Weft, ThreadEnds::AtCriticalLeaves), strips);
    if (columns == ColumnRuns::PerCylinder) {
        add_strips(mesh, Family::Warp,
                   geometry::trace_threads(mesh, Family::Warp, ThreadEnds::AtCriticalLeaves),
                   strips);
        return strips;
    }
    std::vector<geometry::Thread> threads;
    for (geometry::Thread& thread :
         geometry::trace_threads(mesh, Family::Warp, ThreadEnds::Through)) {
        for (geometry::Thread& part : parted_at_leaves(mesh, std::move(thread), limits)) {
            threads.push_back(std::move(part));
        }
    }
    geometry::sort_by_smallest_quad(threads);
    add_strips(mesh, Family::Warp, std::move(threads), strips);
    return strips;
}

ThroughLimits through_limits(const FitParams& fit, const PieceLimits& limits) {
    ThroughLimits through;
    through.max_length_mm = fit.max_piece_mm - 2.0 * fit.tab_mm;
    through.self_gap_mm = limits.self_gap_mm;
    through.usable_sheet = {limits.usable_sheet.width_mm - fit.tab_mm,
                            limits.usable_sheet.height_mm - fit.tab_mm};
    through.rotation = limits.rotation;
    return through;
}

void refuse_hopeless_strips(std::span<const Strip> strips,
                            const geometry::QuadMesh& mesh,
                            const std::array<PieceLimits, 2>& limits) {
    constexpr std::size_t kMostNamed = 6;
    std::string named;
    std::size_t count = 0;
    double least = 0.0;
    for (const Strip& strip : strips) {
        const double min_width = limits[strip.family == Family::Weft ? 0 : 1].min_width_mm;
        const Hopeless hopeless = hopelessness(strip, mesh, min_width);
        if (hopeless.part <= 0.5) {
            continue;
        }
        least = min_width;
        if (++count <= kMostNamed) {
            named += fmt::format("{}{} ({:.2f} mm on average)", named.empty() ? "" : ", ", strip.id,
                                 hopeless.width_mm);
        }
    }
    if (count > kMostNamed) {
        named += fmt::format(" and {} more", count - kMostNamed);
    }
    if (count > 0) {
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "strip-too-narrow",
            fmt::format("too narrow for the material, which takes {:g} mm: {}; choose a larger "
                        "grid.strip_width_mm or scale.longest_side_mm, or a material that is cut "
                        "finer",
                        least, named));
    }
}

std::vector<Piece> make_pieces(Strip& strip,
                               const geometry::QuadMesh& mesh,
                               const PieceRules& rules,
                               std::vector<std::string>& warnings) {
    const std::vector<WalkedCell> cells = walk_cells(mesh, strip);
    SplitOptions options = split_options(rules.fit, rules.limits);
    if (rules.fit.crimp && !rules.crossings.empty()) {
        const int count = static_cast<int>(strip.quads.size());
        options.extra_mm = crimp_of(unfold(mesh, cells, {0, count}), strip, rules);
    }
    const std::vector<int> windings = winding_joints(mesh, strip);
    Parting parting = part_strip(
        mesh, cells, strip, {rules.crossings, rules.joints, rules.threading, windings}, options);
    tell_of(parting, strip, rules, warnings);
    std::vector<Piece> pieces;
    strip.pieces.clear();
    for (CutPiece& cut : parting.pieces) {
        const bool joint = strip.closed || !pieces.empty();
        if (rules.joints != nullptr && joint) {
            rules.joints->add(strip, cells, cut.run.first);
        }
        strip.pieces.push_back(fmt::format("{}.{}", strip.id, pieces.size() + 1));
        pieces.push_back(to_piece(strip, cut, rules.limits.kerf_mm, strip.pieces.back()));
    }
    return pieces;
}

}  // namespace leafcutter::fab
