#include "fab/cut/cut_order.h"

#include <algorithm>
#include <cmath>

#include "fab/cut/cut_cooling.h"
#include "fab/cut/cut_tour.h"
#include "fab/cut/path_walk.h"
#include "fab/nest/collision.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// Each path before the smallest closed one round it. Paths of one sheet don't cross, so one point
// tells.
Pairs inner_before_outer(const std::vector<CutPath>& paths) {
    std::vector<Box> boxes;
    std::vector<std::size_t> closed;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        boxes.push_back(bounds(paths[i].points));
        if (is_closed(paths[i])) {
            closed.push_back(i);
        }
    }
    const auto area = [&](std::size_t i) { return boxes[i].size().prod(); };
    std::stable_sort(closed.begin(), closed.end(),
                     [&](std::size_t a, std::size_t b) { return area(a) < area(b); });
    Pairs pairs;
    for (std::size_t inner = 0; inner < paths.size(); ++inner) {
        const auto round = std::find_if(closed.begin(), closed.end(), [&](std::size_t outer) {
            return outer != inner && (boxes[inner].low.array() >= boxes[outer].low.array()).all() &&
                   (boxes[inner].high.array() <= boxes[outer].high.array()).all() &&
                   contains(paths[outer].points, paths[inner].points.front());
        });
        if (round != closed.end()) {
            pairs.emplace_back(inner, *round);
        }
    }
    return pairs;
}

TourPlace place_of(const CutPath& path, const std::vector<double>& starts_mm) {
    if (!is_closed(path)) {
        return {true,
                {{path.points.front(), path.points.back(), 0},
                 {path.points.back(), path.points.front(), 1}}};
    }
    const std::vector<double> stations = stations_mm(path.points);
    TourPlace place;
    for (std::size_t i = 0; i < starts_mm.size(); ++i) {
        const Eigen::Vector2d point = point_at(path.points, stations, starts_mm[i]);
        place.starts.push_back({point, point, i});
    }
    return place;
}

// Open paths, strokes of letters most of them, have little to choose from. Time stays bounded.
std::int64_t evaluations_for(const std::vector<CutPath>& paths, std::int64_t each) {
    constexpr std::int64_t kMost = 6'000;  // Closed paths' worth.
    constexpr std::int64_t kOpenPart = 10;
    const std::int64_t closed = std::count_if(paths.begin(), paths.end(), is_closed);
    const auto open = static_cast<std::int64_t>(paths.size()) - closed;
    return each * std::min(kMost, closed + open / kOpenPart);
}

}  // namespace

std::vector<double> start_places(const CutPath& path) {
    constexpr double kParts = 40.0;
    constexpr double kLeastStepMm = 3.0;
    constexpr std::size_t kMost = 64;
    const std::vector<double> stations = stations_mm(path.points);
    const double step = std::max(kLeastStepMm, stations.back() / kParts);
    std::vector<double> places;
    for (std::size_t i = 1; i < stations.size(); ++i) {
        const double edge = stations[i] - stations[i - 1];
        const auto parts = static_cast<std::size_t>(std::max(1.0, std::round(edge / step)));
        for (std::size_t k = 0; k < parts; ++k) {
            places.push_back(stations[i - 1] +
                             edge * static_cast<double>(k) / static_cast<double>(parts));
        }
    }
    if (places.size() > kMost) {
        std::vector<double> fewer;
        for (std::size_t i = 0; i < kMost; ++i) {
            fewer.push_back(places[i * places.size() / kMost]);
        }
        return fewer;
    }
    return places;
}

std::vector<OrderedPath> find_order(const std::vector<CutPath>& paths,
                                    const Eigen::Vector2d& from,
                                    const OrderRules& rules,
                                    const geometry::Context& context) {
    TourProblem problem;
    problem.from = from;
    problem.before = rules.before;
    if (!paths.empty() && paths.front().operation == Operation::Cut) {
        const Pairs inner = inner_before_outer(paths);
        problem.before.insert(problem.before.end(), inner.begin(), inner.end());
    }
    std::vector<std::vector<double>> starts_mm = rules.starts_mm;
    starts_mm.resize(paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        if (starts_mm[i].empty() && is_closed(paths[i])) {
            starts_mm[i] = start_places(paths[i]);
        }
        problem.places.push_back(place_of(paths[i], starts_mm[i]));
    }
    problem.evaluations = evaluations_for(paths, rules.evaluations_each);
    std::vector<OrderedPath> order;
    order.reserve(paths.size());
    for (const TourStop& stop : shortest_tour(problem, context)) {
        const bool closed = is_closed(paths[stop.stop]);
        order.push_back({stop.stop, closed ? starts_mm[stop.stop][stop.start] : 0.0,
                         !closed && stop.start == 1});
    }
    if (rules.heat > 0.0 && !paths.empty()) {
        const HeatModel model(paths, rules.cooling);
        const CoolingTask task{model, from, problem.before, starts_mm, rules.heat};
        return cooled(task, std::move(order), context);
    }
    return order;
}

CutPath as_ordered(CutPath path, const OrderedPath& place) {
    CutPath started = started_at(std::move(path), place.start_mm);
    return place.backward ? reversed(std::move(started)) : started;
}

std::vector<CutPath> order_paths(std::vector<CutPath> paths,
                                 const Eigen::Vector2d& from,
                                 const OrderRules& rules,
                                 const geometry::Context& context) {
    std::vector<CutPath> ordered;
    ordered.reserve(paths.size());
    for (const OrderedPath& place : find_order(paths, from, rules, context)) {
        ordered.push_back(as_ordered(std::move(paths[place.path]), place));
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
