#include "fab/guide/view_drawing.h"

#include <algorithm>
#include <cmath>

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kBlack = {0, 0, 0};
constexpr Colour kOutline = {40, 40, 40};

}  // namespace

Colour mixed(const Colour& one, const Colour& other, double part_of_other) {
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround(a + part_of_other * (b - a)));
    };
    return {mix(one.red, other.red), mix(one.green, other.green), mix(one.blue, other.blue)};
}

PictureSize fitted(const View& view, PictureSize size) {
    const Point extent = (view.high - view.low).cwiseMax(1e-9);
    const double scale = std::min((size.width_mm - 2.0 * kMargin) / extent.x(),
                                  (size.height_mm - 2.0 * kMargin) / extent.y());
    return {size.width_mm, std::min(size.height_mm, scale * extent.y() + 2.0 * kMargin)};
}

int light_level(double light) {
    return std::clamp(static_cast<int>(light * kLightLevels), 0, kLightLevels - 1);
}

Colour lit(const Colour& colour, int level, bool outside) {
    const double dark = 0.38 * (1.0 - static_cast<double>(level) / (kLightLevels - 1));
    return mixed(colour, kBlack, std::min(0.7, dark + (outside ? 0.0 : 0.3)));
}

void append_outline(Drawing& drawing, const View& view, const Frame& frame) {
    Paths contours;
    contours.closed = false;
    contours.stroke = Stroke{kOutline, 0.18, false};
    for (const Points& line : view.contours) {
        contours.lines.push_back(frame(line));
    }
    Paths around;
    around.stroke = Stroke{kOutline, 0.35, false};
    for (const Points& line : view.outline) {
        around.lines.push_back(frame(line));
    }
    drawing.shapes.emplace_back(std::move(contours));
    drawing.shapes.emplace_back(std::move(around));
}

}  // namespace leafcutter::fab::guide
