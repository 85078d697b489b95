#include "fab/cut/micro_tabs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fab/cut/path_walk.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kClearMm = 0.5;         // Between a tab and a line,
constexpr double kFromCornerMm = 1.0;    // a corner, the end of a path
constexpr double kBetweenMm = 3.0;       // or another tab.
constexpr double kCornerCosine = 0.966;  // Of 15 degrees.
constexpr double kStraightMm = 0.01;     // A tab bends no more.
constexpr double kStepMm = 0.5;

// Where a band folds back: the points a little before and behind lie closest together there.
double end_of_band(const Polyline& whole, const std::vector<double>& stations) {
    const double length = stations.back();
    const double arm = length / 8.0;
    const auto round = [&](double at) {
        return point_at(whole, stations, at - length * std::floor(at / length));
    };
    constexpr int kLooks = 256;
    double best = 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kLooks; ++i) {
        const double at = length * i / kLooks;
        const double width = (round(at + arm) - round(at - arm)).squaredNorm();
        if (width < least) {
            least = width;
            best = at;
        }
    }
    return best;
}

class TabPlaces {
public:
    TabPlaces(std::span<CutPath* const> paths,
              std::span<const Segment> lines,
              const TabOptions& options)
        : paths_(paths), lines_(lines), half_mm_(options.length_mm / 2.0) {
        for (std::size_t p = 0; p < paths.size(); ++p) {
            stations_.push_back(stations_mm(paths[p]->points));
            for (double at = kStepMm; at < stations_[p].back(); at += kStepMm) {
                candidates_.push_back({p, at, point_at(paths[p]->points, stations_[p], at)});
            }
        }
    }

    // Puts a tab at the free place nearest to `target`.
    bool put_near(const Vector2d& target) {
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            order.emplace_back((candidates_[i].point - target).squaredNorm(), i);
        }
        std::sort(order.begin(), order.end());
        for (const auto& [distance, i] : order) {
            const Candidate& place = candidates_[i];
            if (!is_free(place)) {
                continue;
            }
            std::vector<DarkStretch>& tabs = paths_[place.path]->tabs;
            tabs.push_back({place.at_mm - half_mm_, place.at_mm + half_mm_});
            std::sort(tabs.begin(), tabs.end(), [](const DarkStretch& a, const DarkStretch& b) {
                return a.from_mm < b.from_mm;
            });
            return true;
        }
        return false;
    }

private:
    struct Candidate {
        std::size_t path = 0;
        double at_mm = 0.0;
        Vector2d point = Vector2d::Zero();
    };

    bool is_free(const Candidate& place) const {
        const CutPath& path = *paths_[place.path];
        const double low = place.at_mm - half_mm_;
        const double high = place.at_mm + half_mm_;
        for (const DarkStretch& tab : path.tabs) {
            if (low < tab.to_mm + kBetweenMm && high > tab.from_mm - kBetweenMm) {
                return false;
            }
        }
        return is_straight(place, low, high) && is_clear(place, low, high);
    }

    bool is_straight(const Candidate& place, double low, double high) const {
        const Polyline& points = paths_[place.path]->points;
        const std::vector<double>& stations = stations_[place.path];
        // The first and the last point count as corners, also of a closed path: it may start there.
        if (low < kFromCornerMm || high > stations.back() - kFromCornerMm) {
            return false;
        }
        const Segment chord{point_at(points, stations, low), point_at(points, stations, high)};
        const auto begin = std::upper_bound(stations.begin(), stations.end(), low - kFromCornerMm);
        for (auto i = static_cast<std::size_t>(begin - stations.begin());
             stations[i] < high + kFromCornerMm; ++i) {
            const Vector2d before = (points[i] - points[i - 1]).normalized();
            const Vector2d after = (points[i + 1] - points[i]).normalized();
            const bool within = stations[i] > low && stations[i] < high;
            if (before.dot(after) < kCornerCosine ||
                (within && squared_distance(points[i], chord) > kStraightMm * kStraightMm)) {
                return false;
            }
        }
        return true;
    }

    bool is_clear(const Candidate& place, double low, double high) const {
        const Polyline& points = paths_[place.path]->points;
        const std::vector<double>& stations = stations_[place.path];
        const Segment tab{point_at(points, stations, low), point_at(points, stations, high)};
        return std::none_of(lines_.begin(), lines_.end(), [&](const Segment& line) {
            return squared_distance(tab, line) < kClearMm * kClearMm;
        });
    }

    std::span<CutPath* const> paths_;
    std::span<const Segment> lines_;
    double half_mm_;
    std::vector<std::vector<double>> stations_;
    std::vector<Candidate> candidates_;
};

}  // namespace

int add_tabs(const Polyline& whole,
             std::span<CutPath* const> paths,
             std::span<const Segment> lines,
             const TabOptions& options) {
    const std::vector<double> stations = stations_mm(whole);
    const double first = end_of_band(whole, stations);
    TabPlaces places(paths, lines, options);
    int found = 0;
    for (int k = 0; k < options.count; ++k) {
        double at = first + stations.back() * k / options.count;
        at -= stations.back() * std::floor(at / stations.back());
        found += places.put_near(point_at(whole, stations, at)) ? 1 : 0;
    }
    return found;
}

}  // namespace leafcutter::fab
