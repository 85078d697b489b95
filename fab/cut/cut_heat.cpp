#include "fab/cut/cut_heat.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fab/cut/path_walk.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kStepPart = 0.8;     // Between samples, of the reach,
constexpr double kMostSamples = 1e5;  // or more where there would be more than these.
constexpr double kReaches = 2.5;      // Heat that goes farther is left out: 4 %.
constexpr double kColdDecays = 6.0;   // As is heat older than this.

std::size_t cell_of(const Vector2d& point,
                    const Vector2d& low,
                    double cell_mm,
                    std::size_t columns) {
    const auto x = static_cast<std::size_t>((point.x() - low.x()) / cell_mm);
    const auto y = static_cast<std::size_t>((point.y() - low.y()) / cell_mm);
    return y * columns + x;
}

}  // namespace

HeatOptions cooling_of(const Material& material, const MachineProfile& machine) {
    constexpr double kHeatCapacity = 1400.0;  // J/(kg K): paper, wood, felt.
    constexpr double kToAir = 15.0;           // W/(m² K), each face, still air.
    HeatOptions options;
    options.decay_s =
        std::max(1.0, material.weight_g_per_m2 / 1000.0 * kHeatCapacity / (2.0 * kToAir));
    options.burn_mm_per_s =
        std::max(1.0, material.cut.feed_mm_per_min / 60.0) / std::max(1, material.cut.passes);
    options.travel_mm_per_s = std::max(1.0, machine.rapid_mm_per_min / 60.0);
    return options;
}

HeatModel::HeatModel(const std::vector<CutPath>& paths, const HeatOptions& options)
    : options_(options), near_(paths.size()) {
    double total = 0.0;
    for (const CutPath& path : paths) {
        points_.push_back(path.points);
        stations_.push_back(stations_mm(path.points));
        length_mm_.push_back(stations_.back().back());
        closed_.push_back(is_closed(path) ? 1 : 0);
        total += length_mm_.back();
    }
    const double step = std::max(kStepPart * options.reach_mm, total / kMostSamples);
    std::vector<Sample> samples;
    for (std::size_t p = 0; p < paths.size(); ++p) {
        first_sample_.push_back(samples.size());
        const int count = std::max(1, static_cast<int>(std::round(length_mm_[p] / step)));
        for (int i = 0; i < count; ++i) {
            const double at = length_mm_[p] * (i + 0.5) / count;
            samples.push_back(
                {point_at(points_[p], stations_[p], at), at, length_mm_[p] / count, p});
        }
    }
    first_sample_.push_back(samples.size());
    for (const Sample& sample : samples) {
        sample_at_mm_.push_back(sample.at_mm);
    }
    find_exchanges(samples);
}

void HeatModel::find_exchanges(const std::vector<Sample>& samples) {
    first_exchange_.push_back(0);
    if (samples.empty()) {
        return;
    }
    const double reach = kReaches * options_.reach_mm;
    Vector2d low = samples.front().point;
    Vector2d high = low;
    for (const Sample& sample : samples) {
        low = low.cwiseMin(sample.point);
        high = high.cwiseMax(sample.point);
    }
    low.array() -= reach;  // A rim of empty cells.
    const auto columns = static_cast<std::size_t>((high.x() - low.x()) / reach) + 2;
    const auto rows = static_cast<std::size_t>((high.y() - low.y()) / reach) + 2;
    std::vector<std::vector<std::size_t>> cells(columns * rows);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        cells[cell_of(samples[i].point, low, reach, columns)].push_back(i);
    }
    const double unit = std::sqrt(2.0 * std::numbers::pi) * options_.reach_mm;
    for (const Sample& sample : samples) {
        const std::size_t home = cell_of(sample.point, low, reach, columns);
        for (const std::size_t row : {home - columns, home, home + columns}) {
            for (std::size_t cell = row - 1; cell <= row + 1 && cell < cells.size(); ++cell) {
                for (const std::size_t other : cells[cell]) {
                    const double square = (samples[other].point - sample.point).squaredNorm();
                    if (samples[other].path != sample.path && square < reach * reach) {
                        const double spread =
                            std::exp(-square / (2.0 * options_.reach_mm * options_.reach_mm));
                        exchanges_.push_back(
                            {static_cast<std::uint32_t>(samples[other].path),
                             static_cast<float>(samples[other].at_mm),
                             static_cast<float>(samples[other].mm / unit * spread)});
                        near_[sample.path].push_back(samples[other].path);
                    }
                }
            }
        }
        first_exchange_.push_back(exchanges_.size());
    }
    for (std::vector<std::size_t>& list : near_) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
}

Vector2d HeatModel::entry(const OrderedPath& place) const {
    if (closed(place.path)) {
        return point_at(points_[place.path], stations_[place.path], place.start_mm);
    }
    return place.backward ? points_[place.path].back() : points_[place.path].front();
}

Vector2d HeatModel::exit(const OrderedPath& place) const {
    if (closed(place.path)) {
        return entry(place);
    }
    return place.backward ? points_[place.path].front() : points_[place.path].back();
}

double HeatModel::time_in(const OrderedPath& place, double at_mm) const {
    const double length = length_mm_[place.path];
    double way = at_mm - place.start_mm;
    if (!closed(place.path)) {
        way = place.backward ? length - at_mm : at_mm;
    } else {
        way = place.backward ? -way : way;
        way += way < 0.0 ? length : 0.0;
    }
    return way / options_.burn_mm_per_s;
}

double HeatModel::index(const OrderedPath& place,
                        double begin_s,
                        std::span<const OrderedPath> places,
                        std::span<const double> begins_s) const {
    const double cold_s = kColdDecays * options_.decay_s;
    double peak = 0.0;
    for (std::size_t s = first_sample_[place.path]; s < first_sample_[place.path + 1]; ++s) {
        const double now = begin_s + time_in(place, sample_at_mm_[s]);
        double heat = 0.0;
        for (std::size_t e = first_exchange_[s]; e < first_exchange_[s + 1]; ++e) {
            const Exchange& exchange = exchanges_[e];
            const double begun = begins_s[exchange.path];
            if (begun >= now || begun + burn_s(exchange.path) < now - cold_s) {
                continue;
            }
            const double age =
                now - begun - time_in(places[exchange.path], static_cast<double>(exchange.at_mm));
            if (age > 0.0 && age < cold_s) {
                heat += static_cast<double>(exchange.heat) * std::exp(-age / options_.decay_s);
            }
        }
        peak = std::max(peak, heat);
    }
    return peak;
}

std::vector<double> HeatModel::begins_s(std::span<const OrderedPath> order,
                                        const Vector2d& from) const {
    std::vector<double> begins(order.size());
    double now = 0.0;
    Vector2d at = from;
    for (const OrderedPath& place : order) {
        now += (entry(place) - at).norm() / options_.travel_mm_per_s;
        begins[place.path] = now;
        now += burn_s(place.path);
        at = exit(place);
    }
    return begins;
}

double HeatModel::peak(std::span<const OrderedPath> order, const Vector2d& from) const {
    const std::vector<double> begins = begins_s(order, from);
    std::vector<OrderedPath> places(order.size());
    for (const OrderedPath& place : order) {
        places[place.path] = place;
    }
    double peak = 0.0;
    for (const OrderedPath& place : order) {
        peak = std::max(peak, index(place, begins[place.path], places, begins));
    }
    return peak;
}

}  // namespace leafcutter::fab
