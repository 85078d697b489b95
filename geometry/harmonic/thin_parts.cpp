#include "geometry/harmonic/thin_parts.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "geometry/harmonic/form_parts.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The flanks of a part, from source to sink: places in its loop.
struct Flank {
    std::vector<int> vertices;  // Vertices of the part.
    std::vector<int> edges;     // Half-edges of the cut surface between them.
};

Flank flank_of(const FormPart& part, int begin, int end) {
    Flank flank;
    const int count = static_cast<int>(part.loop.size());
    int i = begin;
    for (; i != end; i = (i + 1) % count) {
        flank.vertices.push_back(part.loop[at(i)]);
        flank.edges.push_back(part.loop_edge[at(i)]);
    }
    flank.vertices.push_back(part.loop[at(i)]);
    return flank;
}

std::array<Flank, 2> flanks_of(const FormPart& part) {
    Flank left = flank_of(part, part.corners[3], part.corners[0]);
    std::reverse(left.vertices.begin(), left.vertices.end());
    std::reverse(left.edges.begin(), left.edges.end());
    return {std::move(left), flank_of(part, part.corners[1], part.corners[2])};
}

// A zero on a flank.
struct Stop {
    std::size_t flank = 0;
    std::size_t place = 0;  // In flank.vertices.
};

// The zeros of both flanks, as they follow each other from source to sink.
std::vector<Stop> stops_between(const CutSurface& cut,
                                const FormPart& part,
                                const std::array<Flank, 2>& flanks) {
    std::vector<char> is_zero(cut.f.size(), 0);
    for (const FormZero& zero : cut.zeros) {
        is_zero[at(zero.vertex)] = 1;
    }
    const auto source = [&](const Stop& stop) {
        return at(part.source_vertex[at(flanks[stop.flank].vertices[stop.place])]);
    };
    std::array<std::vector<Stop>, 2> each;
    for (std::size_t side = 0; side < 2; ++side) {
        for (std::size_t i = 0; i < flanks[side].vertices.size(); ++i) {
            if (is_zero[source({side, i})] != 0) {
                each[side].push_back({side, i});
            }
        }
    }
    std::vector<Stop> stops;
    std::merge(each[0].begin(), each[0].end(), each[1].begin(), each[1].end(),
               std::back_inserter(stops),
               [&](const Stop& a, const Stop& b) { return cut.f[source(a)] < cut.f[source(b)]; });
    return stops;
}

// Finds short paths through one part.
class Crossing {
public:
    explicit Crossing(const FormPart& part)
        : part_(part),
          edges_(
              build_half_edges(part.mesh.triangles, static_cast<int>(part.mesh.positions.size()))),
          around_(part.mesh.positions.size()),
          closed_(part.mesh.positions.size(), 0) {
        for (int h = 0; h < edges_.size(); ++h) {
            around_[at(edges_.from_of(h))].push_back(h);
            if (edges_.twin_of(h) < 0) {
                around_[at(edges_.to_of(h))].push_back(h);
            }
        }
        for (const int v : part.loop) {
            closed_[at(v)] = 1;
        }
    }

    void open(int vertex) { closed_[at(vertex)] = 0; }
    void close(int vertex) { closed_[at(vertex)] = 1; }

    // Half-edges of the cut surface along the shortest path through open vertices, whose vertices
    // are closed then; nothing if there is none.
    std::optional<std::vector<int>> path(int from, int to) {
        std::vector<double> length(around_.size(), std::numeric_limits<double>::infinity());
        std::vector<int> entry(around_.size(), -1);
        using Entry = std::pair<double, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        length[at(from)] = 0.0;
        queue.emplace(0.0, from);
        while (!queue.empty()) {
            const auto [d, v] = queue.top();
            queue.pop();
            if (d > length[at(v)]) {
                continue;
            }
            if (v == to) {
                return trace(from, to, entry);
            }
            for (const int h : around_[at(v)]) {
                const int w = other_end(h, v);
                const double through = d + edge_length(h);
                if ((closed_[at(w)] == 0 || w == to) && through < length[at(w)]) {
                    length[at(w)] = through;
                    entry[at(w)] = h;
                    queue.emplace(through, w);
                }
            }
        }
        return std::nullopt;
    }

private:
    int other_end(int h, int v) const {
        return edges_.from_of(h) == v ? edges_.to_of(h) : edges_.from_of(h);
    }
    double edge_length(int h) const {
        return (part_.mesh.positions[at(edges_.to_of(h))] -
                part_.mesh.positions[at(edges_.from_of(h))])
            .norm();
    }
    std::vector<int> trace(int from, int to, const std::vector<int>& entry) {
        std::vector<int> path;
        for (int v = to; v != from; v = other_end(entry[at(v)], v)) {
            const int h = entry[at(v)];
            path.push_back(3 * part_.source_triangle[at(h / 3)] + h % 3);
            close(v);
        }
        return path;
    }

    const FormPart& part_;
    HalfEdges edges_;
    std::vector<std::vector<int>> around_;  // Half-edges at each vertex, one for each edge.
    std::vector<char> closed_;
};

// Opens the vertices of a flank between two places, both excluded.
void open_between(Crossing& crossing, const Flank& flank, std::size_t below, std::size_t above) {
    for (std::size_t i = below + 1; i < above; ++i) {
        crossing.open(flank.vertices[i]);
    }
}

// The edges that take the place of both flanks; nothing if there is no room.
std::optional<std::vector<int>> joined_line(const FormPart& part,
                                            const std::array<Flank, 2>& flanks,
                                            const std::vector<Stop>& stops) {
    std::vector<int> line;
    const auto keep = [&](std::size_t side, std::size_t begin, std::size_t end) {
        line.insert(line.end(), flanks[side].edges.begin() + static_cast<std::ptrdiff_t>(begin),
                    flanks[side].edges.begin() + static_cast<std::ptrdiff_t>(end));
    };
    Crossing crossing(part);
    keep(stops.front().flank, 0, stops.front().place);
    std::array<std::size_t, 2> last{0, 0};  // Place of the last stop on each flank.
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
        const Stop& here = stops[i];
        const Stop& next = stops[i + 1];
        last[here.flank] = here.place;
        if (here.flank == next.flank) {
            keep(here.flank, here.place, next.place);
            continue;
        }
        const auto after =
            std::find_if(stops.begin() + static_cast<std::ptrdiff_t>(i) + 1, stops.end(),
                         [&](const Stop& stop) { return stop.flank == here.flank; });
        open_between(crossing, flanks[here.flank], here.place,
                     after == stops.end() ? flanks[here.flank].vertices.size() - 1 : after->place);
        open_between(crossing, flanks[next.flank], last[next.flank], next.place);
        const auto path = crossing.path(flanks[here.flank].vertices[here.place],
                                        flanks[next.flank].vertices[next.place]);
        if (!path) {
            return std::nullopt;
        }
        line.insert(line.end(), path->begin(), path->end());
        for (const Flank& flank : flanks) {
            for (const int v : flank.vertices) {
                crossing.close(v);
            }
        }
    }
    keep(stops.back().flank, stops.back().place, flanks[stops.back().flank].edges.size());
    return line;
}

void set_cut(CutSurface& cut, int h, char value) {
    cut.cut[at(h)] = value;
    cut.cut[at(cut.surface.edges.twin_of(h))] = value;
}

// Whether every edge of the flanks has another part beyond it.
bool has_neighbours(const CutSurface& cut,
                    const FormPart& part,
                    const std::array<Flank, 2>& flanks) {
    std::vector<char> inside(cut.surface.mesh.triangles.size(), 0);
    for (const int t : part.source_triangle) {
        inside[at(t)] = 1;
    }
    return std::all_of(flanks.begin(), flanks.end(), [&](const Flank& flank) {
        return std::all_of(flank.edges.begin(), flank.edges.end(), [&](int h) {
            const int twin = cut.surface.edges.twin_of(h);
            return twin >= 0 && inside[at(twin / 3)] == 0;
        });
    });
}

bool join_to_neighbours(CutSurface& cut, const FormPart& part) {
    const std::array<Flank, 2> flanks = flanks_of(part);
    if (!has_neighbours(cut, part, flanks)) {
        return false;
    }
    const std::vector<Stop> stops = stops_between(cut, part, flanks);
    if (stops.empty()) {
        return false;
    }
    const auto line = joined_line(part, flanks, stops);
    if (!line) {
        return false;
    }
    for (const Flank& flank : flanks) {
        for (const int h : flank.edges) {
            set_cut(cut, h, 0);
        }
    }
    for (const int h : *line) {
        set_cut(cut, h, 1);
    }
    return true;
}

}  // namespace

int join_thin_parts(CutSurface& cut, double share, const Context& context) {
    int joined = 0;
    const double area = surface_area(cut.surface.mesh);
    for (;;) {
        context.check();
        std::vector<FormPart> parts = separate_parts(cut);
        std::stable_sort(parts.begin(), parts.end(),
                         [](const FormPart& a, const FormPart& b) { return a.flux < b.flux; });
        const double flux =
            std::accumulate(parts.begin(), parts.end(), 0.0,
                            [](double sum, const FormPart& part) { return sum + part.flux; });
        const bool any = std::any_of(parts.begin(), parts.end(), [&](const FormPart& part) {
            return part.flux < share * flux && surface_area(part.mesh) < share * area &&
                   join_to_neighbours(cut, part);
        });
        if (!any || parts.size() == 1) {
            return joined;
        }
        ++joined;
    }
}

}  // namespace leafcutter::geometry
