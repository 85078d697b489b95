#include "fab/guide/clip_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <polyclipping/clipper.hpp>

namespace leafcutter::fab::guide {

namespace {

// The part of a segment inside of a box (Liang and Barsky).
std::optional<std::pair<Point, Point>> clipped(const Point& from, const Point& to, const Box& box) {
    double begin = 0.0;
    double end = 1.0;
    const Point way = to - from;
    for (int axis = 0; axis < 2; ++axis) {
        const std::array<double, 2> runs = {-way[axis], way[axis]};
        const std::array<double, 2> rooms = {from[axis] - box.low[axis],
                                             box.high[axis] - from[axis]};
        for (std::size_t i = 0; i < 2; ++i) {
            if (runs[i] == 0.0) {
                if (rooms[i] < 0.0) {
                    return std::nullopt;
                }
            } else if (runs[i] < 0.0) {
                begin = std::max(begin, rooms[i] / runs[i]);
            } else {
                end = std::min(end, rooms[i] / runs[i]);
            }
        }
    }
    if (begin >= end) {
        return std::nullopt;
    }
    return std::pair<Point, Point>(from + begin * way, from + end * way);
}

}  // namespace

void append_clipped(std::vector<Points>& lines, const Points& line, bool closed, const Box& box) {
    const std::size_t segments = line.size() - (closed || line.empty() ? 0 : 1);
    for (std::size_t i = 0; i < segments; ++i) {
        const auto part = clipped(line[i], line[(i + 1) % line.size()], box);
        if (!part) {
            continue;
        }
        if (!lines.empty() && !lines.back().empty() && i > 0 &&
            lines.back().back() == part->first) {
            lines.back().push_back(part->second);
        } else {
            lines.push_back({part->first, part->second});
        }
    }
}

std::vector<Points> area_inside(const Points& ring, const Box& box) {
    constexpr double kSteps = 1000.0;
    const auto point_of = [](const Point& p) {
        return ClipperLib::IntPoint(std::llround(p.x() * kSteps), std::llround(p.y() * kSteps));
    };
    ClipperLib::Path subject;
    for (const Point& point : ring) {
        subject.push_back(point_of(point));
    }
    const ClipperLib::Path window = {point_of(box.low), point_of({box.high.x(), box.low.y()}),
                                     point_of(box.high), point_of({box.low.x(), box.high.y()})};
    ClipperLib::Clipper clipper;
    clipper.AddPath(subject, ClipperLib::ptSubject, true);
    clipper.AddPath(window, ClipperLib::ptClip, true);
    ClipperLib::Paths parts;
    clipper.Execute(ClipperLib::ctIntersection, parts, ClipperLib::pftNonZero,
                    ClipperLib::pftNonZero);
    std::vector<Points> areas;
    for (const ClipperLib::Path& part : parts) {
        Points area;
        for (const ClipperLib::IntPoint& p : part) {
            area.emplace_back(static_cast<double>(p.X) / kSteps, static_cast<double>(p.Y) / kSteps);
        }
        areas.push_back(std::move(area));
    }
    return areas;
}

}  // namespace leafcutter::fab::guide
