#include "geometry/pants/sweep_mesh.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// When the sweep meets a vertex, before its value is asked for.
enum class Stage { LowApex, LowLoop, LowChord, Surface, HighChord, HighLoop, HighApex };

struct Place {
    Stage stage = Stage::Surface;
    double value = 0.0;
    int vertex = 0;  // Tells equal values apart; parts of a saddle share it,
    int part = 0;    // and are told apart by this.

    friend bool operator<(const Place& a, const Place& b) {
        return std::tie(a.stage, a.value, a.vertex, a.part) <
               std::tie(b.stage, b.value, b.vertex, b.part);
    }
};

class Builder {
public:
    Builder(std::span<const std::array<int, 3>> triangles, std::span<const double> values)
        : incident_(values.size()) {
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        low_ = *low;
        high_ = *high;
        for (std::size_t v = 0; v < values.size(); ++v) {
            places_.push_back({Stage::Surface, values[v], static_cast<int>(v), 0});
            owner_.push_back(static_cast<int>(v));
        }
        for (const auto& t : triangles) {
            add_triangle(t);
        }
    }

    void cap(const std::vector<int>& loop, bool is_low) {
        const int apex =
            add_vertex({is_low ? Stage::LowApex : Stage::HighApex, end_value(is_low), 0, 0}, -1);
        for (std::size_t i = 0; i < loop.size(); ++i) {
            Place& place = places_[at(loop[i])];
            place.stage = is_low ? Stage::LowLoop : Stage::HighLoop;
            place.value = end_value(is_low);
            add_triangle({loop[(i + 1) % loop.size()], loop[i], apex});
        }
    }

    // Splits interior edges that join two loop vertices of one stage.
    void split_chords() {
        std::size_t next = 0;
        while (next < triangles_.size()) {  // Grows as edges are split.
            const std::array<int, 3> corners = triangles_[next++];
            for (std::size_t k = 0; k < 3; ++k) {
                const int a = corners[k];
                const int b = corners[(k + 1) % 3];
                const Stage stage = places_[at(a)].stage;
                const bool on_loops = stage == Stage::LowLoop || stage == Stage::HighLoop;
                if (a < b && on_loops && places_[at(b)].stage == stage && !is_capped(a, b)) {
                    split_edge(a, b);
                }
            }
        }
    }

    // Takes the run of the ring that a limb starts in off its saddle, if there are other runs of
    // its kind.
    void take_off(const LimbAtSaddle& limb, int number) {
        const std::vector<int> ring = ring_of(limb.saddle);
        const auto towards = std::find_if(ring.begin(), ring.end(), [&](int n) {
            return owner_[at(n)] == limb.neighbour && n != limb.saddle;
        });
        if (towards == ring.end() || starts_of_upper_runs(limb.saddle, ring).size() < 2) {
            return;
        }
        const bool up = above(*towards, limb.saddle);
        const std::size_t count = ring.size();
        auto begin = static_cast<std::size_t>(towards - ring.begin());
        std::size_t end = begin;
        while (above(ring[begin], limb.saddle) == up) {
            begin = (begin + count - 1) % count;
        }
        while (above(ring[end], limb.saddle) == up) {
            end = (end + 1) % count;
        }
        const int part = up ? -1 - number : std::numeric_limits<int>::max() - number;
        pull_off(limb.saddle, ring, {begin, end}, part);
        keep_limbs_of_newest();
    }

    void part_saddles(int turn) {
        const int count = static_cast<int>(places_.size());
        for (int v = 0; v < count; ++v) {
            if (owner_[at(v)] < 0) {
                continue;
            }
            for (int part = std::numeric_limits<int>::max() / 2;; --part) {
                const std::vector<int> ring = ring_of(v);
                const std::vector<std::size_t> ups = starts_of_upper_runs(v, ring);
                if (ups.size() < 3) {
                    break;
                }
                const std::size_t end = ups[at(turn) % ups.size()];
                std::size_t begin = (end + ring.size() - 1) % ring.size();
                while (!above(ring[begin], v)) {
                    begin = (begin + ring.size() - 1) % ring.size();
                }
                pull_off(v, ring, {begin, end}, part);
            }
        }
    }

    SweepMesh finish(int surface_vertices) {
        SweepMesh mesh;
        const int count = static_cast<int>(places_.size());
        mesh.half_edges = build_half_edges(triangles_, count);
        mesh.rings = build_vertex_rings(mesh.half_edges, count);
        mesh.triangles = std::move(triangles_);
        mesh.surface_vertices = surface_vertices;
        mesh.owner = std::move(owner_);
        mesh.keeps_limbs = std::move(keeps_limbs_);
        mesh.keeps_limbs.resize(places_.size(), 0);
        mesh.order.resize(places_.size());
        mesh.rank.resize(places_.size());
        std::iota(mesh.order.begin(), mesh.order.end(), 0);
        std::sort(mesh.order.begin(), mesh.order.end(),
                  [&](int a, int b) { return places_[at(a)] < places_[at(b)]; });
        for (std::size_t i = 0; i < mesh.order.size(); ++i) {
            mesh.rank[at(mesh.order[i])] = static_cast<int>(i);
            mesh.value.push_back(places_[i].value);
        }
        return mesh;
    }

private:
    double end_value(bool is_low) const { return is_low ? low_ : high_; }

    int add_vertex(Place place, int owner) {
        const int v = static_cast<int>(places_.size());
        if (place.part == 0) {
            place.vertex = v;
        }
        places_.push_back(place);
        owner_.push_back(owner);
        incident_.emplace_back();
        return v;
    }

    void keep_limbs_of_newest() {
        keeps_limbs_.resize(places_.size(), 0);
        keeps_limbs_.back() = 1;
    }

    void add_triangle(const std::array<int, 3>& corners) {
        for (const int v : corners) {
            incident_[at(v)].push_back(static_cast<int>(triangles_.size()));
        }
        triangles_.push_back(corners);
    }

    void replace_corner(int triangle, int old, int fresh) {
        auto& corners = triangles_[at(triangle)];
        *std::find(corners.begin(), corners.end(), old) = fresh;
        std::erase(incident_[at(old)], triangle);
        incident_[at(fresh)].push_back(triangle);
    }

    std::vector<int> triangles_at(int a, int b) const {
        std::vector<int> both;
        for (const int t : incident_[at(a)]) {
            const auto& corners = triangles_[at(t)];
            if (std::find(corners.begin(), corners.end(), b) != corners.end()) {
                both.push_back(t);
            }
        }
        return both;
    }

    // Whether a cap lies on the edge, that is, it is one of a loop's own.
    bool is_capped(int a, int b) const {
        for (const int t : triangles_at(a, b)) {
            for (const int v : triangles_[at(t)]) {
                const Stage stage = places_[at(v)].stage;
                if (stage == Stage::LowApex || stage == Stage::HighApex) {
                    return true;
                }
            }
        }
        return false;
    }

    void split_edge(int a, int b) {
        Place place = places_[at(a)];
        place.stage = place.stage == Stage::LowLoop ? Stage::LowChord : Stage::HighChord;
        const int middle = add_vertex(place, a);
        keep_limbs_of_newest();
        for (const int t : triangles_at(a, b)) {
            std::array<int, 3> other = triangles_[at(t)];
            *std::find(other.begin(), other.end(), a) = middle;
            replace_corner(t, b, middle);
            add_triangle(other);
        }
    }

    // Neighbours, counter-clockwise.
    std::vector<int> ring_of(int v) const {
        std::vector<std::pair<int, int>> steps;
        for (const int t : incident_[at(v)]) {
            const auto& c = triangles_[at(t)];
            const auto k = static_cast<std::size_t>(std::find(c.begin(), c.end(), v) - c.begin());
            steps.emplace_back(c[(k + 1) % 3], c[(k + 2) % 3]);
        }
        std::vector<int> ring{steps.front().first};
        while (ring.size() < steps.size()) {
            const auto step = std::find_if(steps.begin(), steps.end(),
                                           [&](const auto& s) { return s.first == ring.back(); });
            ring.push_back(step->second);
        }
        return ring;
    }

    bool above(int a, int b) const { return places_[at(b)] < places_[at(a)]; }

    std::vector<std::size_t> starts_of_upper_runs(int v, const std::vector<int>& ring) const {
        std::vector<std::size_t> starts;
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const int before = ring[(k + ring.size() - 1) % ring.size()];
            if (above(ring[k], v) && !above(before, v)) {
                starts.push_back(k);
            }
        }
        return starts;
    }

    struct Slots {
        std::size_t begin = 0;
        std::size_t end = 0;
    };

    // A new vertex next to v takes over the run of slots between two, and is joined to these two
    // and to v: a simple saddle if v is on the run's side of it.
    void pull_off(int v, const std::vector<int>& ring, Slots slots, int part) {
        const std::size_t count = ring.size();
        const auto [begin, end] = slots;
        const Place base = places_[at(v)];
        const int fresh = add_vertex({base.stage, base.value, base.vertex, part}, owner_[at(v)]);
        for (std::size_t k = begin; k != end; k = (k + 1) % count) {
            for (const int t : triangles_at(v, ring[k])) {
                const auto& c = triangles_[at(t)];
                if (std::find(c.begin(), c.end(), ring[(k + 1) % count]) != c.end()) {
                    replace_corner(t, v, fresh);
                    break;
                }
            }
        }
        add_triangle({v, ring[begin], fresh});
        add_triangle({v, fresh, ring[end]});
    }

    std::vector<std::array<int, 3>> triangles_;
    std::vector<std::vector<int>> incident_;  // Per vertex: its triangles.
    std::vector<Place> places_;
    std::vector<int> owner_;
    std::vector<char> keeps_limbs_;  // As far as there are any.
    double low_ = 0.0;
    double high_ = 0.0;
};

}  // namespace

SweepMesh make_sweep_mesh(std::span<const std::array<int, 3>> triangles,
                          std::span<const double> values,
                          std::span<const std::vector<int>> boundary_loops,
                          std::span<const char> loop_is_low,
                          const SaddleParting& parting) {
    Builder builder(triangles, values);
    for (std::size_t k = 0; k < boundary_loops.size(); ++k) {
        builder.cap(boundary_loops[k], loop_is_low[k] != 0);
    }
    builder.split_chords();
    for (std::size_t k = 0; k < parting.limbs.size(); ++k) {
        builder.take_off(parting.limbs[k], static_cast<int>(k));
    }
    builder.part_saddles(parting.turn);
    return builder.finish(static_cast<int>(values.size()));
}

}  // namespace leafcutter::geometry
