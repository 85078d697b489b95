#include "fab/strips/piece_marker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "fab/strips/crossing_names.h"
#include "fab/strips/mark_frame.h"
#include "fab/strips/mark_room.h"
#include "fab/strips/text_fit.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kTickMm = 1.2;  // Length of a tick, at most kTickPart of the width.
constexpr double kTickPart = 0.15;
constexpr double kEdgeMm = 0.3;  // Marks keep away from the edge, at most kEdgePart of it.
constexpr double kEdgePart = 0.05;
constexpr double kMarkPitchMm = 1.0;  // Lines across the strip stand no closer.
constexpr double kLineClearMm = 0.1;  // Between lines.
constexpr double kBarClearMm = 0.2;   // About a bar.

constexpr double kLabelPart = 0.5;  // Height of a label in widths of its strip.
constexpr double kNamePart = 0.27;  // Of a crossing strip's id.
constexpr double kNameOfLabel = 0.6;
constexpr double kReadableLabelMm = 1.6;  // Smaller ones rather take several cells,
constexpr double kAlongMm = 2.4;          // where they are no higher than this
constexpr double kAlongPart = 0.42;       // and leave room for bars beside them.
constexpr double kReadableNameMm = 1.6;
constexpr double kEndMm = 45.0;  // Labels stand this near to their end, or in kEndCells.
constexpr std::size_t kEndCells = 3;
constexpr double kNamePitchMm = 60.0;
constexpr int kFewestBetween = 6;  // Cells from name to name.
constexpr int kMostBetween = 10;

Mark line(Operation operation, Polyline path) {
    Mark mark;
    mark.operation = operation;
    mark.path = std::move(path);
    return mark;
}

class Marker {
public:
    Marker(const Piece& piece, const MarkFacts& facts, const FitParams& fit)
        : piece_(piece),
          facts_(facts),
          fit_(fit),
          room_(piece),
          frame_(piece),
          has_bar_(frame_.cells(), 0) {}

    PieceMarks make() {
        add_scores();
        add_tab_line(PieceEnd::Start);
        add_tab_line(PieceEnd::Finish);
        before_ticks_ = room_.taken();
        reserve_ticks();
        if (fit_.labels) {
            add_texts();
        }
        add_bars();
        add_rungs();
        return std::move(result_);
    }

private:
    void keep(const MarkShape& shape, Operation operation = Operation::Engrave) {
        room_.take(shape);
        result_.marks.push_back(line(operation, shape.contour()));
    }

    bool keep_if_free(const MarkShape& shape, Operation operation = Operation::Engrave) {
        const bool free = room_.is_free(shape, kLineClearMm);
        if (free) {
            keep(shape, operation);
        }
        return free;
    }

    void keep(PlacedText text) {
        room_.take(text.quiet);
        result_.marks.push_back(std::move(text.mark));
    }

    // Keeps a text in a cell, unless it leaves no room for the cell's bar.
    bool keep_in_cell(PlacedText text, std::size_t cell) {
        const std::size_t before = room_.taken();
        room_.take(text.quiet);
        if (needs_bar(cell) && !add_bar(cell)) {
            room_.give_back(before);
            return false;
        }
        result_.marks.push_back(std::move(text.mark));
        return true;
    }

    void add_scores() {
        for (std::size_t i = 0; i < frame_.cells(); ++i) {
            if (piece_.bend[i] == Bend::None || piece_.fold_deg[i] < fit_.score_deg) {
                continue;
            }
            const MarkCell cell = frame_.cell(i);
            const bool rising = piece_.fold_rises[i] != 0;
            const Vector2d from = rising ? cell.right0 : cell.left0;
            const Vector2d to = rising ? cell.left1 : cell.right1;
            const Vector2d way = to - from;
            const double trim = std::min(kEdgeMm * 1.5 / std::max(way.norm(), 1e-9), 0.1);
            if (way.norm() >= kMarkPitchMm) {
                keep_if_free({from + trim * way, to - trim * way}, Operation::Score);
            }
        }
    }

    // A part of a rung, in parts of its width from the left.
    MarkShape on_rung(std::size_t i, double from, double to) const {
        const Vector2d& left = piece_.cut_left[i];
        const Vector2d rung = piece_.cut_right[i] - left;
        return {left + from * rung, left + to * rung};
    }

    double rung_mm(std::size_t i) const {
        return std::max((piece_.cut_right[i] - piece_.cut_left[i]).norm(), 1e-9);
    }

    MarkShape whole_rung(std::size_t i) const {
        const double edge = std::min(kEdgeMm / rung_mm(i), kEdgePart);
        return on_rung(i, edge, 1.0 - edge);
    }

    // Between the corners where the tab sets in, which is narrower: arrows by much.
    void add_tab_line(PieceEnd end) {
        if (!frame_.tab(end)) {
            return;
        }
        const std::size_t rung = end == PieceEnd::Start ? 0 : frame_.cells();
        for (const double edge : {0.08, 0.13, 0.2, 0.28, 0.36}) {
            if (keep_if_free(on_rung(rung, edge, 1.0 - edge))) {
                return;
            }
        }
    }

    // Keeps the room of both ticks of every rung; they are added last, or a whole line instead.
    void reserve_ticks() {
        ticks_.clear();
        result_.bare_rungs = 0;
        if (fit_.cell_marks == CellMarks::None) {
            return;
        }
        double last = 0.0;
        for (std::size_t i = 1; i < frame_.cells(); ++i) {
            const double here = frame_.position_mm(i);
            const bool near =
                here - last < kMarkPitchMm || frame_.length_mm() - here < kMarkPitchMm;
            if (near || !reserve_ticks_at(i)) {
                ++result_.bare_rungs;
            } else {
                last = here;
            }
        }
    }

    bool reserve_ticks_at(std::size_t i) {
        const double edge = std::min(kEdgeMm / rung_mm(i), kEdgePart);
        const double full = std::min(kTickMm / rung_mm(i), kTickPart);
        for (const double tick : {full, full / 2.0}) {
            const MarkShape left = on_rung(i, edge, edge + tick);
            const MarkShape right = on_rung(i, 1.0 - edge - tick, 1.0 - edge);
            if (room_.is_free(left, kLineClearMm) && room_.is_free(right, kLineClearMm)) {
                room_.take(left, static_cast<int>(i));
                room_.take(right, static_cast<int>(i));
                ticks_.push_back({i, left, right});
                return true;
            }
        }
        return false;
    }

    void add_rungs() {
        for (const Ticks& ticks : ticks_) {
            const MarkShape whole = whole_rung(ticks.rung);
            if (fit_.cell_marks == CellMarks::Lines &&
                room_.is_free(whole, kLineClearMm, static_cast<int>(ticks.rung))) {
                keep(whole);
            } else {
                keep(ticks.left);
                keep(ticks.right);
            }
        }
    }

    void add_texts() {
        result_.is_named = add_start_label();
        for (const std::string& code : codes()) {
            if (!result_.is_named || start_is_far_ || add_label(PieceEnd::Finish, code)) {
                break;
            }
        }
        add_joint(PieceEnd::Start, facts_.before);
        add_joint(PieceEnd::Finish, facts_.behind);
        add_names();
    }

    // A label is worth more than the ticks where it stands, and better far from the start than
    // none.
    bool add_start_label() {
        for (const std::string& code : codes()) {
            if (add_label(PieceEnd::Start, code)) {
                return true;
            }
            room_.give_back(before_ticks_);
            const bool fits = add_label(PieceEnd::Start, code);
            reserve_ticks();
            if (fits) {
                return true;
            }
            start_is_far_ = add_label(PieceEnd::Finish, code);
            if (start_is_far_) {
                return true;
            }
        }
        return false;
    }

    TextHeights label_heights() const {
        TextHeights heights;
        heights.most_mm =
            std::max(kSmallestTextMm, std::min(fit_.text_mm, kLabelPart * frame_.widest_mm()));
        return heights;
    }

    // The whole label, and what is left of it where room is short.
    std::array<std::string, 4> codes() const {
        const std::string number = piece_.id.substr(1);
        return {piece_.id + ">", piece_.id, number, number.substr(0, number.find('.'))};
    }

    bool add_label(PieceEnd end, const std::string& code) {
        if (add_label_under_others(end, code)) {
            return true;
        }
        auto label = label_along(end, code);
        if (label) {
            keep(std::move(*label));
        }
        return label.has_value();
    }

    // The piece's cells from an end on.
    std::size_t from_end(PieceEnd end, std::size_t i) const {
        return end == PieceEnd::Start ? i : frame_.cells() - 1 - i;
    }

    // How many cells from an end on may carry its label; the far half is the other end's.
    std::size_t end_cells(PieceEnd end) const {
        const std::size_t most = (frame_.cells() + (end == PieceEnd::Start ? 1 : 0)) / 2;
        std::size_t count = std::min(kEndCells, most);
        const auto way = [&](std::size_t i) {
            const double at = frame_.position_mm(from_end(end, i));
            return end == PieceEnd::Start ? at : frame_.length_mm() - at;
        };
        while (count < most && way(count) < kEndMm) {
            ++count;
        }
        return count;
    }

    bool add_label_under_others(PieceEnd end, const std::string& code) {
        TextHeights heights = label_heights();
        heights.least_mm = std::min(kReadableLabelMm, heights.most_mm);
        for (std::size_t i = 0; i < end_cells(end); ++i) {
            const std::size_t cell = from_end(end, i);
            if (facts_.under[cell] == 0) {
                continue;
            }
            auto label = fit_in_cell(room_, frame_.cell(cell), code, heights, TextWay::Along);
            if (label && keep_in_cell(std::move(*label), cell)) {
                return true;
            }
        }
        return false;
    }

    std::optional<PlacedText> label_along(PieceEnd end, const std::string& code) const {
        TextHeights heights = label_heights();
        heights.most_mm = std::max(
            kSmallestTextMm, std::min({fit_.text_mm, kAlongMm, kAlongPart * frame_.widest_mm()}));
        const double length = frame_.length_mm();
        const bool start = end == PieceEnd::Start;
        const double from = start ? 0.0 : length;
        for (const double reach : {std::min(kEndMm, length / 2.0), length / 2.0}) {
            const Stretch stretch{from, start ? reach : length - reach};
            if (auto label = fit_along(room_, frame_, stretch, code, heights)) {
                return label;
            }
        }
        return std::nullopt;
    }

    void add_joint(PieceEnd end, const std::string& other) {
        const auto tab = frame_.tab(end);
        if (!tab || other.empty()) {
            return;
        }
        // A ring of one piece is joined to itself: a plus tells as much.
        const std::string text = other == piece_.id ? "+" : "+" + other;
        auto joint = fit_in_cell(room_, *tab, text, label_heights());
        for (std::size_t i = 0; i < std::min(kEndCells, frame_.cells()) && !joint; ++i) {
            joint = fit_in_cell(room_, frame_.cell(from_end(end, i)), text, label_heights());
        }
        if (!joint) {
            joint = end == PieceEnd::Start ? fit_along(room_, frame_, {0.0, kEndMm}, text, {})
                                           : along_finish(text);
        }
        if (joint) {
            keep(std::move(*joint));
        }
    }

    std::optional<PlacedText> along_finish(const std::string& text) const {
        const double length = frame_.length_mm();
        TextHeights heights = label_heights();
        return fit_along(room_, frame_, {length, std::max(0.0, length - kEndMm)}, text, heights);
    }

    void add_names() {
        const double pitch = frame_.length_mm() / static_cast<double>(frame_.cells());
        const double between = std::ceil(kNamePitchMm / std::max(pitch, 1e-9));
        const int every =
            static_cast<int>(std::clamp<double>(between, kFewestBetween, kMostBetween));
        std::vector<char> named(frame_.cells(), 0);
        for (const NameWish& wish : name_wishes({facts_.numbers, facts_.under, every})) {
            const bool fulfilled = std::any_of(wish.begin(), wish.end(), [&](int cell) {
                return named[static_cast<std::size_t>(cell)] != 0;
            });
            if (!fulfilled) {
                add_name(wish, named);
            }
        }
    }

    std::optional<PlacedText> name_in(std::size_t cell_number) const {
        const MarkCell cell = frame_.cell(cell_number);
        TextHeights heights;
        heights.most_mm = std::max(
            kSmallestTextMm, std::min(kNameOfLabel * fit_.text_mm, kNamePart * cell.width_mm));
        return fit_in_cell(room_, cell, facts_.crossing[cell_number], heights);
    }

    // First where it is readable, then anywhere.
    void add_name(const NameWish& wish, std::vector<char>& named) {
        for (const double least : {kReadableNameMm, kSmallestTextMm}) {
            for (const int wanted : wish) {
                const auto i = static_cast<std::size_t>(wanted);
                auto name = name_in(i);
                if (name && name->mark.height_mm >= least && keep_in_cell(std::move(*name), i)) {
                    named[i] = 1;
                    return;
                }
            }
        }
    }

    bool needs_bar(std::size_t cell) const {
        return fit_.weave_marks && facts_.under[cell] != 0 && has_bar_[cell] == 0;
    }

    void add_bars() {
        for (std::size_t i = 0; i < frame_.cells(); ++i) {
            if (needs_bar(i) && !add_bar(i)) {
                ++result_.bare_weave_cells;
            }
        }
    }

    // In the cell's middle, or beside what stands there.
    bool add_bar(std::size_t number) {
        const MarkCell cell = frame_.cell(number);
        if (cell.length_mm < kMarkPitchMm) {
            return false;
        }
        const Vector2d left = (cell.left0 + cell.left1) / 2.0;
        const Vector2d rung = (cell.right0 + cell.right1) / 2.0 - left;
        const double width = std::max(rung.norm(), 1e-9);
        const double full = std::clamp(0.2 * width, 0.6, 2.5) / width;
        for (const double length : {full, 0.6 * full}) {
            for (const double shift : {0.0, 0.2, -0.2, 0.35, -0.35}) {
                for (const double at : {0.5, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88}) {
                    const Vector2d centre = left + at * rung + shift * cell.length_mm * cell.along;
                    const MarkShape bar(centre - length / 2.0 * rung, centre + length / 2.0 * rung);
                    const MarkShape about = MarkShape::box(
                        centre, rung / width, {length * width / 2.0 + kBarClearMm, kBarClearMm});
                    if (room_.is_free(about, 0.0)) {
                        keep(bar);
                        has_bar_[number] = 1;
                        return true;
                    }
                }
            }
        }
        return false;
    }

    struct Ticks {
        std::size_t rung = 0;
        MarkShape left;
        MarkShape right;
    };

    const Piece& piece_;
    const MarkFacts& facts_;
    const FitParams& fit_;
    MarkRoom room_;
    MarkFrame frame_;
    std::size_t before_ticks_ = 0;  // Taken of the room.
    std::vector<Ticks> ticks_;
    std::vector<char> has_bar_;  // Per cell.
    bool start_is_far_ = false;  // The start's label stands in the other half.
    PieceMarks result_;
};

}  // namespace

PieceMarks marks_of(const Piece& piece, const MarkFacts& facts, const FitParams& fit) {
    return Marker(piece, facts, fit).make();
}

}  // namespace leafcutter::fab
