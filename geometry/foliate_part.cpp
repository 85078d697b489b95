#include "geometry/foliate_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/cases/annulus.h"
#include "geometry/cases/disk.h"
#include "geometry/cases/flow_search.h"
#include "geometry/cases/one_form.h"
#include "geometry/cases/pants.h"
#include "geometry/cases/sphere.h"
#include "geometry/cases/torus.h"
#include "geometry/cell_spread.h"
#include "geometry/check_foliation.h"
#include "geometry/reached_points.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Vertices of the part by what the user calls them.
class VertexNames {
public:
    explicit VertexNames(const SurfacePart& part) {
        for (std::size_t v = 0; v < part.source_vertex.size(); ++v) {
            const int source = part.source_vertex[v];
            if (source >= 0) {
                place_.resize(std::max(place_.size(), at(source) + 1), -1);
                place_[at(source)] = static_cast<int>(v);
            }
        }
    }

    // -1 if it isn't on the part.
    int find(int name) const {
        return name >= 0 && at(name) < place_.size() ? place_[at(name)] : -1;
    }

    // Throws Error(BadOption) naming `key` for a vertex that isn't on the part.
    template <typename Container>
    void translate(Container& vertices, const char* key) const {
        for (int& v : vertices) {
            const int found = find(v);
            if (found < 0) {
                throw Error(ErrorKind::BadOption, "bad-vertex",
                            fmt::format("{}: vertex {} lies in a hole", key, v));
            }
            v = found;
        }
    }

private:
    std::vector<int> place_;
};

FoliationOptions translated(const FoliationOptions& options, const SurfacePart& part) {
    const VertexNames names(part);
    FoliationOptions own = options;
    if (own.corners) {
        names.translate(*own.corners, "foliation.corners");
    }
    if (own.poles) {
        names.translate(*own.poles, "foliation.poles");
    }
    names.translate(own.near, "foliation.singularities");
    for (std::vector<int>& loop : own.loops) {
        names.translate(loop, "foliation.loops");
    }
    for (std::vector<int>& loop : own.forbidden_loops) {
        names.translate(loop, "foliation.forbid");
    }
    return own;
}

// Index of the loop in the part, or nothing if it is elsewhere.
std::optional<int> find_loop(const SurfacePart& part, const LoopName& name) {
    const auto index_of = [](auto begin, auto found) { return static_cast<int>(found - begin); };
    if (name.number) {
        const auto found =
            std::find(part.loop_numbers.begin(), part.loop_numbers.end(), *name.number);
        if (*name.number >= 0 && found != part.loop_numbers.end()) {
            return index_of(part.loop_numbers.begin(), found);
        }
        return std::nullopt;
    }
    const int vertex = name.vertex.value_or(-1);
    const auto found = std::find_if(part.loops.begin(), part.loops.end(), [&](const auto& loop) {
        return std::any_of(loop.begin(), loop.end(), [&](int v) {
            return vertex >= 0 && part.source_vertex[at(v)] == vertex;
        });
    });
    if (found != part.loops.end()) {
        return index_of(part.loops.begin(), found);
    }
    // The middle of a hole stands for its rim; holes come last.
    const auto hole = std::find_if(part.punctures.begin(), part.punctures.end(),
                                   [&](const Puncture& p) { return p.vertex == vertex; });
    if (hole != part.punctures.end()) {
        return index_of(part.punctures.begin(), hole) +
               static_cast<int>(part.loops.size() - part.punctures.size());
    }
    return std::nullopt;
}

std::vector<int> find_loops(const SurfacePart& part, const std::vector<LoopName>& names) {
    std::vector<int> found;
    for (const LoopName& name : names) {
        const std::optional<int> loop = find_loop(part, name);
        if (loop && std::find(found.begin(), found.end(), *loop) == found.end()) {
            found.push_back(*loop);
        }
    }
    return found;
}

double length_of(const TriangleMesh& mesh, const std::vector<int>& loop) {
    double length = 0.0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
        length +=
            (mesh.positions[at(loop[(k + 1) % loop.size()])] - mesh.positions[at(loop[k])]).norm();
    }
    return length;
}

// Loops that are neither source nor sink.
std::vector<int> all_but(const SurfacePart& part, const std::vector<int>& taken) {
    std::vector<int> others;
    for (int k = 0; k < static_cast<int>(part.loops.size()); ++k) {
        if (std::find(taken.begin(), taken.end(), k) == taken.end()) {
            others.push_back(k);
        }
    }
    return others;
}

Foliation one_form(const SurfacePart& part,
                   const FoliationOptions& options,
                   const Context& context) {
    std::vector<int> sources = find_loops(part, options.sources);
    std::vector<int> sinks = find_loops(part, options.sinks);
    const bool is_free = sources.empty() || sinks.empty();
    if (is_free && !options.near.empty() && part.loops.size() > 2) {
        FlowEnds ends =
            nearest_flow(part.mesh, part.loops, {sources, sinks}, options.near, context);
        sources = std::move(ends.sources);
        sinks = std::move(ends.sinks);
    }
    if (sources.empty()) {
        const std::vector<int> free = all_but(part, sinks);
        const auto longest = std::max_element(free.begin(), free.end(), [&](int a, int b) {
            return length_of(part.mesh, part.loops[at(a)]) <
                   length_of(part.mesh, part.loops[at(b)]);
        });
        if (longest != free.end()) {
            sources.push_back(*longest);
        }
    }
    if (sinks.empty()) {
        sinks = all_but(part, sources);
    }
    return foliate_one_form(part.mesh, part.loops, {sources, sinks}, options, context);
}

Foliation dispatch(const SurfacePart& part,
                   FoliationMode mode,
                   const FoliationOptions& options,
                   const Context& context) {
    switch (mode) {
        case FoliationMode::Disk:
            return foliate_disk(part.mesh, part.loops[0], options, context);
        case FoliationMode::Annulus:
            return foliate_annulus(part.mesh, {part.loops[0], part.loops[1]}, options, context);
        case FoliationMode::Torus:
            return foliate_torus(part.mesh, options, context);
        case FoliationMode::SpherePillowcase:
            return foliate_pillowcase(part.mesh, options, context);
        case FoliationMode::SpherePolar:
            return foliate_sphere_polar(part.mesh, options, context);
        case FoliationMode::OneForm:
            return one_form(part, options, context);
        case FoliationMode::Pants:
        case FoliationMode::Auto:
            break;
    }
    return foliate_pants(part.mesh, part.loops, options, context);
}

bool has_singular_points(FoliationMode mode) {
    return mode == FoliationMode::Pants || mode == FoliationMode::OneForm ||
           mode == FoliationMode::SpherePolar || mode == FoliationMode::SpherePillowcase;
}

void check_forbidden(const SurfacePart& part, FoliationMode mode, const FoliationOptions& options) {
    if (!options.forbidden_loops.empty() && mode != FoliationMode::Pants) {
        throw Error(ErrorKind::BadOption, "nothing-to-forbid",
                    fmt::format("foliation.forbid: the model is {}, woven in mode \"{}\" without a "
                                "choice of loops; leave it out",
                                describe(part), name_of(mode)));
    }
}

void check_near(const SurfacePart& part, FoliationMode mode, const FoliationOptions& options) {
    if (!options.near.empty() && !has_singular_points(mode)) {
        throw Error(ErrorKind::BadOption, "no-singular-points",
                    fmt::format("foliation.singularities: the model is {}, whose leaves in mode "
                                "\"{}\" have no singular points; leave it out, or open holes with "
                                "foliation.punctures",
                                describe(part), name_of(mode)));
    }
}

// The poles of a sphere are cut out: they are no singular points of what is left, but what is
// wanted near places.
std::vector<ReachedPoint> reached_of(const Foliation& foliation,
                                     const SurfacePart& part,
                                     std::span<const int> wanted,
                                     const Context& context) {
    std::vector<Eigen::Vector3d> points;
    const bool is_polar = foliation.mode == FoliationMode::SpherePolar;
    for (const Singularity& singularity : foliation.singularities) {
        points.push_back(singularity.position);
    }
    for (const Puncture& pole : foliation.punctures) {
        if (is_polar) {
            points.push_back(part.mesh.positions[at(pole.vertex)]);
        }
    }
    std::vector<ReachedPoint> reached = reached_points(part.mesh, wanted, points, context);
    for (ReachedPoint& point : reached) {
        point.singularity = is_polar ? -1 : point.singularity;
    }
    return reached;
}

// Back to the vertices of the surface the user gave.
void restore_names(Foliation& foliation, const SurfacePart& part) {
    for (Cylinder& cylinder : foliation.cylinders) {
        for (int& v : cylinder.source_vertex) {
            v = v < 0 ? -1 : part.source_vertex[at(v)];
        }
    }
    if (foliation.corners) {
        for (int& v : *foliation.corners) {
            v = part.source_vertex[at(v)];
        }
    }
    for (Puncture& puncture : foliation.punctures) {
        puncture.vertex = part.source_vertex[at(puncture.vertex)];
    }
    for (ReachedPoint& point : foliation.reached) {
        point.vertex = part.source_vertex[at(point.vertex)];
    }
}

}  // namespace

int holes_needed(const SurfacePart& part, FoliationMode mode) {
    const int loops = static_cast<int>(part.loops.size());
    if (mode == FoliationMode::OneForm) {
        return std::max(0, 2 - loops);
    }
    if (mode == FoliationMode::Pants) {
        return std::max(0, part.euler + 1);
    }
    const FoliationMode natural = natural_mode(part);
    if (mode == natural || (mode == FoliationMode::SpherePolar && part.euler == 2)) {
        return 0;
    }
    if (part.genus() == 0 && mode == FoliationMode::Annulus && loops < 2) {
        return 2 - loops;
    }
    return part.euler == 2 && mode == FoliationMode::Disk ? 1 : -1;
}

Foliation foliate_part(const SurfacePart& part,
                       FoliationMode mode,
                       const FoliationOptions& options,
                       const Context& context) {
    const int needed = holes_needed(part, mode);
    if (needed != 0) {
        throw Error(
            ErrorKind::BadOption, "mode-does-not-fit",
            fmt::format("foliation.mode: \"{}\" does not fit, the model is {}{}", name_of(mode),
                        describe(part),
                        needed < 0 ? ""
                                   : fmt::format("; it needs {} hole{} more (foliation.punctures)",
                                                 needed, needed == 1 ? "" : "s")));
    }
    check_near(part, mode, options);
    check_forbidden(part, mode, options);
    const FoliationOptions own = translated(options, part);
    Foliation foliation = dispatch(part, mode, own, context);
    foliation.mode = mode;
    foliation.spread = cell_spread(foliation.cylinders);
    check_foliation(foliation, part);
    if (!own.near.empty()) {
        foliation.reached = reached_of(foliation, part, own.near, context);
    }
    restore_names(foliation, part);
    foliation.punctures.insert(foliation.punctures.begin(), part.punctures.begin(),
                               part.punctures.end());
    return foliation;
}

}  // namespace leafcutter::geometry
