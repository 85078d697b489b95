// Nearest neighbour, then 2-opt and Or-opt over near neighbours in turn with an exact choice of all
// starts for the order found (dynamic programming along the tour).

#include "fab/cut/cut_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "fab/cut/cut_tour.h"
#include "fab/nest/collision.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

bool is_closed(const CutPath& path) {
    return path.points.size() > 3 && path.points.front() == path.points.back();
}

// How many closed paths enclose each path. Paths of one sheet don't cross, so one point tells.
std::vector<int> depths(const std::vector<CutPath>& paths) {
    std::vector<Box> boxes;
    boxes.reserve(paths.size());
    for (const CutPath& path : paths) {
        boxes.push_back(bounds(path.points));
    }
    std::vector<int> depth(paths.size(), 0);
    for (std::size_t outer = 0; outer < paths.size(); ++outer) {
        if (!is_closed(paths[outer])) {
            continue;
        }
        for (std::size_t inner = 0; inner < paths.size(); ++inner) {
            if (inner != outer && (boxes[inner].low.array() >= boxes[outer].low.array()).all() &&
                (boxes[inner].high.array() <= boxes[outer].high.array()).all() &&
                contains(paths[outer].points, paths[inner].points.front())) {
                ++depth[inner];
            }
        }
    }
    return depth;
}

// Where a path may begin, and where it then ends.
std::vector<TourStart> starts_of(const CutPath& path) {
    constexpr std::size_t kMostStarts = 48;
    const std::size_t last = path.points.size() - 1;
    if (!is_closed(path)) {
        return {{path.points.front(), path.points.back(), 0},
                {path.points.back(), path.points.front(), last}};
    }
    std::vector<TourStart> starts;
    const std::size_t count = std::min(last, kMostStarts);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t point = i * last / count;
        starts.push_back({path.points[point], path.points[point], point});
    }
    return starts;
}

CutPath started_at(CutPath path, std::size_t point) {
    if (is_closed(path)) {
        path.points.pop_back();
        std::rotate(path.points.begin(), path.points.begin() + static_cast<std::ptrdiff_t>(point),
                    path.points.end());
        path.points.push_back(path.points.front());
    } else if (point != 0) {
        std::reverse(path.points.begin(), path.points.end());
    }
    return path;
}

}  // namespace

std::vector<CutPath> order_paths(std::vector<CutPath> paths,
                                 const Eigen::Vector2d& from,
                                 const geometry::Context& context) {
    std::map<int, std::vector<std::size_t>, std::greater<>> levels;  // Deepest first.
    const std::vector<int> depth = depths(paths);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        levels[depth[i]].push_back(i);
    }
    std::vector<CutPath> ordered;
    ordered.reserve(paths.size());
    Eigen::Vector2d at = from;
    for (const auto& [level, members] : levels) {
        std::vector<std::vector<TourStart>> stops;
        for (const std::size_t member : members) {
            stops.push_back(starts_of(paths[member]));
        }
        for (const TourStop& stop : shortest_tour(stops, at, context)) {
            CutPath& path = paths[members[stop.stop]];
            ordered.push_back(started_at(std::move(path), stops[stop.stop][stop.start].point));
            at = ordered.back().points.back();
        }
    }
    return ordered;
}

double travel_mm(const std::vector<CutPath>& paths, const Eigen::Vector2d& from) {
    double sum = 0.0;
    Eigen::Vector2d at = from;
    for (const CutPath& path : paths) {
        sum += (path.points.front() - at).norm();
        at = path.points.back();
    }
    return sum;
}

}  // namespace leafcutter::fab
