#include "fab/strips/split.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "fab/clipper_paths.h"
#include "fab/strips/overlap.h"
#include "fab/strips/parting_plan.h"
#include "fab/strips/sheet_fit.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Evenness of lengths against joints that show: a piece half as long again as the mean costs a
// tenth of a joint in full sight.
constexpr double kEvenness = 0.4;
// One joint of a closed strip where nothing has to be threaded is enough: how far off the others
// are doesn't count.
constexpr double kMostThreadingCost = 3.0;

// An arrow on a shorter tab would not hold.
constexpr double kLeastArrowMm = 6.0;

Vector2d middle(const Unfolded& flat, std::size_t rung) {
    return (flat.left[rung] + flat.right[rung]) / 2.0;
}

// The largest contour of `ring` grown a little: for a cell too thin to be an outline of its own.
Ring thickened(const Ring& ring, double by_mm) {
    ClipperLib::ClipperOffset offset;
    offset.AddPath(clipper_path(ring, kGridPerMm), ClipperLib::jtMiter, ClipperLib::etClosedLine);
    ClipperLib::Paths grown;
    offset.Execute(grown, by_mm * kGridPerMm);
    for (const ClipperLib::Path& contour : grown) {
        if (contour.size() >= 3 && ClipperLib::Orientation(contour)) {
            return ring_of(contour, kGridPerMm);
        }
    }
    return {};
}

// A cell of its own that is no strip: as long and as wide as the middle of it.
Ring oblong(const Unfolded& flat, double min_width_mm) {
    const Vector2d from = middle(flat, 0);
    const Vector2d way = middle(flat, 1) - from;
    Vector2d along = way.stableNormalized();
    if (along.squaredNorm() < 0.5) {
        along = Vector2d::UnitX();
    }
    const double length = std::max(way.norm(), min_width_mm);
    const double width = std::max({(flat.left[0] - flat.right[0]).norm(),
                                   (flat.left[1] - flat.right[1]).norm(), min_width_mm, 0.05});
    const Vector2d half = width / 2.0 * Vector2d(-along.y(), along.x());
    return snapped(
        {from - half, from + length * along - half, from + length * along + half, from + half});
}

// What speaks against a piece.
enum class Verdict { Good, TooLarge, Overlaps };

// A strip of an unfolding laid straight on past an end.
void lay_straight_on(double length_mm, bool at_end, Unfolded& flat) {
    const auto extend = [&](std::size_t rung, std::size_t inner) {
        const Vector2d way = (middle(flat, rung) - middle(flat, inner)).stableNormalized();
        return std::array<Vector2d, 2>{flat.left[rung] + length_mm * way,
                                       flat.right[rung] + length_mm * way};
    };
    const std::size_t last = flat.left.size() - 1;
    const auto [left, right] = at_end ? extend(last, last - 1) : extend(0, 1);
    flat.left.insert(at_end ? flat.left.end() : flat.left.begin(), left);
    flat.right.insert(at_end ? flat.right.end() : flat.right.begin(), right);
    flat.bend.insert(at_end ? flat.bend.end() : flat.bend.begin(), Bend::None);
    flat.fold_deg.insert(at_end ? flat.fold_deg.end() : flat.fold_deg.begin(), 0.0);
    flat.fold_rises.insert(at_end ? flat.fold_rises.end() : flat.fold_rises.begin(), 0);
}

class Parter {
public:
    Parter(const geometry::QuadMesh& mesh,
           const std::vector<WalkedCell>& cells,
           const Strip& strip,
           const SplitOptions& options)
        : mesh_(mesh),
          cells_(cells),
          strip_(strip),
          options_(options),
          total_(static_cast<int>(strip.quads.size())),
          beyond_(static_cast<int>(strip.beyond.size())),
          whole_(unfold(mesh, cells, {0, total_ + (strip.closed ? 1 : beyond_)})) {
        at_.push_back(0.0);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            steps_.push_back((middle(whole_, i + 1) - middle(whole_, i)).norm() +
                             extra(static_cast<int>(i)));
            at_.push_back(at_.back() + steps_.back());
        }
    }

    Parting part(const StripPlaces& places) {
        PartingProblem problem;
        problem.cells = total_;
        problem.closed = strip_.closed;
        problem.evenness = kEvenness;
        problem.joint_cost = joint_costs({.strip = strip_,
                                          .cells = cells_,
                                          .whole = whole_,
                                          .crossings = places.crossings,
                                          .tab_mm = options_.tab_mm,
                                          .joints = places.joints});
        for (std::size_t i = 0; i < places.threading.size(); ++i) {
            problem.joint_cost[i] += std::min(places.threading[i], kMostThreadingCost);
        }
        problem.length.assign(steps_.begin(), steps_.begin() + total_);
        problem.good = [&](int first, int count) {
            const bool winds =
                std::any_of(places.windings.begin(), places.windings.end(), [&](int cell) {
                    const int behind = (cell - first % total_ + total_) % total_;
                    return behind > 0 && behind < count;
                });
            return !winds && verdict(first, count) == Verdict::Good;
        };
        return pieces_at(plan_parting(problem));
    }

private:
    Parting pieces_at(const std::vector<int>& firsts) {
        Parting parting;
        for (std::size_t i = 0; i < firsts.size(); ++i) {
            const int behind =
                i + 1 < firsts.size() ? firsts[i + 1] : total_ + (strip_.closed ? firsts[0] : 0);
            const int count = behind - firsts[i];
            parting.pieces.push_back(best(firsts[i], count));
            const bool goes_on = firsts.size() > 1 && (strip_.closed || behind < total_);
            parting.overlaps += goes_on && lies_on_itself(firsts[i], 2 * count) ? 1 : 0;
        }
        return parting;
    }

    // Whether a run of so many cells, or as many as there are, would lie on itself.
    bool lies_on_itself(int first, int count) const {
        const int most = strip_.closed ? total_ : total_ - first;
        return verdict(first, std::min(most, count)) == Verdict::Overlaps;
    }

    double extra(int cell) const {
        const auto at = static_cast<std::size_t>(strip_.closed ? cell % total_ : cell);
        return at < options_.extra_mm.size() ? options_.extra_mm[at] : 0.0;
    }

    double step(int cell) const {
        return steps_[static_cast<std::size_t>(strip_.closed ? cell % total_ : cell)];
    }

    // Length along the middle of a run, crimp and all.
    double length(int first, int count) const {
        const auto wrapped = static_cast<std::size_t>(total_);
        const auto from = static_cast<std::size_t>(first);
        const std::size_t to = from + static_cast<std::size_t>(count);
        return to <= wrapped ? at_[to] - at_[from] : at_[wrapped] - at_[from] + at_[to - wrapped];
    }

    // What lies past the ends of a run for its tabs.
    struct Room {
        int before = 0;  // Cells.
        int behind = 0;
        bool straight_start = false;  // Else laid straight on, glued to another cylinder.
        bool straight_end = false;
    };

    struct TabLengths {
        double start = 0.0;
        double end = 0.0;
    };

    bool at_end(int first, int count) const { return !strip_.closed && first + count == total_; }

    // Cells from `cell` on, of at most `available`, that a tab of this length lies on.
    int cells_under(double tab_mm, int cell, int available, int way) const {
        double covered = 0.0;
        int count = 0;
        while (count < available && covered < tab_mm) {
            const int at = strip_.closed ? ((cell + way * count) % total_ + total_) % total_
                                         : cell + way * count;
            covered += step(at);
            ++count;
        }
        return count;
    }

    Room room(int first, int count, const TabLengths& tabs) const {
        const int half = std::max(1, total_ / 2);
        const int behind = strip_.closed ? half : total_ + beyond_ - first - count;
        const int before = strip_.closed ? half : first;
        Room room;
        if (tabs.end > 0.0) {
            room.straight_end = at_end(first, count) && strip_.glued_end.has_tab && beyond_ == 0;
            room.behind = room.straight_end ? 0 : cells_under(tabs.end, first + count, behind, 1);
        }
        if (tabs.start > 0.0) {
            room.straight_start =
                !strip_.closed && first == 0 && (strip_.glued_start.has_tab || strip_.follows);
            room.before = room.straight_start ? 0 : cells_under(tabs.start, first - 1, before, -1);
        }
        return room;
    }

    // The tabs that a run has by rule. Joint::Cell: all of the first cell behind it.
    TabLengths usual_tabs(int first, int count) const {
        TabLengths tabs{.start = 0.0, .end = options_.tab_mm};
        const bool last = at_end(first, count);
        if (options_.joint == Joint::Slot) {
            tabs.end = std::max(tabs.end, kLeastArrowMm);
        }
        if (options_.joint == Joint::Cell && (!last || beyond_ > 0)) {
            tabs.end = step(first + count);
        }
        if (last && beyond_ == 0 && !strip_.glued_end.has_tab) {
            tabs.end = 0.0;
        }
        if (!strip_.closed && first == 0 && strip_.glued_start.has_tab) {
            tabs.start = options_.tab_mm;
        }
        return tabs;
    }

    CutPiece made(int first, int count, const TabLengths& tabs, Widening widening) const {
        const Room room = this->room(first, count, tabs);
        CutPiece piece;
        piece.run = {first % total_, count};
        piece.before = room.before;
        const int from = first - room.before;
        piece.flat = unfold(mesh_, cells_,
                            {strip_.closed ? (from % total_ + total_) % total_ : from,
                             room.before + count + room.behind});
        FitOptions fit;
        fit.clearance_mm = options_.clearance_mm;
        fit.min_width_mm = options_.min_width_mm;
        fit.widening = widening;
        fit.start_tab_mm = tabs.start;
        fit.end_tab_mm = tabs.end;
        fit.arrow = options_.joint == Joint::Slot && !room.straight_end;
        for (int i = 0; i < room.before + count + room.behind; ++i) {
            const int cell = from + i + (strip_.closed ? total_ : 0);
            fit.extra_mm.push_back(extra(cell));
        }
        if (room.straight_end) {
            lay_straight_on(tabs.end, true, piece.flat);
            fit.extra_mm.push_back(0.0);
        }
        if (room.straight_start) {
            lay_straight_on(tabs.start, false, piece.flat);
            fit.extra_mm.insert(fit.extra_mm.begin(), 0.0);
            ++piece.before;
        }
        piece.fitted = fit_piece(piece.flat, {piece.before, count}, fit);
        piece.widened = widening != Widening::None || piece.fitted.narrow.widened_mm <= 0.0;
        return piece;
    }

    Verdict judge(const CutPiece& piece) const {
        const Ring& outline = piece.fitted.outline;
        if (piece.fitted.length_mm > options_.max_piece_mm ||
            !fits_sheet(outline, options_.usable_sheet, options_.rotation)) {
            return Verdict::TooLarge;
        }
        if (!is_simple(outline) || !keeps_gap(outline, options_.self_gap_mm)) {
            return Verdict::Overlaps;
        }
        return Verdict::Good;
    }

    // The first of several ways to widen that makes a good piece; else the last one tried.
    CutPiece attempt(int first, int count, const TabLengths& tabs, Verdict& verdict) const {
        CutPiece piece = made(first, count, tabs, Widening::OuterSide);
        verdict = judge(piece);
        if (verdict != Verdict::Overlaps || piece.fitted.narrow.widened_mm <= 0.0) {
            return piece;
        }
        for (const Widening widening : {Widening::BothSides, Widening::None}) {
            piece = made(first, count, tabs, widening);
            verdict = judge(piece);
            if (verdict == Verdict::Good) {
                break;
            }
        }
        return piece;
    }

    Verdict verdict(int first, int count) const {
        if (length(first, count) > options_.max_piece_mm) {
            return Verdict::TooLarge;
        }
        Verdict result = Verdict::Good;
        attempt(first, count, usual_tabs(first, count), result);
        return result;
    }

    // The piece with its usual tabs, with longer ones if it is too short; a single cell that is no
    // good without any.
    CutPiece best(int first, int count) const {
        TabLengths tabs = usual_tabs(first, count);
        Verdict verdict = Verdict::Good;
        CutPiece piece = attempt(first, count, tabs, verdict);
        if (verdict != Verdict::Good) {
            return count == 1 ? single_cell(first) : piece;
        }
        return piece.fitted.length_mm < options_.min_length_mm ? lengthened(std::move(piece), tabs)
                                                               : piece;
    }

    // A piece that is too short with longer tabs at both ends, where there is something to join;
    // what one end has no room for goes to the other.
    CutPiece lengthened(CutPiece piece, TabLengths tabs) const {
        const auto [first, count] = piece.run;
        const bool joined_start =
            strip_.closed || first > 0 || strip_.follows || strip_.glued_start.has_tab;
        const bool joined_end = piece.fitted.end_tab_mm > 0.0;
        double share = joined_start && joined_end ? 0.5 : 1.0;
        for (int round = 0; round < 2; ++round) {
            const double lacking = options_.min_length_mm - piece.fitted.length_mm;
            if (lacking <= 0.0) {
                break;
            }
            tabs.end += joined_end ? share * lacking : 0.0;
            tabs.start += joined_start ? share * lacking : 0.0;
            Verdict verdict = Verdict::Good;
            CutPiece longer = attempt(first, count, tabs, verdict);
            if (verdict != Verdict::Good) {
                break;
            }
            piece = std::move(longer);
            share = 1.0;
        }
        return piece;
    }

    // One cell that is no good as it is: without tabs, then as it is, then as an oblong.
    CutPiece single_cell(int first) const {
        Verdict verdict = Verdict::Good;
        CutPiece piece = attempt(first, 1, {}, verdict);
        if (!is_simple(piece.fitted.outline)) {
            const Unfolded& flat = piece.flat;
            piece.fitted.left = flat.left;
            piece.fitted.right = flat.right;
            piece.widened = false;
            piece.fitted.outline =
                thickened({flat.right[0], flat.right[1], flat.left[1], flat.left[0]}, 0.05);
            if (!is_simple(piece.fitted.outline)) {
                piece.fitted.outline = oblong(flat, options_.min_width_mm);
            }
        }
        piece.fits_sheet =
            fits_sheet(piece.fitted.outline, options_.usable_sheet, options_.rotation);
        return piece;
    }

    const geometry::QuadMesh& mesh_;
    const std::vector<WalkedCell>& cells_;
    const Strip& strip_;
    const SplitOptions& options_;
    int total_;
    int beyond_;  // Cells past the end that a tab may lie on.
    Unfolded whole_;
    std::vector<double> steps_;  // Length of the middle line in each cell, with crimp,
    std::vector<double> at_;     // and before it.
};

}  // namespace

Parting part_strip(const geometry::QuadMesh& mesh,
                   const std::vector<WalkedCell>& cells,
                   const Strip& strip,
                   const StripPlaces& places,
                   const SplitOptions& options) {
    return Parter(mesh, cells, strip, options).part(places);
}

}  // namespace leafcutter::fab
