#include "geometry/quads/rectangle_rows.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "geometry/disjoint_sets.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Takes [from.first, from.second] to [to.first, to.second].
double carried(double x,
               const std::pair<double, double>& from,
               const std::pair<double, double>& to) {
    const double part = (x - from.first) / (from.second - from.first);
    return to.first + part * (to.second - to.first);
}

}  // namespace

RectangleRows::RectangleRows(const SideNetwork& network,
                             const RectangleCounter& counter,
                             RectangleCounts& counts)
    : network_(network) {
    for (;;) {
        set_levels(counts);
        if (levels_rise(counts)) {
            break;
        }
        for (int& rows : counts.rows) {
            rows = std::max(rows, 1);
        }
    }
    for (std::size_t b = 0; b < network.bands.size(); ++b) {
        const FormBand& band = network.bands[b];
        if (counts.rows[b] == 0) {
            band_levels_.push_back({level(band.lower)});
            continue;
        }
        std::vector<double> levels = counter.band_levels(static_cast<int>(b), counts.rows[b]);
        const std::pair<double, double> own{levels.front(), levels.back()};
        const std::pair<double, double> common{band.lower < 0 ? own.first : level(band.lower),
                                               band.upper < 0 ? own.second : level(band.upper)};
        for (double& value : levels) {
            value = carried(value, own, common);
        }
        levels.front() = common.first;
        levels.back() = common.second;
        band_levels_.push_back(std::move(levels));
    }
}

// Zeros that share a row meet in the middle.
void RectangleRows::set_levels(const RectangleCounts& counts) {
    DisjointSets joined(network_.zeros.size());
    for (std::size_t b = 0; b < network_.bands.size(); ++b) {
        if (counts.rows[b] == 0) {
            joined.unite(static_cast<std::uint32_t>(network_.bands[b].lower),
                         static_cast<std::uint32_t>(network_.bands[b].upper));
        }
    }
    std::vector<double> sum(network_.zeros.size(), 0.0);
    std::vector<int> count(network_.zeros.size(), 0);
    for (std::uint32_t z = 0; z < network_.zeros.size(); ++z) {
        sum[joined.find(z)] += network_.zeros[z].f;
        ++count[joined.find(z)];
    }
    level_.clear();
    for (std::uint32_t z = 0; z < network_.zeros.size(); ++z) {
        level_.push_back(sum[joined.find(z)] / count[joined.find(z)]);
    }
}

// Along every side, and through every band that has rows.
bool RectangleRows::levels_rise(const RectangleCounts& counts) const {
    for (std::size_t b = 0; b < network_.bands.size(); ++b) {
        const FormBand& band = network_.bands[b];
        if (counts.rows[b] > 0 && band.lower >= 0 && band.upper >= 0 &&
            !(level(band.lower) < level(band.upper))) {
            return false;
        }
    }
    return std::all_of(network_.sides.begin(), network_.sides.end(), [&](const CriticalSide& side) {
        const int low = network_.zero_of(side.points.front());
        const int high = network_.zero_of(side.points.back());
        const double from = low < 0 ? side.f.front() : level(low);
        const double to = high < 0 ? side.f.back() : level(high);
        return from < to;
    });
}

std::vector<double> RectangleRows::levels(int cylinder) const {
    const std::vector<int>& bands = network_.band_at[at(cylinder)];
    std::vector<double> levels{band_levels_[at(bands.front())].front()};
    for (std::size_t k = 0; k < bands.size(); ++k) {
        if (k == 0 || bands[k] != bands[k - 1]) {
            const std::vector<double>& own = band_levels_[at(bands[k])];
            levels.insert(levels.end(), own.begin() + 1, own.end());
        }
    }
    return levels;
}

int RectangleRows::rows_below(int cylinder, int zero) const {
    const std::vector<int>& bands = network_.band_at[at(cylinder)];
    const std::size_t last = zero < 0 ? bands.size() - 1 : at(zero);
    std::size_t rows = 0;
    for (std::size_t k = 0; k <= last; ++k) {
        if (k == 0 || bands[k] != bands[k - 1]) {
            rows += band_levels_[at(bands[k])].size() - 1;
        }
    }
    return static_cast<int>(rows);
}

double RectangleRows::bent(const CriticalSide& side, double f) const {
    const int low = network_.zero_of(side.points.front());
    const int high = network_.zero_of(side.points.back());
    return carried(f, {side.f.front(), side.f.back()},
                   {low < 0 ? side.f.front() : level(low), high < 0 ? side.f.back() : level(high)});
}

double RectangleRows::unbent(const CriticalSide& side, double level_there) const {
    const int low = network_.zero_of(side.points.front());
    const int high = network_.zero_of(side.points.back());
    return carried(level_there,
                   {low < 0 ? side.f.front() : level(low), high < 0 ? side.f.back() : level(high)},
                   {side.f.front(), side.f.back()});
}

}  // namespace leafcutter::geometry
