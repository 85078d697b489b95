#include "fab/weave/openings.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

#include "fab/weave/assembly_regions.h"
#include "fab/weave/lay_order.h"

namespace leafcutter::fab {

namespace {

// Longer strips wind round many times: one opening more or less makes no difference there.
constexpr std::size_t kMostCells = 2000;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

using Costs = std::vector<std::vector<double>>;

// When the crossings of the base strips are made.
std::vector<std::vector<int>> times_of(const LayOrder& order, const Crossings& crossings) {
    std::vector<std::vector<int>> times(crossings.size());
    int now = 0;
    for (const WovenIn& woven : order.woven) {
        for (const int cell : woven.cells) {
            const Crossing& crossing = crossings[at(woven.strip)][at(cell)];
            times[at(crossing.strip)].resize(crossings[at(crossing.strip)].size());
            times[at(crossing.strip)][at(crossing.cell)] = now++;
        }
    }
    return times;
}

// Crossings under the strip, opened before a cell, that come between earlier ones that hold it
// down.
int threaded(const std::vector<Crossing>& crossings, const std::vector<int>& times, int opened) {
    const int count = static_cast<int>(times.size());
    std::vector<char> sides(times.size(), 0);
    for (const int way : {1, -1}) {
        int earliest = std::numeric_limits<int>::max();
        for (int i = 0; i < count; ++i) {
            const auto cell = at((opened + (way > 0 ? i : count - 1 - i)) % count);
            if (!crossings[cell].on_top) {
                earliest = std::min(earliest, times[cell]);
            } else if (earliest < times[cell]) {
                ++sides[cell];
            }
        }
    }
    return static_cast<int>(std::count(sides.begin(), sides.end(), 2));
}

struct BaseCosts {
    Costs costs;
    double least = 0.0;  // Of all its strips, each opened where it costs least.
};

// With one family as the base, woven as if its strips could be opened anywhere.
BaseCosts base_costs(std::span<const Strip> strips,
                     const Crossings& crossings,
                     std::span<const int> members,
                     Family base) {
    std::vector<std::vector<int>> joints(strips.size());
    for (const int strip : members) {
        if (strips[at(strip)].closed) {
            const bool anywhere = strips[at(strip)].family == base;
            joints[at(strip)].resize(anywhere ? strips[at(strip)].quads.size() : 1);
            std::iota(joints[at(strip)].begin(), joints[at(strip)].end(), 0);
        }
    }
    const LayOrder order = find_lay_order({strips, crossings, joints}, members, base);
    const auto times = times_of(order, crossings);
    BaseCosts result;
    result.costs.resize(strips.size());
    for (const int strip : members) {
        const std::size_t count = strips[at(strip)].quads.size();
        if (strips[at(strip)].family != base || !strips[at(strip)].closed || count > kMostCells) {
            continue;
        }
        std::vector<double>& costs = result.costs[at(strip)];
        for (std::size_t cell = 0; cell < count; ++cell) {
            costs.push_back(
                threaded(crossings[at(strip)], times[at(strip)], static_cast<int>(cell)));
        }
        result.least += *std::min_element(costs.begin(), costs.end());
    }
    return result;
}

}  // namespace

std::vector<std::vector<double>> opening_costs(const geometry::QuadMesh& mesh,
                                               std::span<const Strip> strips,
                                               const Crossings& crossings) {
    const std::vector<std::vector<int>> members =
        members_of(assembly_regions(mesh, strips, {}), mesh, strips);
    Costs all(strips.size());
    for (const std::vector<int>& region : members) {
        const auto is_closed = [&](Family family) {
            return std::any_of(region.begin(), region.end(), [&](int strip) {
                return strips[at(strip)].closed && strips[at(strip)].family == family;
            });
        };
        if (!is_closed(Family::Weft) || !is_closed(Family::Warp)) {
            continue;  // What is open lies first, and needs no threading.
        }
        BaseCosts best = base_costs(strips, crossings, region, Family::Warp);
        if (best.least > 0.0) {
            BaseCosts weft = base_costs(strips, crossings, region, Family::Weft);
            if (weft.least < best.least) {
                best = std::move(weft);
            }
        }
        for (const int strip : region) {
            all[at(strip)] = std::move(best.costs[at(strip)]);
        }
    }
    return all;
}

}  // namespace leafcutter::fab
