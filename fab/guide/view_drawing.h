// What pictures of views are drawn with: scale, light, areas by colour, outlines.

#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "fab/guide/pictures.h"

namespace leafcutter::fab::guide {

constexpr double kMargin = 1.0;  // Around a view, mm.
constexpr int kLightLevels = 5;

// Fits a view into a box and centres it.
class Frame {
public:
    Frame(const View& view, PictureSize size, double margin_mm) {
        const Point extent = (view.high - view.low).cwiseMax(1e-9);
        scale_ = std::min((size.width_mm - 2.0 * margin_mm) / extent.x(),
                          (size.height_mm - 2.0 * margin_mm) / extent.y());
        offset_ =
            Point(size.width_mm, size.height_mm) / 2.0 - scale_ * (view.low + view.high) / 2.0;
    }

    Point operator()(const Point& point) const { return scale_ * point + offset_; }

    Points operator()(const Points& line) const {
        Points mapped;
        mapped.reserve(line.size());
        for (const Point& point : line) {
            mapped.push_back((*this)(point));
        }
        return mapped;
    }

private:
    double scale_ = 1.0;
    Point offset_ = Point::Zero();
};

// Fits the picture's height to what is seen.
PictureSize fitted(const View& view, PictureSize size);

// From 0, dark, to kLightLevels - 1. Few levels make few paths.
int light_level(double light);

// Darker for less light; what is seen from inside darker still.
Colour lit(const Colour& colour, int level, bool outside);

// Areas gathered by colour, so that a picture is few paths.
class ColourGroups {
public:
    void add(const Colour& colour, const std::vector<Points>& areas, const Frame& frame) {
        std::vector<Points>& lines = groups_[{colour.red, colour.green, colour.blue}];
        for (const Points& area : areas) {
            lines.push_back(frame(area));
        }
    }

    // Each area with a thin line around it, of its own colour but darker, or of `line`.
    void append_to(Drawing& drawing, double line_mm, const std::optional<Colour>& line = {}) {
        for (auto& [key, lines] : groups_) {
            const auto& [red, green, blue] = key;
            const Colour colour{red, green, blue};
            Paths paths;
            paths.lines = std::move(lines);
            paths.fill = colour;
            paths.stroke = Stroke{line ? *line : mixed(colour, {0, 0, 0}, 0.3), line_mm, false};
            drawing.shapes.emplace_back(std::move(paths));
        }
    }

private:
    std::map<std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>, std::vector<Points>> groups_;
};

// Around all that is seen, and where the surface turns away.
void append_outline(Drawing& drawing, const View& view, const Frame& frame);

}  // namespace leafcutter::fab::guide
