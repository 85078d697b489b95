#include "geometry/harmonic/leaf_cut.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

// New vertices stay this part of an edge away from its ends: no slivers. g is taken to be what it
// is at the true crossing.
constexpr double kFromEnd = 0.05;
// A leaf climbs from source to sink and so passes a triangle once. Several times as many steps as
// there are edges mean that it goes round for ever.
constexpr int kMostPasses = 4;
constexpr int kStepsBetweenChecks = 1024;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::SelfCheck, "one-form",
                "one-form, leaves: " + what + "; remesh the model, or choose foliation.mode pants");
}

class LeafCutter {
public:
    LeafCutter(CutSurface& out, const Context& context)
        : out_(out), edges_(out.surface.edges), context_(context) {
        outgoing_ = first_outgoing(edges_, static_cast<int>(out.surface.mesh.positions.size()));
        most_steps_ = kMostPasses * edges_.size();
    }

    // Follows all leaves that end at a zero.
    void cut_from(const FormZero& zero) {
        std::vector<int>
            ways;  // Per leaf 1 if it rises, in the order they were found: to the left.
        for (int h = free_sector(zero.vertex); h >= 0; h = free_sector(zero.vertex)) {
            ways.push_back(follow(h));
        }
        if (static_cast<int>(ways.size()) != zero.lines) {
            fail(fmt::format("{} of {} leaves leave the zero at vertex {}", ways.size(), zero.lines,
                             zero.vertex));
        }
        for (std::size_t i = 1; i < ways.size(); ++i) {
            if (ways[i] == ways[i - 1]) {
                fail(fmt::format("two neighbouring leaves of the zero at vertex {} go the same way",
                                 zero.vertex));
            }
        }
    }

private:
    bool rises_along(int h) const { return rises(edges_, out_.rise, h); }

    // The half-edge out of `vertex` to the right of the next leaf that is not cut yet, or -1.
    int free_sector(int vertex) const {
        const int start = outgoing_[at(vertex)];
        const bool natural = (out_.surface.lines[at(vertex)] & NaturalLoop) != 0;
        for (int h = start; h >= 0;) {
            const int back = HalfEdges::previous(h);
            const bool bordered = out_.cut[at(h)] != 0 || out_.cut[at(back)] != 0 ||
                                  (natural && (edges_.twin_of(h) < 0 || edges_.twin_of(back) < 0));
            if (!bordered && rises_along(h) == rises_along(back)) {
                return h;
            }
            h = turn_left(edges_, h);
            if (h == start) {
                break;
            }
        }
        return -1;
    }

    // Follows the leaf that starts between half-edge `h` and the next to its left, to a loop.
    // Returns 1 if that is a sink.
    int follow(int h) {
        const double start = out_.f[at(edges_.from_of(h))];
        std::vector<double> values{start};
        for (int steps = 0; steps < most_steps_; ++steps) {
            if (steps % kStepsBetweenChecks == 0) {
                context_.check();
            }
            const int crossed = HalfEdges::next(h);
            const int twin = edges_.twin_of(crossed);
            const int x = split(crossed, out_.rise[at(h)], -out_.rise[at(HalfEdges::previous(h))]);
            mark_cut(HalfEdges::next(crossed));  // From x back to where h starts.
            values.push_back(out_.f[at(x)]);
            if (twin < 0) {
                return finish(x, values);
            }
            // Two triangles lie in front: one between x -> b and x -> d, one from there to x -> c.
            const int to_b = edges_.twin_of(crossed);
            const int to_d = HalfEdges::next(twin);
            h = rises_along(to_d) == rises_along(to_b) ? to_d : to_b;
        }
        fail("a leaf of F* reaches no loop");
    }

    int finish(int x, const std::vector<double>& values) {
        const std::uint8_t lines = out_.surface.lines[at(x)];
        if ((lines & (SourceLoop | SinkLoop)) == 0) {
            fail("a leaf of F* ends at a natural loop");
        }
        const bool up = (lines & SinkLoop) != 0;
        double best = values.front();
        for (const double value : values) {
            best = up ? std::max(best, value) : std::min(best, value);
            out_.worst_turn = std::max(out_.worst_turn, std::abs(best - value));
        }
        return up ? 1 : 0;
    }

    void mark_cut(int half_edge) {
        for (const int h : {half_edge, edges_.twin_of(half_edge)}) {
            out_.cut[at(h)] = 1;
            out_.rise[at(h)] = 0.0;
        }
    }

    // Splits half-edge h, b -> c, where g is as high as at the near apex, from which it rises by
    // `to_b` and `to_c`. Returns the new vertex.
    int split(int h, double to_b, double to_c) {
        ChartSurface& surface = out_.surface;
        const int b = edges_.from_of(h);
        const int c = edges_.to_of(h);
        const int twin = edges_.twin_of(h);
        const double sum = std::abs(to_b) + std::abs(to_c);
        const double ratio = sum > 0.0 ? std::abs(to_b) / sum : 0.5;
        const double kept = std::clamp(ratio, kFromEnd, 1.0 - kFromEnd);
        const int x = static_cast<int>(surface.mesh.positions.size());
        surface.mesh.positions.emplace_back((1.0 - kept) * surface.mesh.positions[at(b)] +
                                            kept * surface.mesh.positions[at(c)]);
        surface.source_vertex.push_back(-1);
        surface.lines.push_back(
            static_cast<std::uint8_t>(twin < 0 ? surface.lines[at(b)] & surface.lines[at(c)] : 0));
        out_.f.push_back((1.0 - kept) * out_.f[at(b)] + kept * out_.f[at(c)]);
        const int near = split_side(h, x, {to_b, to_c});
        outgoing_.push_back(near);
        if (twin >= 0) {
            const int far = split_side(twin, x, {to_c, to_b});
            link(h, far);
            link(near, twin);
        }
        return x;
    }

    void link(int h, int twin) {
        edges_.twin[at(h)] = twin;
        edges_.twin[at(twin)] = h;
    }

    // Cuts the triangle of h, a -> b, apex c, into a x c, in its place, and x b c, new. From x, g
    // rises by `to_ends` to a and b. Returns the new x -> b.
    int split_side(int h, int x, std::pair<double, double> to_ends) {
        const auto [to_a, to_b] = to_ends;
        const int h1 = HalfEdges::next(h);
        const int h2 = HalfEdges::previous(h);
        const int b = edges_.from_of(h1);
        const double b_to_c = out_.rise[at(h1)];
        const double a_to_c = -out_.rise[at(h2)];
        // Both ways round are equal but for rounding. Along leaves g is constant exactly.
        const bool through_b = b_to_c == 0.0 || (a_to_c != 0.0 && std::abs(to_b) < std::abs(to_a));
        const double to_c = through_b ? to_b + b_to_c : to_a + a_to_c;

        const int n = edges_.size();
        const int outer = edges_.twin_of(h1);
        edges_.from.insert(edges_.from.end(), {x, b, edges_.from_of(h2)});
        edges_.twin.insert(edges_.twin.end(), {-1, -1, -1});
        out_.rise.insert(out_.rise.end(), {to_b, b_to_c, -to_c});
        out_.cut.insert(out_.cut.end(), {out_.cut[at(h)], out_.cut[at(h1)], char{0}});
        out_.surface.mesh.triangles[at(h / 3)][at(h1 % 3)] = x;
        out_.surface.mesh.triangles.push_back({x, b, edges_.from_of(h2)});
        if (outer >= 0) {
            link(n + 1, outer);
        }
        edges_.from[at(h1)] = x;
        link(h1, n + 2);
        out_.rise[at(h)] = -to_a;
        out_.rise[at(h1)] = to_c;
        out_.cut[at(h1)] = 0;
        if (outgoing_[at(b)] == h1) {
            outgoing_[at(b)] = n + 1;
        }
        return n;
    }

    CutSurface& out_;
    HalfEdges& edges_;
    const Context& context_;
    std::vector<int> outgoing_;  // Per vertex; the boundary's where there is one.
    int most_steps_ = 0;
};

// Vertices that each vertex is joined to by a cut edge.
std::unordered_map<int, std::vector<int>> cut_neighbours(const CutSurface& cut) {
    std::unordered_map<int, std::vector<int>> out;
    const HalfEdges& edges = cut.surface.edges;
    for (int h = 0; h < edges.size(); ++h) {
        if (cut.cut[at(h)] != 0) {
            out[edges.from_of(h)].push_back(edges.to_of(h));
        }
    }
    return out;
}

}  // namespace

CutSurface cut_along_leaves(ChartSurface surface,
                            const ConjugateForm& form,
                            const std::vector<FormZero>& zeros,
                            const Context& context) {
    CutSurface out;
    out.surface = std::move(surface);
    out.f = form.f;
    out.rise = form.rise;
    out.cut.assign(out.rise.size(), 0);
    out.zeros = zeros;
    LeafCutter cutter(out, context);
    for (const FormZero& zero : zeros) {
        cutter.cut_from(zero);
    }
    return out;
}

std::vector<std::vector<Eigen::Vector3d>> cut_lines(const CutSurface& cut) {
    const auto neighbours = cut_neighbours(cut);
    std::vector<char> is_zero(cut.f.size(), 0);
    for (const FormZero& zero : cut.zeros) {
        is_zero[at(zero.vertex)] = 1;
    }
    std::vector<std::vector<Eigen::Vector3d>> lines;
    const auto& positions = cut.surface.mesh.positions;
    for (const FormZero& zero : cut.zeros) {
        const auto found = neighbours.find(zero.vertex);
        if (found == neighbours.end()) {
            continue;
        }
        for (const int second : found->second) {
            std::vector<Eigen::Vector3d> line{positions[at(zero.vertex)], positions[at(second)]};
            int before = zero.vertex;
            int v = second;
            while (is_zero[at(v)] == 0 && neighbours.at(v).size() == 2) {
                const std::vector<int>& both = neighbours.at(v);
                before = std::exchange(v, both[0] == before ? both[1] : both[0]);
                line.push_back(positions[at(v)]);
            }
            // A line between two zeros is found from both.
            if (is_zero[at(v)] == 0 || v > zero.vertex) {
                lines.push_back(std::move(line));
            }
        }
    }
    return lines;
}

}  // namespace leafcutter::geometry
