#include "fab/guide/weave_diagram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kWhite = {255, 255, 255};
constexpr Colour kBlack = {0, 0, 0};
constexpr Colour kInk = {34, 34, 34};
constexpr double kNames = 13.0;  // Left margin, for ids of rows.
constexpr double kPitch = 5.6;   // Widest distance of strips.
constexpr double kLeastPitch = 4.6;
constexpr double kBand = 0.39;  // Half the width of a strip, in pitches.
constexpr double kTextHeight = 2.3;
constexpr int kRowsBeside = 2;
constexpr std::size_t kLastColumns = 4;  // Shown behind a gap.

struct OrientedQuad {
    int quad = -1;
    int forward = 0;  // The side through which the strip leaves.
};

// Which columns of a long way are shown: all of it, or its begin and its end.
struct Window {
    std::vector<std::size_t> columns;
    std::size_t gap_before = 0;  // Place in `columns` of the first one behind the gap; 0: none.
    double pitch = kPitch;

    double x_of(std::size_t place) const {
        const double gap = gap_before > 0 && place >= gap_before ? 0.9 : 0.0;
        return kNames + (static_cast<double>(place) + 0.5 + gap) * pitch;
    }
    double width() const { return columns.empty() ? 0.0 : x_of(columns.size() - 1) + pitch / 2.0; }
};

Window window_of(std::size_t count, double width_mm) {
    Window window;
    const double room = width_mm - kNames - 1.0;
    const auto most = static_cast<std::size_t>(room / kLeastPitch);
    if (count <= most) {
        window.pitch =
            std::min(kPitch, room / static_cast<double>(std::max<std::size_t>(1, count)));
        for (std::size_t i = 0; i < count; ++i) {
            window.columns.push_back(i);
        }
        return window;
    }
    const auto shown = static_cast<std::size_t>(room / kLeastPitch - 0.9);
    window.pitch = room / (static_cast<double>(shown) + 0.9);
    window.gap_before = shown - std::min(kLastColumns, shown / 2);
    for (std::size_t i = 0; i < window.gap_before; ++i) {
        window.columns.push_back(i);
    }
    for (std::size_t i = count - (shown - window.gap_before); i < count; ++i) {
        window.columns.push_back(i);
    }
    return window;
}

Points box(const Point& low, const Point& high) {
    return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

Label small_label(std::string text, const Point& at, Anchor anchor) {
    Label label;
    label.text = std::move(text);
    label.at = at;
    label.size_mm = kTextHeight;
    label.anchor = anchor;
    return label;
}

class DiagramDrawer {
public:
    DiagramDrawer(const JobIndex& index, const Progress& progress, const DiagramStrips& strips)
        : index_(index),
          job_(index.job()),
          progress_(progress),
          strips_(strips),
          palette_(palette_of(job_)),
          strip_(job_.strips[static_cast<std::size_t>(strips.fresh.front())]) {}

    Drawing draw(PictureSize size) {
        walk();
        choose_rows();
        window_ = window_of(way_.size(), size.width_mm);
        top_ = 2.0 + name_height();
        Drawing drawing{size.width_mm,
                        std::min(size.height_mm, y_of(row_low_) + 1.0 * window_.pitch + 0.5),
                        {},
                        fmt::format("The way of {}", strip_.id)};
        drawing_ = &drawing;
        draw_cells();
        draw_gap();
        draw_names();
        draw_held();
        return drawing;
    }

private:
    bool is_fresh(int strip) const {
        return std::find(strips_.fresh.begin(), strips_.fresh.end(), strip) != strips_.fresh.end();
    }

    Family across() const { return strip_.family == Family::Weft ? Family::Warp : Family::Weft; }

    bool follow(int forward) {
        way_.clear();
        int side = forward;
        for (std::size_t i = 0; i < strip_.quads.size(); ++i) {
            way_.push_back({strip_.quads[i], side});
            if (i + 1 == strip_.quads.size()) {
                break;
            }
            const geometry::QuadSide& next =
                index_.neighbours().across[static_cast<std::size_t>(strip_.quads[i])]
                                          [static_cast<std::size_t>(side)];
            if (next.quad != strip_.quads[i + 1]) {
                return false;
            }
            side = (next.side + 2) % 4;
        }
        return true;
    }

    // The strip's cells with the side through which each is left; weft leaves through b–c, warp
    // through c–d, or both the other way round where they were begun elsewhere.
    void walk() {
        const int forward = strip_.family == Family::Weft ? 1 : 2;
        has_neighbours_ = follow(forward) || follow((forward + 2) % 4);
        if (!has_neighbours_) {
            way_.clear();
            for (const int quad : strip_.quads) {
                way_.push_back({quad, forward});
            }
        }
    }

    // `rows` steps to the left of the way, or to the right if negative.
    OrientedQuad beside(const OrientedQuad& from, int rows) const {
        OrientedQuad here = from;
        const int turn = rows > 0 ? 1 : 3;
        for (int i = 0; i < std::abs(rows) && here.quad >= 0; ++i) {
            if (!has_neighbours_) {
                return {};
            }
            const geometry::QuadSide& next =
                index_.neighbours().across[static_cast<std::size_t>(here.quad)]
                                          [static_cast<std::size_t>((here.forward + turn) % 4)];
            here = {next.quad, (next.side + 4 - (turn + 2) % 4) % 4};
        }
        return here;
    }

    bool is_there(int quad, Family family) const {
        const auto& laid = family == Family::Weft ? progress_.weft : progress_.warp;
        return laid[static_cast<std::size_t>(quad)] != 0 || is_fresh(index_.strip_at(quad, family));
    }

    bool row_is_there(int row) const {
        return std::any_of(way_.begin(), way_.end(), [&](const OrientedQuad& cell) {
            const OrientedQuad there = beside(cell, row);
            return there.quad >= 0 && is_there(there.quad, strip_.family);
        });
    }

    // The row itself, all fresh ones next to it, and two more on each side as far as they are laid.
    void choose_rows() {
        const auto extent = [&](int direction) {
            int row = 0;
            int old = 0;
            while (std::abs(row) < 6 && old < kRowsBeside) {
                const OrientedQuad next = beside(way_.front(), row + direction);
                // Over a joint between regions the weave does not go on yet.
                if (next.quad < 0 || !row_is_there(row + direction) ||
                    index_.region_of(next.quad) != index_.region_of(way_.front().quad)) {
                    break;
                }
                old += is_fresh(index_.strip_at(next.quad, strip_.family)) ? 0 : 1;
                row += direction;
            }
            return row;
        };
        row_high_ = extent(1);
        row_low_ = extent(-1);
    }

    double y_of(int row) const { return top_ + (row_high_ - row + 1.0) * window_.pitch; }

    double name_height() const {
        std::size_t longest = 2;
        for (const std::size_t column : window_.columns) {
            longest = std::max(longest, name_at(way_[column].quad, across()).size());
        }
        return 0.62 * kTextHeight * static_cast<double>(longest) + 1.0;
    }

    std::string name_at(int quad, Family family) const {
        const int strip = quad < 0 ? -1 : index_.strip_at(quad, family);
        return strip < 0 ? std::string() : job_.strips[static_cast<std::size_t>(strip)].id;
    }

    void band(const Points& area, const Colour& colour, bool runs_across) {
        Paths fill;
        fill.lines = {area};
        fill.fill = colour;
        drawing_->shapes.emplace_back(std::move(fill));
        Paths sides;
        sides.closed = false;
        sides.stroke = Stroke{mixed(colour, kBlack, 0.45), 0.2, false};
        if (runs_across) {
            sides.lines = {{area[0], area[1]}, {area[3], area[2]}};
        } else {
            sides.lines = {{area[0], area[3]}, {area[1], area[2]}};
        }
        drawing_->shapes.emplace_back(std::move(sides));
    }

    Colour colour_of(int quad, Family family) const {
        return is_fresh(index_.strip_at(quad, family)) ? palette_.accent : palette_.of(family);
    }

    // A cell's strip along the way, or across it, `half` pitches long on both sides.
    void draw_strip(const Point& at, int quad, bool runs_across, double half) {
        const Family family = runs_across ? strip_.family : across();
        if (!is_there(quad, family)) {
            return;
        }
        const Point reach = window_.pitch * (runs_across ? Point(half, kBand) : Point(kBand, half));
        band(box(at - reach, at + reach), colour_of(quad, family), runs_across);
    }

    void draw_cell(std::size_t place, int row) {
        const OrientedQuad cell = beside(way_[window_.columns[place]], row);
        if (cell.quad < 0) {
            return;
        }
        const Point at(window_.x_of(place), y_of(row));
        const bool warp_on_top = job_.weave.warp_on_top[static_cast<std::size_t>(cell.quad)] != 0;
        const bool across_on_top = warp_on_top == (strip_.family == Family::Weft);
        const bool both = is_there(cell.quad, strip_.family) && is_there(cell.quad, across());
        draw_strip(at, cell.quad, across_on_top, 0.5);
        if (both) {
            // White gaps at the long sides of the upper strip show that the lower one dives.
            const double wide = kBand + 0.08;
            const Point reach =
                window_.pitch * (across_on_top ? Point(wide, 0.5) : Point(0.5, wide));
            Paths gap;
            gap.lines = {box(at - reach, at + reach)};
            gap.fill = kWhite;
            drawing_->shapes.emplace_back(std::move(gap));
        }
        draw_strip(at, cell.quad, !across_on_top, 0.5);
    }

    void draw_cells() {
        for (std::size_t place = 0; place < window_.columns.size(); ++place) {
            const OrientedQuad& cell = way_[window_.columns[place]];
            // The strips across look out below and above.
            for (const int row : {row_high_, row_low_}) {
                const OrientedQuad end = beside(cell, row);
                if (end.quad >= 0) {
                    const Point out(0.0, (row == row_high_ ? -0.45 : 0.45) * window_.pitch);
                    draw_strip(Point(window_.x_of(place), y_of(row)) + out, end.quad, false, 0.5);
                    if (row_high_ == row_low_) {
                        draw_strip(Point(window_.x_of(place), y_of(row)) - out, end.quad, false,
                                   0.5);
                    }
                }
            }
            for (int row = row_low_; row <= row_high_; ++row) {
                draw_cell(place, row);
            }
        }
    }

    void draw_gap() {
        if (window_.gap_before == 0) {
            return;
        }
        const double x =
            (window_.x_of(window_.gap_before - 1) + window_.x_of(window_.gap_before)) / 2.0;
        for (int row = row_low_; row <= row_high_; ++row) {
            drawing_->shapes.emplace_back(
                small_label("\xe2\x80\xa6", {x, y_of(row) + 0.4}, Anchor::Middle));
        }
    }

    void draw_names() {
        for (std::size_t place = 0; place < window_.columns.size(); ++place) {
            const std::size_t column = window_.columns[place];
            Label label =
                small_label(name_at(way_[column].quad, across()),
                            {window_.x_of(place) + 0.35 * kTextHeight, top_ + 0.2}, Anchor::Start);
            label.angle_deg = 90.0;
            drawing_->shapes.emplace_back(std::move(label));
        }
        for (int row = row_low_; row <= row_high_; ++row) {
            const OrientedQuad first = beside(way_[window_.columns.front()], row);
            Label label = small_label(name_at(first.quad, strip_.family),
                                      {kNames - 3.2, y_of(row) + 0.36 * kTextHeight}, Anchor::End);
            const bool fresh =
                first.quad >= 0 && is_fresh(index_.strip_at(first.quad, strip_.family));
            label.bold = fresh;
            label.colour = fresh ? mixed(palette_.accent, kBlack, 0.15) : kInk;
            drawing_->shapes.emplace_back(std::move(label));
            if (fresh) {
                draw_arrow({kNames - 2.4, y_of(row)});
            }
        }
    }

    void draw_arrow(const Point& at) {
        Paths arrow;
        arrow.lines = {{at + Point(0.0, -0.8), at + Point(1.6, 0.0), at + Point(0.0, 0.8)}};
        arrow.fill = mixed(palette_.accent, kBlack, 0.15);
        drawing_->shapes.emplace_back(std::move(arrow));
    }

    // A ring around every crossing that has to be threaded.
    void draw_held() {
        Paths rings;
        rings.stroke = Stroke{kInk, 0.35, false};
        for (std::size_t place = 0; place < window_.columns.size(); ++place) {
            const auto column = static_cast<int>(window_.columns[place]);
            if (std::find(strips_.held.begin(), strips_.held.end(), column) != strips_.held.end()) {
                const Point at(window_.x_of(place), y_of(0));
                Points ring;
                for (int i = 0; i < 16; ++i) {
                    const double angle = i * std::numbers::pi / 8.0;
                    ring.emplace_back(at + 0.3 * window_.pitch *
                                               Point(std::cos(angle), std::sin(angle)));
                }
                rings.lines.push_back(std::move(ring));
            }
        }
        if (!rings.lines.empty()) {
            drawing_->shapes.emplace_back(std::move(rings));
        }
    }

    const JobIndex& index_;
    const JobResult& job_;
    const Progress& progress_;
    const DiagramStrips& strips_;
    Palette palette_;
    const Strip& strip_;
    std::vector<OrientedQuad> way_;
    bool has_neighbours_ = false;
    int row_low_ = 0;
    int row_high_ = 0;
    Window window_;
    double top_ = 0.0;
    Drawing* drawing_ = nullptr;
};

}  // namespace

Drawing weave_diagram(const JobIndex& index,
                      const Progress& progress,
                      const DiagramStrips& strips,
                      PictureSize size) {
    return DiagramDrawer(index, progress, strips).draw(size);
}

Drawing base_diagram(const JobIndex& index, const std::vector<int>& strips, PictureSize size) {
    const Palette palette = palette_of(index.job());
    const Window window = window_of(strips.size(), size.width_mm);
    constexpr double kTop = 9.0;
    const double bottom = std::min(size.height_mm - 4.0, 32.0);
    Drawing drawing{size.width_mm, bottom + 4.0, {}, "Strips side by side"};
    for (std::size_t place = 0; place < window.columns.size(); ++place) {
        const Strip& strip =
            index.job().strips[static_cast<std::size_t>(strips[window.columns[place]])];
        const double x = window.x_of(place);
        const double half = kBand * window.pitch;
        Paths band;
        band.lines = {box({x - half, kTop}, {x + half, bottom})};
        band.fill = palette.accent;
        band.stroke = Stroke{mixed(palette.accent, kBlack, 0.45), 0.2, false};
        drawing.shapes.emplace_back(std::move(band));
        Paths arrow;
        arrow.lines = {{{x - 0.8, kTop + 4.2}, {x, kTop + 2.4}, {x + 0.8, kTop + 4.2}}};
        arrow.fill = kWhite;
        drawing.shapes.emplace_back(std::move(arrow));
        Label label = small_label(strip.id, {x + 0.35 * kTextHeight, kTop - 0.8}, Anchor::Start);
        label.angle_deg = 90.0;
        label.bold = true;
        drawing.shapes.emplace_back(std::move(label));
    }
    if (window.gap_before > 0) {
        const double x =
            (window.x_of(window.gap_before - 1) + window.x_of(window.gap_before)) / 2.0;
        drawing.shapes.emplace_back(
            small_label("\xe2\x80\xa6", {x, (kTop + bottom) / 2.0}, Anchor::Middle));
    }
    return drawing;
}

}  // namespace leafcutter::fab::guide
