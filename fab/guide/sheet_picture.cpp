#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "fab/guide/piece_picture.h"

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kWhite = {255, 255, 255};
constexpr Colour kBlack = {0, 0, 0};

class SheetDrawer {
public:
    SheetDrawer(const JobIndex& index, const Sheet& sheet, PictureSize size)
        : index_(index),
          sheet_(sheet),
          palette_(palette_of(index.job())),
          scale_(std::min((size.width_mm - 1.0) / sheet.size.width_mm,
                          (size.height_mm - 1.0) / sheet.size.height_mm)) {}

    Drawing draw() {
        Drawing drawing{scale_ * sheet_.size.width_mm + 1.0,
                        scale_ * sheet_.size.height_mm + 1.0,
                        {},
                        fmt::format("Sheet {}", sheet_.id)};
        Paths edge;
        edge.stroke = Stroke{Colour{150, 150, 150}, 0.25, false};
        edge.lines = {{place({0.0, 0.0}), place({sheet_.size.width_mm, 0.0}),
                       place({sheet_.size.width_mm, sheet_.size.height_mm}),
                       place({0.0, sheet_.size.height_mm})}};
        drawing.shapes.emplace_back(std::move(edge));
        for (const Placement& placement : sheet_.placements) {
            const Piece* piece = index_.piece(placement.piece);
            if (piece != nullptr && piece->cut_left.size() >= 2) {
                add_outline(*piece, placement);
                add_name(*piece, placement);
            }
        }
        for (auto& [family, paths] : outlines_) {
            drawing.shapes.emplace_back(std::move(paths));
        }
        for (Label& label : labels_) {
            drawing.shapes.emplace_back(std::move(label));
        }
        return drawing;
    }

private:
    Point place(const Point& p) const {
        return {scale_ * p.x() + 0.5, scale_ * (sheet_.size.height_mm - p.y()) + 0.5};
    }

    void add_outline(const Piece& piece, const Placement& placement) {
        Paths& paths = outlines_[static_cast<int>(piece.family)];
        paths.fill = mixed(palette_.of(piece.family), kWhite, 0.7);
        paths.stroke = Stroke{mixed(palette_.of(piece.family), kBlack, 0.5), 0.15, false};
        Points ring;
        for (const Point& point : piece.outline) {
            ring.push_back(place(placement.apply(point)));
        }
        paths.lines.push_back(std::move(ring));
    }

    // Along the piece, in the middle of it, never upside down.
    void add_name(const Piece& piece, const Placement& placement) {
        const std::size_t cell = (piece.cut_left.size() - 1) / 2;
        const std::size_t next = std::min(cell + 1, piece.cut_left.size() - 1);
        const std::size_t first = cell == next ? cell - 1 : cell;
        const auto middle = [&](std::size_t rung) {
            return place(placement.apply((piece.cut_left[rung] + piece.cut_right[rung]) / 2.0));
        };
        const Point one = middle(first);
        const Point two = middle(next);
        double angle = -std::atan2(two.y() - one.y(), two.x() - one.x());
        if (std::abs(angle) > 0.5 * std::numbers::pi + 0.01) {
            angle += angle > 0.0 ? -std::numbers::pi : std::numbers::pi;
        }
        const double width = scale_ * (piece.cut_left[first] - piece.cut_right[first]).norm();
        Label label;
        label.text = piece.id;
        label.size_mm = std::clamp(0.62 * width, 1.1, 2.6);
        label.anchor = Anchor::Middle;
        label.angle_deg = angle * 180.0 / std::numbers::pi;
        label.at =
            (one + two) / 2.0 + 0.35 * label.size_mm * Point(std::sin(angle), std::cos(angle));
        labels_.push_back(std::move(label));
    }

    const JobIndex& index_;
    const Sheet& sheet_;
    Palette palette_;
    double scale_;
    std::map<int, Paths> outlines_;  // Per family.
    std::vector<Label> labels_;
};

}  // namespace

Drawing sheet_picture(const JobIndex& index, const Sheet& sheet, PictureSize size) {
    return SheetDrawer(index, sheet, size).draw();
}

}  // namespace leafcutter::fab::guide
