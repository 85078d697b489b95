#include "fab/weave/woven_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

namespace leafcutter::fab {

namespace {

using Eigen::Vector3d;

constexpr double kOverlapMm = 1e-6;

// Stop requests are looked for every so many grid cells.
constexpr std::size_t kCheckEvery = 256;

// Three points of the outer face and those of the inner one opposite to them.
struct Prism {
    std::array<Vector3d, 6> point;
    Vector3d low;
    Vector3d high;
    int strip = 0;
    int segment = 0;
    int cell = 0;
    Family family = Family::Weft;
};

Prism prism_of(const std::array<const Vector3d*, 3>& middle,
               const std::array<const Vector3d*, 3>& up,
               double half_mm) {
    Prism prism;
    for (std::size_t i = 0; i < 3; ++i) {
        prism.point[i] = *middle[i] + half_mm * *up[i];
        prism.point[i + 3] = *middle[i] - half_mm * *up[i];
    }
    prism.low = prism.high = prism.point[0];
    for (const Vector3d& p : prism.point) {
        prism.low = prism.low.cwiseMin(p);
        prism.high = prism.high.cwiseMax(p);
    }
    return prism;
}

std::vector<Prism> prisms_of(std::span<const Strip> strips, const WovenModel& model) {
    std::vector<Prism> prisms;
    for (const WovenStrip& woven : model.strips) {
        const double half = woven.thickness_mm / 2.0;
        for (std::size_t i = 0; i < woven.segments.size(); ++i) {
            const WovenSegment& segment = woven.segments[i];
            const WovenRung& one = woven.rungs[i];
            const WovenRung& two = woven.rungs[(i + 1) % woven.rungs.size()];
            const auto add = [&](const std::array<const Vector3d*, 3>& middle,
                                 const std::array<const Vector3d*, 3>& up) {
                prisms.push_back(prism_of(middle, up, half));
                prisms.back().strip = woven.strip;
                prisms.back().segment = static_cast<int>(i);
                prisms.back().cell = segment.cell;
                prisms.back().family = strips[static_cast<std::size_t>(woven.strip)].family;
            };
            if (segment.rises) {
                add({&one.left, &one.right, &two.left},
                    {&one.left_up, &one.right_up, &two.left_up});
                add({&one.right, &two.right, &two.left},
                    {&one.right_up, &two.right_up, &two.left_up});
            } else {
                add({&one.left, &one.right, &two.right},
                    {&one.left_up, &one.right_up, &two.right_up});
                add({&one.left, &two.right, &two.left},
                    {&one.left_up, &two.right_up, &two.left_up});
            }
        }
    }
    return prisms;
}

// How far two convex bodies are apart, by the directions tried so far.
class Separation {
public:
    Separation(const Prism& one, const Prism& two, double enough)
        : one_(one), two_(two), enough_(enough) {}

    // Tries a direction; true if it shows that they are as far apart as is enough to know.
    bool try_axis(const Vector3d& axis) {
        const double square = axis.squaredNorm();
        if (square < 1e-24) {
            return false;
        }
        double low[2];
        double high[2];
        const Prism* const bodies[2] = {&one_, &two_};
        for (std::size_t b = 0; b < 2; ++b) {
            low[b] = high[b] = axis.dot(bodies[b]->point[0]);
            for (std::size_t i = 1; i < 6; ++i) {
                const double value = axis.dot(bodies[b]->point[i]);
                low[b] = std::min(low[b], value);
                high[b] = std::max(high[b], value);
            }
        }
        gap_ = std::max(gap_, std::max(low[0] - high[1], low[1] - high[0]) / std::sqrt(square));
        return gap_ >= enough_;
    }
    double gap() const { return gap_; }

private:
    const Prism& one_;
    const Prism& two_;
    double enough_;
    double gap_ = -std::numeric_limits<double>::infinity();
};

using Edges = std::array<Vector3d, 12>;

// The nine edges and a diagonal of each side face, which need not be flat.
Edges edges_of(const std::array<Vector3d, 6>& p) {
    return {p[1] - p[0], p[2] - p[1], p[0] - p[2], p[4] - p[3], p[5] - p[4], p[3] - p[5],
            p[3] - p[0], p[4] - p[1], p[5] - p[2], p[4] - p[0], p[5] - p[1], p[3] - p[2]};
}

bool try_faces(const Edges& e, Separation& separation) {
    return separation.try_axis(e[0].cross(e[1])) || separation.try_axis(e[3].cross(e[4])) ||
           separation.try_axis(e[0].cross(e[6])) || separation.try_axis(e[1].cross(e[7])) ||
           separation.try_axis(e[2].cross(e[8])) || separation.try_axis(e[3].cross(e[9])) ||
           separation.try_axis(e[4].cross(e[10])) || separation.try_axis(e[5].cross(e[11]));
}

// The distance of two prisms, or anything not less than `enough` if it is that.
double distance(const Prism& one, const Prism& two, double enough) {
    Separation separation(one, two, enough);
    for (int axis = 0; axis < 3; ++axis) {
        if (separation.try_axis(Vector3d::Unit(axis))) {
            return separation.gap();
        }
    }
    const Edges a = edges_of(one.point);
    const Edges b = edges_of(two.point);
    if (try_faces(a, separation) || try_faces(b, separation)) {
        return separation.gap();
    }
    for (const Vector3d& p : a) {
        for (const Vector3d& q : b) {
            if (separation.try_axis(p.cross(q))) {
                return separation.gap();
            }
        }
    }
    return separation.gap();
}

// Prisms by the cells of a grid that their boxes touch.
class PrismGrid {
public:
    using Place = std::array<std::int64_t, 3>;
    struct Cell {
        Place place;
        std::vector<int> prisms;
    };

    PrismGrid(std::span<const Prism> prisms, double cell_mm) : cell_mm_(cell_mm) {
        for (std::size_t i = 0; i < prisms.size(); ++i) {
            visit(prisms[i], [&](const Place& place) {
                const auto [found, added] = index_.try_emplace(key_of(place), cells_.size());
                if (added) {
                    cells_.push_back({place, {}});
                }
                cells_[found->second].prisms.push_back(static_cast<int>(i));
                return true;
            });
        }
    }

    // Whether the box of `prism` and that of one in the grid touch the same cell.
    bool touches(const Prism& prism) const {
        return !visit(prism, [&](const Place& place) { return !index_.contains(key_of(place)); });
    }

    const std::vector<Cell>& cells() const { return cells_; }
    Place place(const Vector3d& point) const {
        return {static_cast<std::int64_t>(std::floor(point.x() / cell_mm_)),
                static_cast<std::int64_t>(std::floor(point.y() / cell_mm_)),
                static_cast<std::int64_t>(std::floor(point.z() / cell_mm_))};
    }

private:
    // Cells that the box touches, as long as `go_on` says so; true if it always did.
    template <typename GoOn>
    bool visit(const Prism& prism, const GoOn& go_on) const {
        const Place low = place(prism.low);
        const Place high = place(prism.high);
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                for (std::int64_t z = low[2]; z <= high[2]; ++z) {
                    if (!go_on({x, y, z})) {
                        return false;
                    }
                }
            }
        }
        return true;
    }

    // 21 bits each: as good as unique for any model that is not kilometres long.
    static std::int64_t key_of(const Place& p) {
        constexpr std::int64_t kMask = (1 << 21) - 1;
        return ((p[0] & kMask) << 42) | ((p[1] & kMask) << 21) | (p[2] & kMask);
    }

    double cell_mm_;
    std::vector<Cell> cells_;
    std::unordered_map<std::int64_t, std::size_t> index_;
};

// Strips that follow themselves: pieces of one cell and the next touch because they are one.
bool are_one_run(const Prism& one, const Prism& two, const WovenModel& model) {
    if (one.strip != two.strip) {
        return false;
    }
    const WovenStrip& woven = model.strips[static_cast<std::size_t>(one.strip)];
    const int cells = woven.segments.empty() ? 0 : woven.segments.back().cell + 1;
    const int apart = std::abs(one.cell - two.cell);
    return apart <= 2 || (woven.closed && cells - apart <= 2);
}

class Gauge {
public:
    Gauge(std::span<const Prism> prisms, const WovenModel& model)
        : prisms_(prisms), model_(model) {}

    void compare(const PrismGrid& grid, const PrismGrid::Cell& cell) {
        for (std::size_t i = 0; i < cell.prisms.size(); ++i) {
            const Prism& one = prisms_[static_cast<std::size_t>(cell.prisms[i])];
            for (std::size_t j = i + 1; j < cell.prisms.size(); ++j) {
                const Prism& two = prisms_[static_cast<std::size_t>(cell.prisms[j])];
                if (are_near(one, two) && is_first_meeting(grid, cell, one, two) &&
                    !are_one_run(one, two, model_)) {
                    compare(one, two);
                }
            }
        }
    }

    void tell(WovenModel& model) const {
        const auto told = [](double gap) {
            return std::isfinite(gap) ? std::optional<double>(gap) : std::nullopt;
        };
        model.smallest_gap_mm = told(crossing_gap_);
        model.smallest_side_gap_mm = told(side_gap_);
        model.overlaps = static_cast<int>(crossing_overlaps_.size());
        model.side_overlaps = static_cast<int>(side_overlaps_.size());
    }

    std::vector<Clash> clashes() const {
        std::vector<Clash> clashes;
        clashes.reserve(depths_.size());
        for (const auto& [place, depth] : depths_) {
            clashes.push_back({place.first, place.second, depth});
        }
        return clashes;
    }

private:
    static bool are_near(const Prism& one, const Prism& two) {
        return (one.low.array() <= two.high.array()).all() &&
               (two.low.array() <= one.high.array()).all();
    }

    // Two prisms share many grid cells; the one that holds the lowest corner of what their boxes
    // share is the one where they are compared.
    static bool is_first_meeting(const PrismGrid& grid,
                                 const PrismGrid::Cell& cell,
                                 const Prism& one,
                                 const Prism& two) {
        return grid.place(one.low.cwiseMax(two.low)) == cell.place;
    }

    void compare(const Prism& one, const Prism& two) {
        const bool crossing = one.family != two.family;
        double& smallest = crossing ? crossing_gap_ : side_gap_;
        // Overlaps are counted all, however deep.
        const double gap = distance(one, two, std::max(smallest, -kOverlapMm));
        smallest = std::min(smallest, gap);
        if (gap < -kOverlapMm) {
            const Prism& counted = one.family == Family::Weft ? one : two;
            (crossing ? crossing_overlaps_ : side_overlaps_).insert({counted.strip, counted.cell});
            for (const Prism* prism : {&one, &two}) {
                double& depth = depths_[{prism->strip, prism->cell}];
                depth = std::max(depth, -gap);
            }
        }
    }

    std::span<const Prism> prisms_;
    const WovenModel& model_;
    double crossing_gap_ = std::numeric_limits<double>::infinity();
    double side_gap_ = std::numeric_limits<double>::infinity();
    std::set<std::pair<int, int>> crossing_overlaps_;
    std::set<std::pair<int, int>> side_overlaps_;
    std::map<std::pair<int, int>, double> depths_;  // Per strip and cell.
};

double mean_size(std::span<const Prism> prisms) {
    double sum = 0.0;
    for (const Prism& prism : prisms) {
        sum += (prism.high - prism.low).maxCoeff();
    }
    return prisms.empty() ? 0.0 : sum / static_cast<double>(prisms.size());
}

// Neighbours that don't touch are to be found too: boxes reach out as far as strips are thick.
std::vector<Prism> reaching_prisms(std::span<const Strip> strips, const WovenModel& model) {
    std::vector<Prism> prisms = prisms_of(strips, model);
    double reach = 0.0;
    for (const WovenStrip& strip : model.strips) {
        reach = std::max(reach, strip.thickness_mm);
    }
    for (Prism& prism : prisms) {
        prism.low.array() -= reach;
        prism.high.array() += reach;
    }
    return prisms;
}

void compare_all(std::span<const Prism> prisms, Gauge& gauge, const geometry::Context& context) {
    const double size = mean_size(prisms);
    if (size <= 0.0) {
        return;
    }
    const PrismGrid grid(prisms, size);
    for (std::size_t i = 0; i < grid.cells().size(); ++i) {
        if (i % kCheckEvery == 0) {
            context.check();
        }
        gauge.compare(grid, grid.cells()[i]);
    }
}

// The boxes of those prisms that belong to changed cells or to the cells beside them.
class ChangedBoxes {
public:
    ChangedBoxes(std::span<const Prism> prisms, std::span<const Clash> changed) {
        std::set<std::pair<int, int>> places;
        for (const Clash& clash : changed) {
            for (int cell = clash.cell - 1; cell <= clash.cell + 1; ++cell) {
                places.insert({clash.strip, cell});
            }
        }
        for (const Prism& prism : prisms) {
            if (places.contains({prism.strip, prism.cell})) {
                boxes_.push_back(prism);
            }
        }
        const double size = mean_size(boxes_);
        if (size > 0.0) {
            grid_.emplace(boxes_, size);
        }
    }

    bool meet(const Prism& prism) const { return grid_ && grid_->touches(prism); }

private:
    std::vector<Prism> boxes_;
    std::optional<PrismGrid> grid_;
};

}  // namespace

std::vector<Clash> measure_gaps(std::span<const Strip> strips,
                                WovenModel& model,
                                const geometry::Context& context) {
    const std::vector<Prism> prisms = reaching_prisms(strips, model);
    Gauge gauge(prisms, model);
    compare_all(prisms, gauge, context);
    gauge.tell(model);
    return gauge.clashes();
}

std::vector<Clash> clashes_near(std::span<const Strip> strips,
                                const WovenModel& model,
                                std::span<const Clash> changed,
                                const geometry::Context& context) {
    std::vector<Prism> prisms = reaching_prisms(strips, model);
    const ChangedBoxes boxes(prisms, changed);
    prisms.erase(std::remove_if(prisms.begin(), prisms.end(),
                                [&](const Prism& prism) { return !boxes.meet(prism); }),
                 prisms.end());
    Gauge gauge(prisms, model);
    compare_all(prisms, gauge, context);
    return gauge.clashes();
}

}  // namespace leafcutter::fab
