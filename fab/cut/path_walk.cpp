#include "fab/cut/path_walk.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace leafcutter::fab {

namespace {

constexpr double kSamePointMm = 1e-3;  // As fine as programs are written.

void add_point(Polyline& points, const Eigen::Vector2d& point) {
    if (points.empty() || (points.back() - point).norm() > kSamePointMm) {
        points.push_back(point);
    }
}

}  // namespace

bool is_closed(const CutPath& path) {
    return path.points.size() > 3 && path.points.front() == path.points.back();
}

double length_mm(const Polyline& points) {
    double sum = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        sum += (points[i] - points[i - 1]).norm();
    }
    return sum;
}

std::vector<double> stations_mm(const Polyline& points) {
    std::vector<double> stations;
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        sum += i == 0 ? 0.0 : (points[i] - points[i - 1]).norm();
        stations.push_back(sum);
    }
    return stations;
}

Eigen::Vector2d point_at(const Polyline& points,
                         const std::vector<double>& stations_mm,
                         double at_mm) {
    const auto next = std::upper_bound(stations_mm.begin(), stations_mm.end(), at_mm);
    if (next == stations_mm.begin()) {
        return points.front();
    }
    if (next == stations_mm.end()) {
        return points.back();
    }
    const auto i = static_cast<std::size_t>(next - stations_mm.begin());
    const double part = (at_mm - stations_mm[i - 1]) / (stations_mm[i] - stations_mm[i - 1]);
    return points[i - 1] + part * (points[i] - points[i - 1]);
}

Polyline stretch(const Polyline& points, double from_mm, double to_mm) {
    const std::vector<double> stations = stations_mm(points);
    Polyline out{point_at(points, stations, from_mm)};
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (stations[i] > from_mm && stations[i] < to_mm) {
            add_point(out, points[i]);
        }
    }
    const Eigen::Vector2d end = point_at(points, stations, to_mm);
    if (out.size() > 1 && (out.back() - end).norm() <= kSamePointMm) {
        out.back() = end;
    } else {
        out.push_back(end);
    }
    return out;
}

CutPath started_at(CutPath path, double at_mm) {
    const double length = length_mm(path.points);
    if (!is_closed(path) || at_mm <= kSamePointMm || at_mm >= length - kSamePointMm) {
        return path;
    }
    Polyline turned = stretch(path.points, at_mm, length);
    const Polyline head = stretch(path.points, 0.0, at_mm);
    turned.insert(turned.end(), head.begin() + 1, head.end());
    turned.back() = turned.front();
    path.points = std::move(turned);
    for (DarkStretch& tab : path.tabs) {
        const double shift = tab.from_mm < at_mm ? length - at_mm : -at_mm;
        tab.from_mm += shift;
        tab.to_mm += shift;
    }
    std::sort(path.tabs.begin(), path.tabs.end(),
              [](const DarkStretch& a, const DarkStretch& b) { return a.from_mm < b.from_mm; });
    return path;
}

CutPath reversed(CutPath path) {
    const double length = length_mm(path.points);
    std::reverse(path.points.begin(), path.points.end());
    std::reverse(path.tabs.begin(), path.tabs.end());
    for (DarkStretch& tab : path.tabs) {
        tab = {length - tab.to_mm, length - tab.from_mm};
    }
    return path;
}

std::vector<Polyline> burnt_runs(const CutPath& path) {
    if (path.tabs.empty()) {
        return {path.points};
    }
    std::vector<Polyline> runs;
    double at = 0.0;
    for (const DarkStretch& tab : path.tabs) {
        runs.push_back(stretch(path.points, at, tab.from_mm));
        at = tab.to_mm;
    }
    runs.push_back(stretch(path.points, at, length_mm(path.points)));
    return runs;
}

std::vector<Polyline> drawn_runs(const CutPath& path) {
    std::vector<Polyline> runs = burnt_runs(path);
    if (runs.size() > 1 && is_closed(path)) {
        runs.back().insert(runs.back().end(), runs.front().begin() + 1, runs.front().end());
        runs.erase(runs.begin());
    }
    return runs;
}

}  // namespace leafcutter::fab
