#include "fab/guide/piece_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "fab/guide/clip_box.h"
#include "fab/strips/labels.h"

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kInk = {34, 34, 34};
constexpr Colour kWhite = {255, 255, 255};
constexpr Colour kBlack = {0, 0, 0};
constexpr Colour kScore = {200, 40, 40};

// From a piece's plane (y up) into a drawing (y down).
class Placing {
public:
    Placing(double angle, double scale)
        : cos_(std::cos(angle)), sin_(std::sin(angle)), scale_(scale) {}

    Point operator()(const Point& p) const {
        return Point(scale_ * (cos_ * p.x() - sin_ * p.y()),
                     -scale_ * (sin_ * p.x() + cos_ * p.y())) +
               offset_;
    }
    Points operator()(const Points& line) const {
        Points mapped;
        for (const Point& point : line) {
            mapped.push_back((*this)(point));
        }
        return mapped;
    }
    // Moves what is now at `from` to `to`.
    void move(const Point& from, const Point& to) { offset_ += to - from; }

private:
    double cos_;
    double sin_;
    double scale_;
    Point offset_ = Point::Zero();
};

Point rung_middle(const Piece& piece, std::size_t rung) {
    return (piece.cut_left[rung] + piece.cut_right[rung]) / 2.0;
}

// What is drawn of a piece, at which place, and in which colours.
void append_piece(Drawing& drawing,
                  const Piece& piece,
                  const Placing& place,
                  const Box& box,
                  const Colour& colour) {
    Paths paper;
    paper.fill = mixed(colour, kWhite, 0.55);
    paper.lines = area_inside(place(piece.outline), box);
    Paths edge;
    edge.closed = false;
    edge.stroke = Stroke{kInk, 0.3, false};
    append_clipped(edge.lines, place(piece.outline), true, box);
    for (const Polyline& cut : piece.cuts) {
        append_clipped(edge.lines, place(cut), false, box);
    }
    Paths engraved;
    engraved.closed = false;
    engraved.stroke = Stroke{mixed(colour, kBlack, 0.8), 0.2, false};
    Paths scored;
    scored.closed = false;
    scored.stroke = Stroke{kScore, 0.25, true};
    for (const Mark& mark : piece.marks) {
        std::vector<Points>& lines =
            mark.operation == Operation::Score ? scored.lines : engraved.lines;
        if (mark.text.empty()) {
            append_clipped(lines, place(mark.path), false, box);
        } else {
            for (const Polyline& stroke : mark_strokes(mark)) {
                append_clipped(lines, place(stroke), false, box);
            }
        }
    }
    drawing.shapes.emplace_back(std::move(paper));
    drawing.shapes.emplace_back(std::move(edge));
    drawing.shapes.emplace_back(std::move(engraved));
    drawing.shapes.emplace_back(std::move(scored));
}

// The angle that lays the longer way of a piece level, from left to right.
double level_angle(const Piece& piece) {
    const Point way = rung_middle(piece, piece.cut_left.size() - 1) - rung_middle(piece, 0);
    Point mean = Point::Zero();
    for (const Point& point : piece.outline) {
        mean += point / static_cast<double>(piece.outline.size());
    }
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const Point& point : piece.outline) {
        spread += (point - mean) * (point - mean).transpose();
    }
    double angle = -0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
    const Point turned(std::cos(angle) * way.x() - std::sin(angle) * way.y(), 0.0);
    return turned.x() < 0.0 ? angle + std::numbers::pi : angle;
}

Drawing whole_piece(const Piece& piece, const Colour& colour, PictureSize size) {
    const double angle = level_angle(piece);
    Box extent;
    const Placing unit(angle, 1.0);
    for (const Point& point : piece.outline) {
        extent.add(unit(point));
    }
    const Point span = (extent.high - extent.low).cwiseMax(1e-6);
    const double scale =
        std::min({1.0, (size.width_mm - 1.0) / span.x(), (size.height_mm - 1.0) / span.y()});
    Placing place(angle, scale);
    Box box;
    Box drawn;
    for (const Point& point : piece.outline) {
        drawn.add(place(point));
    }
    place.move((drawn.low + drawn.high) / 2.0, {size.width_mm / 2.0, scale * span.y() / 2.0 + 0.5});
    box.low = Point::Zero();
    box.high = {size.width_mm, scale * span.y() + 1.0};
    Drawing drawing{size.width_mm, scale * span.y() + 1.0, {}, "Piece " + piece.id};
    append_piece(drawing, piece, place, box, colour);
    return drawing;
}

// A thing on a piece that a number points to.
struct Callout {
    Point at;
    std::string text;
};

class Closeup {
public:
    Closeup(const Piece& piece, bool of_end, PictureSize size)
        : piece_(piece), of_end_(of_end), size_(size), place_(frame()) {
        box_.low = {0.0, kTop};
        box_.high = {size.width_mm, size.height_mm};
    }

    const Placing& place() const { return place_; }
    const Box& box() const { return box_; }
    bool shows(const Point& p) const {
        const Point at = place_(p);
        return box_.contains(at) && at.x() > 2.0 && at.x() < size_.width_mm - 2.0;
    }

    static constexpr double kTop = 9.0;  // Above it stand the numbers.

private:
    Placing frame() const {
        const std::size_t last = piece_.cut_left.size() - 1;
        const std::size_t shown = std::min<std::size_t>(last, 4);
        const std::size_t from = of_end_ ? last - shown : 0;
        const Point begin = rung_middle(piece_, from);
        const Point end = rung_middle(piece_, from + shown);
        const Point way = end - begin;
        const double tab = of_end_ ? piece_.end_tab.length_mm : piece_.start_tab.length_mm;
        const double width = (piece_.cut_left[from] - piece_.cut_right[from]).norm();
        const double scale = std::min({4.0, (size_.width_mm - 4.0) / (way.norm() + tab + 1.0),
                                       0.55 * (size_.height_mm - kTop) / std::max(width, 1e-6)});
        Placing place(-std::atan2(way.y(), way.x()), scale);
        const double y = (size_.height_mm + kTop) / 2.0;
        if (of_end_) {
            place.move(place(end), {size_.width_mm - 3.0 - scale * (tab + 0.5), y});
        } else {
            place.move(place(begin), {3.0 + scale * (tab + 0.5), y});
        }
        return place;
    }

    const Piece& piece_;
    bool of_end_;
    PictureSize size_;
    Placing place_;
    Box box_;
};

Point middle_of(const Mark& mark) {
    Box box;
    if (mark.text.empty()) {
        for (const Point& point : mark.path) {
            box.add(point);
        }
    } else {
        for (const Polyline& stroke : mark_strokes(mark)) {
            for (const Point& point : stroke) {
                box.add(point);
            }
        }
    }
    return (box.low + box.high) / 2.0;
}

std::optional<std::size_t> cell_around(const Piece& piece, const Point& at) {
    for (std::size_t i = 0; i + 1 < piece.cut_left.size(); ++i) {
        const Point centre = (rung_middle(piece, i) + rung_middle(piece, i + 1)) / 2.0;
        const double length = (rung_middle(piece, i + 1) - rung_middle(piece, i)).norm();
        if ((centre - at).norm() < 0.3 * length) {
            return i;
        }
    }
    return std::nullopt;
}

// What kind of mark it is, in words; empty for those of no interest.
std::string meaning_of(const Piece& piece, const Mark& mark) {
    if (!mark.text.empty()) {
        if (mark.text.find('>') != std::string::npos) {
            return fmt::format(
                "Its name, {}, with an arrow: the way the strip runs. The side with the writing "
                "faces outward on the finished object.",
                piece.id);
        }
        if (mark.text.front() == '+') {
            return mark.text.size() == 1
                       ? std::string("A plus: this end is joined to the start of the same piece.")
                       : fmt::format("The piece that is joined here: {}.", mark.text.substr(1));
        }
        return fmt::format("The strip that crosses here: {}.", mark.text);
    }
    if (mark.operation == Operation::Score) {
        return "A red dashed line is scored: fold it lightly there (or where a tab begins).";
    }
    return cell_around(piece, middle_of(mark))
               ? "A bar: here this strip lies under the crossing one. Where there is none, it lies "
                 "over it."
               : "Ticks part the crossings: between two of them lies one crossing strip.";
}

std::vector<Callout> callouts_of(const Piece& piece, const Closeup& closeup, bool of_end) {
    std::vector<Callout> found;
    const auto add = [&](const Point& at, const std::string& text) {
        const bool known = std::any_of(found.begin(), found.end(), [&](const Callout& other) {
            return other.text.substr(0, 12) == text.substr(0, 12);
        });
        if (!known && !text.empty() && closeup.shows(at)) {
            found.push_back({closeup.place()(at), text});
        }
    };
    for (const Mark& mark : piece.marks) {
        add(middle_of(mark), meaning_of(piece, mark));
    }
    const Tab& tab = of_end ? piece.end_tab : piece.start_tab;
    if (tab.length_mm > 0.0) {
        const std::size_t last = of_end ? piece.cut_left.size() - 1 : 0;
        const std::size_t inner = of_end ? last - 1 : 1;
        const Point out = (rung_middle(piece, last) - rung_middle(piece, inner)).normalized();
        add(rung_middle(piece, last) + 0.55 * tab.length_mm * out,
            tab.slit_width_mm > 0.0
                ? "The tab: its arrow goes through the slit of the next piece."
                : "The tab: glue on it; the start of the next piece comes to lie on it.");
    }
    return found;
}

void append_number(Drawing& drawing,
                   const Point& from,
                   const Point& to,
                   const std::string& number) {
    Paths leader;
    leader.closed = false;
    leader.stroke = Stroke{kInk, 0.2, false};
    leader.lines = {{from + Point(0.0, 2.2), to}};
    drawing.shapes.emplace_back(std::move(leader));
    Paths dot;
    Points ring;
    Points badge;
    for (int i = 0; i < 20; ++i) {
        const Point direction(std::cos(i * std::numbers::pi / 10.0),
                              std::sin(i * std::numbers::pi / 10.0));
        ring.emplace_back(to + 0.45 * direction);
        badge.emplace_back(from + 2.2 * direction);
    }
    dot.lines = {std::move(ring), std::move(badge)};
    dot.fill = kInk;
    drawing.shapes.emplace_back(std::move(dot));
    Label label;
    label.text = number;
    label.at = from + Point(0.0, 1.05);
    label.size_mm = 3.0;
    label.anchor = Anchor::Middle;
    label.bold = true;
    label.colour = kWhite;
    drawing.shapes.emplace_back(std::move(label));
}

Drawing closeup_of(const Piece& piece,
                   const Colour& colour,
                   bool of_end,
                   PictureSize size,
                   std::vector<std::string>& legend) {
    const Closeup closeup(piece, of_end, size);
    Drawing drawing{size.width_mm, size.height_mm, {}, of_end ? "Its end" : "Its start"};
    append_piece(drawing, piece, closeup.place(), closeup.box(), colour);
    std::vector<Callout> callouts;
    for (Callout& callout : callouts_of(piece, closeup, of_end)) {
        // What the other picture explains already is not explained again.
        const bool known = std::any_of(legend.begin(), legend.end(), [&](const std::string& text) {
            return text.substr(0, 12) == callout.text.substr(0, 12);
        });
        if (!known) {
            callouts.push_back(std::move(callout));
        }
    }
    std::sort(callouts.begin(), callouts.end(),
              [](const Callout& a, const Callout& b) { return a.at.x() < b.at.x(); });
    double last_x = -1.0;
    const double least = 6.0;
    for (std::size_t i = 0; i < callouts.size(); ++i) {
        const double behind = least * static_cast<double>(callouts.size() - 1 - i);
        const double x =
            std::min(std::max(callouts[i].at.x(), last_x + least), size.width_mm - 2.4 - behind);
        last_x = std::max(x, 2.4);
        legend.push_back(callouts[i].text);
        append_number(drawing, {last_x, 2.6}, callouts[i].at, fmt::format("{}", legend.size()));
    }
    return drawing;
}

// How many kinds of things there are to explain.
int kinds_on(const Piece& piece) {
    std::vector<std::string> kinds;
    for (const Mark& mark : piece.marks) {
        const std::string kind = meaning_of(piece, mark).substr(0, 12);
        if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
            kinds.push_back(kind);
        }
    }
    return static_cast<int>(kinds.size()) + (piece.end_tab.length_mm > 0.0 ? 1 : 0);
}

}  // namespace

const Piece* typical_piece(const JobResult& job) {
    const Piece* best = nullptr;
    int best_score = -1;
    for (const Piece& piece : job.pieces) {
        if (piece.cut_left.size() < 2 || piece.cut_left.size() != piece.cut_right.size()) {
            continue;
        }
        const bool handy = piece.cell_count >= 8 && piece.cell_count <= 30;
        const int score = 2 * kinds_on(piece) + (handy ? 3 : 0);
        if (score > best_score) {
            best_score = score;
            best = &piece;
        }
    }
    return best;
}

ExplainedPiece explain_piece(const JobIndex& index, const Piece& piece) {
    const Palette palette = palette_of(index.job());
    const Colour& colour = palette.of(piece.family);
    ExplainedPiece explained;
    explained.drawings.push_back(whole_piece(piece, colour, {kTextWidthMm, 36.0}));
    const PictureSize size{(kTextWidthMm - 3.0) / 2.0, 38.0};
    explained.drawings.push_back(closeup_of(piece, colour, false, size, explained.legend));
    explained.drawings.push_back(closeup_of(piece, colour, true, size, explained.legend));
    return explained;
}

}  // namespace leafcutter::fab::guide
