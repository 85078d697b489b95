#include "fab/strips/junctions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/critical_sides.h"

namespace leafcutter::fab {

namespace {

using geometry::ArcNetwork;
using geometry::ArcUse;
using geometry::CylinderEnd;

// Where in a column it is asked what it lies on: near its sides and in the middle.
constexpr std::array<double, 3> kAcross = {0.1, 0.5, 0.9};

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A run of a ring's end along an arc.
struct ArcSide {
    int cylinder = 0;
    int end = 0;
    int use = 0;

    bool operator<(const ArcSide& other) const {
        return std::tuple(1 - end, cylinder, use) <
               std::tuple(1 - other.end, other.cylinder, other.use);
    }
};

// A place on such a run, counted in its vertices.
struct ArcPlace {
    ArcSide side;
    double index = 0.0;
};

class Rims {
public:
    Rims(const geometry::QuadMesh& mesh, const geometry::Foliation& foliation)
        : mesh_(mesh), network_(geometry::find_arcs(foliation)), sides_(network_.arcs.size()) {
        for (const int cylinder : network_.cylinders) {
            for (int end = 0; end < 2; ++end) {
                const std::vector<ArcUse>& uses = end_of(cylinder, end).uses;
                for (std::size_t use = 0; use < uses.size(); ++use) {
                    sides_[at(uses[use].arc)].push_back({cylinder, end, static_cast<int>(use)});
                }
            }
        }
    }

    bool is_glued(int cylinder, int end) const {
        return std::binary_search(network_.cylinders.begin(), network_.cylinders.end(), cylinder) &&
               !network_.is_open(cylinder, end);
    }

    // The side of the arc where a column ends, at a part of its width.
    ArcPlace place(const geometry::QuadAddress& cell, int end, double across) const {
        const std::vector<double>& levels = mesh_.grids[at(cell.cylinder)].g_levels;
        const double low = levels[at(cell.col)];
        const CylinderEnd& rim = end_of(cell.cylinder, end);
        const double period = rim.g.back() - rim.g.front();
        double g = low + across * (levels[at(cell.col) + 1] - low) - rim.g.front();
        g = rim.g.front() + g - period * std::floor(g / period);
        const auto above = std::upper_bound(rim.g.begin() + 1, rim.g.end() - 1, g);
        const auto k = static_cast<std::size_t>(above - rim.g.begin()) - 1;
        const double step = rim.g[k + 1] - rim.g[k];
        const double index = static_cast<double>(k) + (step > 0.0 ? (g - rim.g[k]) / step : 0.0);
        std::size_t use = 0;
        while (use + 1 < rim.uses.size() && rim.uses[use + 1].first <= k) {
            ++use;
        }
        return {{cell.cylinder, end, static_cast<int>(use)},
                index - static_cast<double>(rim.uses[use].first)};
    }

    // The same place as seen from the other side.
    std::optional<ArcPlace> across(const ArcPlace& place) const {
        const ArcUse& use = use_of(place.side);
        for (const ArcSide& side : sides_[at(use.arc)]) {
            if (side < place.side || place.side < side) {
                const bool same_way = use_of(side).forward == use.forward;
                return ArcPlace{side, same_way ? place.index : count_of(place.side) - place.index};
            }
        }
        return std::nullopt;
    }

    int column_at(const ArcPlace& place) const {
        const CylinderEnd& rim = end_of(place.side.cylinder, place.side.end);
        const double index =
            std::max(0.0, place.index) + static_cast<double>(use_of(place.side).first);
        const std::size_t k = std::min(static_cast<std::size_t>(index), rim.g.size() - 2);
        const double g = rim.g[k] + (index - static_cast<double>(k)) * (rim.g[k + 1] - rim.g[k]);
        const std::vector<double>& levels = mesh_.grids[at(place.side.cylinder)].g_levels;
        const double period = levels.back() - levels.front();
        double from = g - levels.front();
        from -= period * std::floor(from / period);
        const auto above =
            std::upper_bound(levels.begin() + 1, levels.end() - 1, levels.front() + from);
        return static_cast<int>(above - levels.begin()) - 1;
    }

private:
    const CylinderEnd& end_of(int cylinder, int end) const {
        return network_.ends[at(cylinder)][at(end)];
    }
    const ArcUse& use_of(const ArcSide& side) const {
        return end_of(side.cylinder, side.end).uses[at(side.use)];
    }

    // Edges of a run.
    double count_of(const ArcSide& side) const {
        const CylinderEnd& end = end_of(side.cylinder, side.end);
        const std::size_t next = at(side.use) + 1;
        const std::size_t behind =
            next < end.uses.size() ? end.uses[next].first : end.vertices.size();
        return static_cast<double>(behind - end.uses[at(side.use)].first);
    }

    const geometry::QuadMesh& mesh_;
    ArcNetwork network_;
    std::vector<std::vector<ArcSide>> sides_;  // Of each arc.
};

class Gluer {
public:
    Gluer(const geometry::QuadMesh& mesh,
          const geometry::Foliation& foliation,
          std::span<Strip> strips)
        : mesh_(mesh), rims_(mesh, foliation), strips_(strips) {
        for (const Strip& strip : strips) {
            if (strip.family == Family::Warp && !strip.closed) {
                const geometry::QuadAddress& cell = address(strip.quads.front());
                columns_.emplace(std::pair(cell.cylinder, cell.col), &strip);
            }
        }
    }

    void glue() {
        for (Strip& strip : strips_) {
            if (strip.family != Family::Warp || strip.closed) {
                continue;
            }
            if (!strip.follows) {
                strip.glued_start = glued(address(strip.quads.front()), 0);
            }
            if (strip.next.empty()) {
                strip.glued_end = glued(address(strip.quads.back()), 1);
            }
        }
    }

private:
    const geometry::QuadAddress& address(int quad) const { return mesh_.addresses[at(quad)]; }

    GluedEnd glued(const geometry::QuadAddress& cell, int end) const {
        GluedEnd result;
        if (!rims_.is_glued(cell.cylinder, end)) {
            return result;
        }
        const ArcPlace middle = rims_.place(cell, end, 0.5);
        const std::optional<ArcPlace> beyond = rims_.across(middle);
        result.has_tab = beyond && middle.side < beyond->side;
        if (!result.has_tab) {
            return result;
        }
        const Strip* only = nullptr;
        for (const double part : kAcross) {
            const auto place = rims_.across(rims_.place(cell, end, part));
            const Strip* under = place ? strip_at(*place) : nullptr;
            if (under == nullptr || (only != nullptr && under != only)) {
                return result;
            }
            only = under;
        }
        result.onto = only->id;
        result.onto_start = beyond->side.end == 0;
        return result;
    }

    const Strip* strip_at(const ArcPlace& place) const {
        const auto found = columns_.find({place.side.cylinder, rims_.column_at(place)});
        return found == columns_.end() ? nullptr : found->second;
    }

    const geometry::QuadMesh& mesh_;
    Rims rims_;
    std::span<Strip> strips_;
    std::map<std::pair<int, int>, const Strip*> columns_;  // By cylinder and column.
};

// Rows of rectangles end on flanks: those where g grows have the tabs.
void glue_rows(const geometry::QuadMesh& mesh,
               const geometry::Foliation& foliation,
               std::span<Strip> strips) {
    const geometry::SideNetwork network = geometry::find_sides(foliation);
    for (Strip& strip : strips) {
        if (strip.family != Family::Weft || strip.closed) {
            continue;
        }
        const geometry::QuadAddress& cell = mesh.addresses[at(strip.quads.back())];
        const auto& known = network.cylinders;
        if (std::find(known.begin(), known.end(), cell.cylinder) == known.end()) {
            continue;
        }
        const std::vector<double>& levels = mesh.grids[at(cell.cylinder)].f_levels;
        const double f = (levels[at(cell.row)] + levels[at(cell.row) + 1]) / 2.0;
        const geometry::Flank& flank =
            network.flanks[at(cell.cylinder)][geometry::SideNetwork::Right];
        // A chart's own f, as its vertices have it, grows along the flank; so does the sides'.
        const double low = flank.f.front() - levels.front();
        const auto above = std::upper_bound(flank.f.begin() + 1, flank.f.end() - 1, low + f);
        const auto k = static_cast<std::size_t>(above - flank.f.begin()) - 1;
        std::size_t use = 0;
        while (use + 1 < flank.uses.size() && flank.uses[use + 1].first <= k) {
            ++use;
        }
        strip.glued_end.has_tab =
            !flank.uses.empty() && network.sides[at(flank.uses[use].side)].right >= 0;
    }
}

}  // namespace

void glue_ends(const geometry::QuadMesh& mesh,
               const geometry::Foliation& foliation,
               std::span<Strip> strips) {
    const auto borders = [&](geometry::ChartShape shape) {
        return std::any_of(foliation.cylinders.begin(), foliation.cylinders.end(),
                           [&](const geometry::Cylinder& cylinder) {
                               return cylinder.shape == shape && !cylinder.critical_point.empty();
                           });
    };
    if (borders(geometry::ChartShape::Annulus)) {
        Gluer(mesh, foliation, strips).glue();
    }
    if (borders(geometry::ChartShape::Rectangle)) {
        glue_rows(mesh, foliation, strips);
    }
}

}  // namespace leafcutter::fab
