#include "geometry/components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/cell_spread.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

bool holds(const SurfacePart& part, int vertex) {
    return std::find(part.source_vertex.begin(), part.source_vertex.end(), vertex) !=
               part.source_vertex.end() ||
           std::any_of(part.punctures.begin(), part.punctures.end(),
                       [&](const Puncture& p) { return p.vertex == vertex; });
}

template <typename Container>
bool holds_any(const SurfacePart& part, const Container& vertices) {
    return std::any_of(std::begin(vertices), std::end(vertices),
                       [&](int v) { return holds(part, v); });
}

// All of `vertices` are on one part.
template <typename Container>
void check_together(const std::vector<SurfacePart>& parts,
                    const Container& vertices,
                    const std::string& name) {
    for (const SurfacePart& part : parts) {
        if (std::all_of(std::begin(vertices), std::end(vertices),
                        [&](int v) { return holds(part, v); })) {
            return;
        }
    }
    throw Error(ErrorKind::BadOption, "bad-" + name,
                fmt::format("foliation.{}: one of the vertices does not exist or lies in a hole, "
                            "or they are not all on one part of the model",
                            name));
}

bool names_loop_of(const SurfacePart& part, const LoopName& name) {
    if (name.number) {
        return *name.number >= 0 && std::find(part.loop_numbers.begin(), part.loop_numbers.end(),
                                              *name.number) != part.loop_numbers.end();
    }
    const auto is_named = [&](int v) {
        return part.source_vertex[static_cast<std::size_t>(v)] == name.vertex;
    };
    return std::any_of(part.loops.begin(), part.loops.end(),
                       [&](const std::vector<int>& loop) {
                           return std::any_of(loop.begin(), loop.end(), is_named);
                       }) ||
           std::any_of(part.punctures.begin(), part.punctures.end(),
                       [&](const Puncture& p) { return p.vertex == name.vertex; });
}

void check_loops(const std::vector<SurfacePart>& parts,
                 const std::vector<LoopName>& names,
                 const char* key) {
    for (std::size_t k = 0; k < names.size(); ++k) {
        const bool is_known = std::any_of(parts.begin(), parts.end(), [&](const SurfacePart& part) {
            return names_loop_of(part, names[k]);
        });
        if (!is_known) {
            throw Error(ErrorKind::BadOption, "no-such-loop",
                        fmt::format("{}[{}]: the model has no such boundary loop", key, k));
        }
    }
}

void keep_loops_of(const SurfacePart& part, std::vector<LoopName>& names) {
    names.erase(std::remove_if(names.begin(), names.end(),
                               [&](const LoopName& name) { return !names_loop_of(part, name); }),
                names.end());
}

// Scales (g, f) and all that is measured in it.
void scale(Foliation& foliation, double factor) {
    for (MetricGraph::Edge& edge : foliation.graph.edges) {
        edge.weight *= factor;
    }
    for (Cylinder& cylinder : foliation.cylinders) {
        for (auto& corners : cylinder.corner_gf) {
            for (Eigen::Vector2d& gf : corners) {
                gf *= factor;
            }
        }
        cylinder.width *= factor;
        cylinder.height *= factor;
        cylinder.shear *= factor;
        cylinder.energy *= factor * factor;
    }
    foliation.energy *= factor * factor;
}

// Makes the charts as large as the surface.
void scale_to_surface(Foliation& foliation) {
    double surface = 0.0;
    double flat = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        surface += surface_area(cylinder.mesh);
        flat += cylinder.width * cylinder.height;
    }
    scale(foliation, std::sqrt(surface / flat));
}

template <typename T>
void append(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

void append_part(Foliation& whole, Foliation part, const std::string& name) {
    const int edges = static_cast<int>(whole.graph.edges.size());
    const int points = static_cast<int>(whole.critical_points.size());
    const int singular = static_cast<int>(whole.singularities.size());
    for (MetricGraph::Edge edge : part.graph.edges) {
        edge.from += whole.graph.nodes;
        edge.to += whole.graph.nodes;
        whole.graph.edges.push_back(edge);
    }
    whole.graph.nodes += part.graph.nodes;
    for (Cylinder& cylinder : part.cylinders) {
        cylinder.graph_edge += edges;
        for (int& point : cylinder.critical_point) {
            point += point < 0 ? 0 : points;
        }
    }
    for (Alternative& alternative : part.alternatives) {
        alternative.name.insert(0, name);
    }
    for (std::string& warning : part.warnings) {
        warning.insert(0, name);
    }
    for (ReachedPoint& point : part.reached) {
        point.singularity += point.singularity < 0 ? 0 : singular;
    }
    append(whole.cylinders, part.cylinders);
    append(whole.reached, part.reached);
    append(whole.singularities, part.singularities);
    append(whole.critical_graph, part.critical_graph);
    append(whole.critical_points, part.critical_points);
    append(whole.punctures, part.punctures);
    append(whole.alternatives, part.alternatives);
    append(whole.warnings, part.warnings);
    whole.energy += part.energy;
    whole.iterations += part.iterations;
}

}  // namespace

void check_names(const FoliationOptions& options, const std::vector<SurfacePart>& parts) {
    if (options.corners) {
        check_together(parts, *options.corners, "corners");
    }
    if (options.poles) {
        check_together(parts, *options.poles, "poles");
    }
    for (const int vertex : options.near) {
        check_together(parts, std::array{vertex}, "singularities");
    }
    for (const std::vector<int>& loop : options.loops) {
        check_together(parts, loop, "loops");
    }
    for (const std::vector<int>& loop : options.forbidden_loops) {
        check_together(parts, loop, "forbid");
    }
    check_loops(parts, options.sources, "foliation.sources");
    check_loops(parts, options.sinks, "foliation.sinks");
    if (options.weights && parts.size() > 1 && options.components == Components::Each) {
        throw Error(ErrorKind::BadOption, "weights-of-several-parts",
                    fmt::format("foliation.weights: the model has {} separate parts; weave the "
                                "largest alone (foliation.components \"largest\") or leave the "
                                "weights to us",
                                parts.size()));
    }
}

FoliationOptions options_of(const SurfacePart& part, const FoliationOptions& options) {
    FoliationOptions own = options;
    if (own.corners && !holds_any(part, *own.corners)) {
        own.corners.reset();
    }
    if (own.poles && !holds_any(part, *own.poles)) {
        own.poles.reset();
    }
    own.near.erase(
        std::remove_if(own.near.begin(), own.near.end(), [&](int v) { return !holds(part, v); }),
        own.near.end());
    for (std::vector<std::vector<int>>* loops : {&own.loops, &own.forbidden_loops}) {
        loops->erase(
            std::remove_if(loops->begin(), loops->end(),
                           [&](const std::vector<int>& loop) { return !holds_any(part, loop); }),
            loops->end());
    }
    if (own.pants == PantsSource::User && own.loops.empty() && !options.loops.empty()) {
        own.pants = PantsSource::Reeb;
    }
    keep_loops_of(part, own.sources);
    keep_loops_of(part, own.sinks);
    return own;
}

std::size_t largest_part(const std::vector<SurfacePart>& parts) {
    std::size_t largest = 0;
    double area = -1.0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const double own = surface_area(parts[k].mesh) + parts[k].removed_area;
        if (own > area) {
            area = own;
            largest = k;
        }
    }
    return largest;
}

Foliation join_parts(std::vector<Foliation> foliations, const std::vector<SurfacePart>& parts) {
    if (foliations.size() == 1) {
        return std::move(foliations.front());
    }
    const std::size_t largest = largest_part(parts);
    Foliation whole;
    whole.mode = foliations[largest].mode;
    whole.corners = foliations[largest].corners;
    for (std::size_t k = 0; k < foliations.size(); ++k) {
        scale_to_surface(foliations[k]);
        append_part(whole, std::move(foliations[k]), fmt::format("part {}: ", k + 1));
    }
    whole.spread = cell_spread(whole.cylinders);
    return whole;
}

}  // namespace leafcutter::geometry
