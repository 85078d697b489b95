#include "fab/strips/marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "fab/strips/labels.h"
#include "fab/strips/overlap.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kFoldScoreDeg = 15.0;  // A cell that bends further is scored on its diagonal.
constexpr double kTickMm = 1.2;         // Length of a tick, at most kTickPart of the width.
constexpr double kTickPart = 0.15;
constexpr double kEdgeMm = 0.3;  // Marks keep away from the edge, at most kEdgePart of it.
constexpr double kEdgePart = 0.05;
constexpr double kMarkPitchMm = 1.0;  // Lines across the strip stand no closer.
constexpr double kLargestTextMm = 4.0;
constexpr double kSmallestTextMm = 1.0;
constexpr double kTextPart = 0.5;  // Height of a label in widths of its strip.
constexpr double kTextPadMm = 0.25;
constexpr double kArrowGap = 0.5;  // In text heights.
constexpr double kArrowLength = 1.2;

Mark line(Operation operation, Polyline path) {
    Mark mark;
    mark.operation = operation;
    mark.path = std::move(path);
    return mark;
}

// The middle line of a piece, by arc length.
class CentreLine {
public:
    explicit CentreLine(const Piece& piece) {
        for (std::size_t i = 0; i < piece.cut_left.size(); ++i) {
            points_.emplace_back((piece.cut_left[i] + piece.cut_right[i]) / 2.0);
            at_.push_back(i == 0 ? 0.0 : at_.back() + (points_[i] - points_[i - 1]).norm());
        }
    }

    double length() const { return at_.back(); }
    double position(std::size_t rung) const { return at_[rung]; }

    Vector2d point(double s) const {
        const auto upper = std::upper_bound(at_.begin(), at_.end(), s);
        const auto i = std::clamp<std::ptrdiff_t>(upper - at_.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(at_.size()) - 1);
        const auto k = static_cast<std::size_t>(i);
        const double step = at_[k] - at_[k - 1];
        const double part = step > 0.0 ? (s - at_[k - 1]) / step : 0.0;
        return points_[k - 1] + part * (points_[k] - points_[k - 1]);
    }

private:
    Polyline points_;
    std::vector<double> at_;
};

struct Marks {
    std::vector<Mark> marks;
    bool label_fits = true;
};

class Marker {
public:
    Marker(const Piece& piece, const FitParams& fit)
        : piece_(piece),
          fit_(fit),
          inside_(piece.outline),
          centre_(piece),
          cells_(static_cast<std::size_t>(piece.cell_count)) {}

    Marks make() {
        Marks result;
        if (fit_.labels) {
            result.label_fits = add_label();
        }
        if (fit_.cell_marks != CellMarks::None) {
            add_crossings();
        }
        if (piece_.end_tab.length_mm > 0.0) {
            keep(line(Operation::Engrave, across(cells_, Reach::Whole)));
        }
        add_folds();
        result.marks = std::move(marks_);
        return result;
    }

private:
    const Polyline& left() const { return piece_.cut_left; }
    const Polyline& right() const { return piece_.cut_right; }

    void keep(Mark mark) {
        if (inside_.contains(mark.path)) {
            marks_.push_back(std::move(mark));
        }
    }

    // Where a line lies on its rung: over all of it, or a tick at one end.
    enum class Reach { Whole, LeftTick, RightTick };

    Polyline across(std::size_t i, Reach reach) const {
        const Vector2d rung = right()[i] - left()[i];
        const double width = std::max(rung.norm(), 1e-9);
        const double edge = std::min(kEdgeMm / width, kEdgePart);
        const double tick = std::min(kTickMm / width, kTickPart);
        const double from = reach == Reach::RightTick ? 1.0 - edge - tick : edge;
        const double to = reach == Reach::LeftTick ? edge + tick : 1.0 - edge;
        return {left()[i] + from * rung, left()[i] + to * rung};
    }

    void add_crossings() {
        double last = 0.0;
        for (std::size_t i = 1; i < cells_; ++i) {
            const double here = centre_.position(i);
            if (here - last < kMarkPitchMm || centre_.length() - here < kMarkPitchMm) {
                continue;
            }
            last = here;
            if (fit_.cell_marks == CellMarks::Lines) {
                keep(line(Operation::Engrave, across(i, Reach::Whole)));
            } else {
                keep(line(Operation::Engrave, across(i, Reach::LeftTick)));
                keep(line(Operation::Engrave, across(i, Reach::RightTick)));
            }
        }
    }

    void add_folds() {
        for (std::size_t i = 0; i < cells_; ++i) {
            if (piece_.bend[i] == Bend::None || piece_.fold_deg[i] < kFoldScoreDeg) {
                continue;
            }
            const bool rising = piece_.fold_rises[i] != 0;
            const Vector2d from = rising ? right()[i] : left()[i];
            const Vector2d to = rising ? left()[i + 1] : right()[i + 1];
            const Vector2d way = to - from;
            const double trim = std::min(kEdgeMm * 1.5 / std::max(way.norm(), 1e-9), 0.1);
            if (way.norm() >= kMarkPitchMm) {
                keep(line(Operation::Score, {from + trim * way, to - trim * way}));
            }
        }
    }

    double widest() const {
        double width = 0.0;
        for (std::size_t i = 0; i < left().size(); ++i) {
            width = std::max(width, (left()[i] - right()[i]).norm());
        }
        return width;
    }

    bool add_label() {
        const double largest = std::min(kLargestTextMm, kTextPart * widest());
        for (double height = largest; height >= kSmallestTextMm; height *= 0.85) {
            const double width =
                height * (text_width(piece_.id) + kArrowGap + kArrowLength) + 2.0 * kTextPadMm;
            const double step = std::max(width / 4.0, (centre_.length() - width) / 200.0);
            for (double s = width / 2.0; s <= centre_.length() - width / 2.0; s += step) {
                if (place_label(s, width, height)) {
                    return true;
                }
            }
        }
        return false;
    }

    bool place_label(double s, double width, double height) {
        const Vector2d from = centre_.point(s - width / 2.0);
        const Vector2d chord = centre_.point(s + width / 2.0) - from;
        const Vector2d x = chord.stableNormalized();
        const Vector2d y(-x.y(), x.x());
        const Vector2d middle = (from + chord / 2.0 + centre_.point(s)) / 2.0;
        const Vector2d corner = middle - width / 2.0 * x - (height / 2.0 + kTextPadMm) * y;
        const double tall = height + 2.0 * kTextPadMm;
        const Polyline box{corner, corner + width * x, corner + width * x + tall * y,
                           corner + tall * y, corner};
        if (!inside_.contains(box)) {
            return false;
        }
        Mark text;
        text.text = piece_.id;
        text.at = corner + kTextPadMm * (x + y);
        text.angle_deg = std::atan2(x.y(), x.x()) * 180.0 / std::numbers::pi;
        text.height_mm = height;
        const Vector2d tail =
            text.at + height * (text_width(piece_.id) + kArrowGap) * x + height / 2.0 * y;
        const Vector2d tip = tail + height * kArrowLength * x;
        const Vector2d back = tip - 0.35 * height * x;
        marks_.push_back(std::move(text));
        keep(line(Operation::Engrave, {tail, tip}));
        keep(line(Operation::Engrave, {back + 0.3 * height * y, tip, back - 0.3 * height * y}));
        return true;
    }

    const Piece& piece_;
    const FitParams& fit_;
    RingInterior inside_;
    CentreLine centre_;
    std::size_t cells_;
    std::vector<Mark> marks_;
};

}  // namespace

void mark_pieces(std::span<Piece> pieces,
                 std::span<const Strip> /*strips*/,
                 const Crossings& /*crossings*/,
                 const FitParams& fit,
                 std::vector<std::string>& warnings) {
    for (Piece& piece : pieces) {
        Marks marks = Marker(piece, fit).make();
        piece.marks = std::move(marks.marks);
        if (!marks.label_fits) {
            warnings.push_back(
                fmt::format("{}: too narrow for its label, which is left out", piece.strip));
        }
    }
}

}  // namespace leafcutter::fab
