#include "geometry/cases/one_form.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "geometry/cases/annulus.h"
#include "geometry/cases/disk.h"
#include "geometry/cell_spread.h"
#include "geometry/harmonic/conjugate_form.h"
#include "geometry/harmonic/form_parts.h"
#include "geometry/harmonic/form_zeros.h"
#include "geometry/harmonic/leaf_cut.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/harmonic/thin_parts.h"
#include "geometry/parallel.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

// The flux of a hole of few edges is known badly, and with it the widths of all parts.
constexpr std::size_t kLeastLoopVertices = 32;
constexpr int kMostLoopRounds = 6;
// Rounds of splitting near vertices where the solution looks like no harmonic form.
constexpr int kMostRegularRounds = 6;
// Parts with less of the flux and of the area are made by the mesh, not by the shape, and a fifth
// of a column in a grid of 3000 cells.
constexpr double kThinPart = 0.01;
// f may turn back by this much on a leaf of F*, where it only rises.
constexpr double kMostTurn = 0.02;
// Bounds of the error of all widths together, and of the whole surface's modulus.
constexpr double kMostFluxError = 0.3;
constexpr double kNotableError = 0.05;
// Part of the whole time that the one-form takes, before the charts of its parts.
constexpr double kSolveShare = 0.5;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void refuse(const std::string& code, const std::string& what) {
    throw Error(ErrorKind::BadOption, code, what);
}

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::SelfCheck, "one-form", "one-form, " + what);
}

// What each loop is: bits of LoopBit.
std::vector<std::uint8_t> loop_kinds(std::size_t count, const FlowEnds& ends) {
    std::vector<std::uint8_t> kinds(count, NaturalLoop | BoundaryLoop);
    const auto name = [&](const std::vector<int>& loops, LoopBit bit, const std::string& what) {
        const std::string option = "foliation." + what;
        if (loops.empty()) {
            refuse("bad-" + what, fmt::format("{}: one-form needs at least one; the model has {} "
                                              "boundary loops: open holes with foliation.puncture "
                                              "if it has less than two",
                                              option, count));
        }
        for (const int loop : loops) {
            if (loop < 0 || at(loop) >= count) {
                refuse("bad-" + what, fmt::format("{}: there is no boundary loop {}, the model has "
                                                  "{}",
                                                  option, loop, count));
            }
            if ((kinds[at(loop)] & NaturalLoop) == 0) {
                refuse("bad-" + what,
                       fmt::format("{}: boundary loop {} is named twice", option, loop));
            }
            kinds[at(loop)] = static_cast<std::uint8_t>(bit | BoundaryLoop);
        }
    };
    name(ends.sources, SourceLoop, "sources");
    name(ends.sinks, SinkLoop, "sinks");
    return kinds;
}

int euler_characteristic(const HalfEdges& edges, std::size_t vertices) {
    int count = static_cast<int>(vertices) + edges.size() / 3;
    for (int h = 0; h < edges.size(); ++h) {
        count -= edges.is_first(h) ? 1 : 0;
    }
    return count;
}

// Splits the triangles at loops of few vertices.
ChartSurface with_fine_loops(ChartSurface surface) {
    for (int round = 0; round < kMostLoopRounds; ++round) {
        std::vector<char> near(surface.mesh.positions.size(), 0);
        bool any = false;
        for (const std::vector<int>& walk : boundary_walks(surface.edges)) {
            if (walk.size() >= kLeastLoopVertices) {
                continue;
            }
            any = true;
            for (const int h : walk) {
                near[at(surface.edges.from_of(h))] = 1;
            }
        }
        if (!any) {
            break;
        }
        std::vector<char> marked(at(surface.edges.size()), 0);
        for (int h = 0; h < surface.edges.size(); ++h) {
            if (near[at(surface.edges.from_of(h))] != 0) {
                std::fill_n(marked.begin() + 3 * static_cast<std::ptrdiff_t>(h / 3), 3, char{1});
            }
        }
        surface = split_edges(std::move(surface), marked);
    }
    return surface;
}

// A surface fine enough for its one-form, and that form.
struct SolvedForm {
    ChartSurface surface;
    ConjugateForm form;
    std::vector<FormZero> zeros;
};

SolvedChart solve_whole(const ChartSurface& surface, SolvedForm& out) {
    out.surface = surface;
    out.form = solve_conjugate_form(surface);
    SolvedChart solved;
    solved.map = start_chart(surface);
    solved.map.jump.resize(out.form.rise.size());
    for (std::size_t v = 0; v < out.form.f.size(); ++v) {
        solved.map.gf[v] = {0.0, out.form.f[v]};
    }
    for (std::size_t h = 0; h < out.form.rise.size(); ++h) {
        solved.map.jump[h] = {out.form.rise[h], 0.0};
    }
    solved.upper = out.form.conjugate;
    solved.lower = out.form.flux;
    return solved;
}

std::vector<char> edges_near(const ChartSurface& surface, const std::vector<int>& vertices) {
    std::vector<char> near(surface.mesh.positions.size(), 0);
    for (const int v : vertices) {
        near[at(v)] = 1;
    }
    std::vector<char> marked(at(surface.edges.size()), 0);
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        const auto& triangle = surface.mesh.triangles[t];
        if (std::any_of(triangle.begin(), triangle.end(),
                        [&](int v) { return near[at(v)] != 0; })) {
            std::fill_n(marked.begin() + 3 * static_cast<std::ptrdiff_t>(t), 3, char{1});
        }
    }
    return marked;
}

void check_orders(const SolvedForm& solved, int euler) {
    int doubled = 0;
    for (const FormZero& zero : solved.zeros) {
        const bool natural = (solved.surface.lines[at(zero.vertex)] & NaturalLoop) != 0;
        doubled += natural ? zero.lines : zero.lines - 2;
    }
    if (doubled != -2 * euler) {
        fail(fmt::format("zeros: orders add up to {} instead of {}", 0.5 * doubled, -euler));
    }
}

SolvedForm solve_form(ChartSurface surface, Refinement refinement, const Context& context) {
    const bool may_split = refinement == Refinement::Allowed;
    if (may_split) {
        surface = with_fine_loops(std::move(surface));
    }
    SolvedForm out;
    solve_resolved(
        std::move(surface), [&out](const ChartSurface& s) { return solve_whole(s, out); },
        refinement, context);
    for (int round = 0;; ++round) {
        context.check();
        const bool last = !may_split || round == kMostRegularRounds;
        const FormZeros found = make_regular(out.surface, out.form.rise,
                                             last ? FormRepair::Everywhere : FormRepair::Near);
        if (found.irregular.empty()) {
            out.zeros = found.zeros;
            return out;
        }
        if (last) {
            fail(fmt::format(
                "zeros: {} vertices are extrema of the conjugate function, the first "
                "near ({:.4g}, {:.4g}, {:.4g}); remesh the model there",
                found.irregular.size(), out.surface.mesh.positions[at(found.irregular.front())].x(),
                out.surface.mesh.positions[at(found.irregular.front())].y(),
                out.surface.mesh.positions[at(found.irregular.front())].z()));
        }
        solve_whole(split_edges(std::move(out.surface), edges_near(out.surface, found.irregular)),
                    out);
    }
}

Foliation rectangle_of(const FormPart& part,
                       const RectangleBorder& border,
                       const FoliationOptions& options,
                       const Context& context) {
    try {
        return foliate_rectangle(part.mesh, border, options, context);
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::SelfCheck) {
            throw;
        }
        fail(
            fmt::format("parts: one that carries a flux of {:.2g} can't be made a rectangle, {}. "
                        "Choose foliation.mode pants, or other sources and sinks",
                        part.flux, error.what()));
    }
}

// Names the vertices on flanks, by which neighbouring parts know their common side. Returns the
// names by vertices of the cut surface, -1 elsewhere.
std::vector<int> name_flanks(Foliation& foliation,
                             const CutSurface& cut,
                             const std::vector<FormPart>& parts) {
    std::vector<int> names(cut.surface.mesh.positions.size(), -1);
    const auto name = [&](int v) {
        if (names[at(v)] < 0) {
            names[at(v)] = static_cast<int>(foliation.critical_points.size());
            foliation.critical_points.push_back({cut.surface.mesh.positions[at(v)], 2});
        }
    };
    for (const FormPart& part : parts) {
        const int count = static_cast<int>(part.loop.size());
        for (const std::size_t begin : {std::size_t{1}, std::size_t{3}}) {
            const int end = part.corners[(begin + 1) % 4];
            for (int i = part.corners[begin]; i != end; i = (i + 1) % count) {
                name(part.source_vertex[at(part.loop[at(i)])]);
            }
            name(part.source_vertex[at(part.loop[at(end)])]);
        }
    }
    for (const FormZero& zero : cut.zeros) {
        if (names[at(zero.vertex)] >= 0) {
            const bool natural = (cut.surface.lines[at(zero.vertex)] & NaturalLoop) != 0;
            foliation.critical_points[at(names[at(zero.vertex)])].prongs =
                zero.lines + (natural ? 2 : 0);
        }
    }
    return names;
}

// The chart of one part. Along seams f is held at the whole surface's: rows of neighbouring parts
// meet.
Foliation chart_of(const CutSurface& cut,
                   const FormPart& part,
                   const std::vector<int>& names,
                   const FoliationOptions& options,
                   const Context& context) {
    std::vector<double> f;
    f.reserve(part.source_vertex.size());
    for (const int v : part.source_vertex) {
        f.push_back(cut.f[at(v)]);
    }
    Foliation chart = rectangle_of(part, {part.loop, part.corners, f}, options, context);
    Cylinder& cylinder = chart.cylinders.front();
    for (int& source : cylinder.source_vertex) {
        const int v = source < 0 ? -1 : part.source_vertex[at(source)];
        cylinder.critical_point.push_back(v < 0 ? -1 : names[at(v)]);
        source = v < 0 ? -1 : cut.surface.source_vertex[at(v)];
    }
    return chart;
}

void add_charts(Foliation& foliation,
                const CutSurface& cut,
                const FoliationOptions& options,
                const Context& context) {
    const std::vector<FormPart> parts = separate_parts(cut);
    const std::vector<int> names = name_flanks(foliation, cut, parts);
    std::vector<Foliation> charts(parts.size());
    for_each_task(parts.size(), context, [&](std::size_t k, const Context& own) {
        charts[k] = chart_of(cut, parts[k], names, options, own);
    });
    for (std::size_t k = 0; k < charts.size(); ++k) {
        for (const std::string& warning : charts[k].warnings) {
            foliation.warnings.push_back(fmt::format("part {}: {}", k, warning));
        }
        Cylinder& cylinder = charts[k].cylinders.front();
        cylinder.graph_edge = static_cast<int>(k);
        foliation.graph.edges.push_back({0, 1, 1.0});
        foliation.cylinders.push_back(std::move(cylinder));
    }
}

// All parts together are the surface, and their widths its flux.
void check_whole(const Foliation& foliation, const SolvedForm& solved, double area) {
    double covered = 0.0;
    double width = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        covered += surface_area(cylinder.mesh);
        width += cylinder.width;
    }
    if (!(std::abs(covered - area) <= 1e-6 * area)) {
        fail(fmt::format("parts: they cover {:.6g} of an area of {:.6g}", covered, area));
    }
    if (!(std::abs(width / solved.form.flux - 1.0) <= kMostFluxError)) {
        fail(
            fmt::format("parts: their widths add up to {:.4g}, but the flux is {:.4g}: the mesh "
                        "is too coarse; refine it",
                        width, solved.form.flux));
    }
}

void warn_of_errors(Foliation& foliation, const SolvedForm& solved, double worst_turn) {
    const double gap = solved.form.conjugate / solved.form.flux - 1.0;
    if (gap > kNotableError) {
        foliation.warnings.push_back(
            fmt::format("the mesh is coarse for its one-form: the flux is certain to {:.1f} % "
                        "only, so neighbouring parts may not fit; refine the mesh",
                        100.0 * gap));
    }
    if (worst_turn > kMostTurn) {
        foliation.warnings.push_back(
            fmt::format("a line between two parts turns back by {:.1f} % of the way from source "
                        "to sink; refine the mesh",
                        100.0 * worst_turn));
    }
}

void add_singularities(Foliation& foliation, const CutSurface& cut) {
    for (const FormZero& zero : cut.zeros) {
        if (cut.surface.lines[at(zero.vertex)] == 0) {
            foliation.singularities.push_back(
                {cut.surface.mesh.positions[at(zero.vertex)], zero.lines});
        }
    }
}

// For work that is the first `share` of the whole.
Context first_part_of(const Context& context, double share) {
    Context first = context;
    if (context.progress) {
        first.progress = [&context, share](std::string_view stage, double fraction) {
            context.progress(stage, share * fraction);
        };
    }
    return first;
}

Foliation between_two_loops(const TriangleMesh& mesh,
                            const std::array<std::vector<int>, 2>& loops,
                            const FoliationOptions& options,
                            const Context& context) {
    Foliation foliation = foliate_ring(mesh, loops, options, context);
    foliation.mode = FoliationMode::OneForm;
    foliation.spread = cell_spread(foliation.cylinders);
    return foliation;
}

}  // namespace

Foliation foliate_one_form(const TriangleMesh& mesh,
                           const std::vector<std::vector<int>>& loops,
                           const FlowEnds& ends,
                           const FoliationOptions& options,
                           const Context& context) {
    const std::vector<std::uint8_t> kinds = loop_kinds(loops.size(), ends);
    std::vector<std::uint8_t> lines(mesh.positions.size(), 0);
    for (std::size_t k = 0; k < loops.size(); ++k) {
        for (const int v : loops[k]) {
            lines[at(v)] = kinds[k];
        }
    }
    ChartSurface start = start_surface(mesh, std::move(lines));
    const int euler = euler_characteristic(start.edges, start.mesh.positions.size());
    if (euler == 0) {
        return between_two_loops(mesh,
                                 {loops[at(ends.sources.front())], loops[at(ends.sinks.front())]},
                                 options, context);
    }
    const SolvedForm solved =
        solve_form(std::move(start), options.refinement, first_part_of(context, kSolveShare));
    check_orders(solved, euler);
    context.report("foliation", kSolveShare);
    CutSurface cut = cut_along_leaves(solved.surface, solved.form, solved.zeros, context);
    const int joined = join_thin_parts(cut, kThinPart, context);

    Foliation foliation;
    foliation.mode = FoliationMode::OneForm;
    foliation.graph.nodes = 2;
    foliation.energy = 0.5 * solved.form.flux;
    foliation.iterations = 1;
    add_singularities(foliation, cut);
    foliation.critical_graph = cut_lines(cut);
    add_charts(foliation, cut, options, context);
    check_whole(foliation, solved, surface_area(mesh));
    warn_of_errors(foliation, solved, cut.worst_turn);
    if (joined > 0) {
        foliation.warnings.push_back(
            fmt::format("{} parts of almost no width were joined to their neighbours", joined));
    }
    foliation.spread = cell_spread(foliation.cylinders);
    context.report("foliation", 1.0);
    return foliation;
}

}  // namespace leafcutter::geometry
