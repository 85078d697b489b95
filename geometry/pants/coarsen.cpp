// Coarser levels by half-edge collapses. After H. Hoppe, "Progressive meshes", 1996, and Dey et
// al., "Topology preserving edge contraction", 1999 (the link condition), in passes over
// independent sets.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "geometry/pants/collapsible.h"
#include "geometry/pants/level.h"

namespace leafcutter::geometry {
namespace {

// A closed line of fewer edges isn't simplicial.
constexpr int kLeastLine = 3;
// Passes that remove less than this part of the vertices are not worth repeating.
constexpr double kSlowPass = 0.03;
constexpr double kLastPass = 0.002;
constexpr int kCheckEvery = 4096;
// Square of the ratio of 2 x area to squared edges below which a triangle has no direction.
constexpr double kFlat = 1e-18;
// Positive floats in steps of a quarter of an octave: exponent and two bits after it.
constexpr int kBitsBelowStep = 21;
constexpr std::size_t kSteps = std::size_t{1} << (31 - kBitsBelowStep);

// What a collapse may do to triangles. The surface may be one of flipped edges, folded here and
// there in space, so the limits give way when they stop progress.
struct Limits {
    double least_cosine;  // Of the normal's turn, squared with its sign kept.
    double worst_shape;   // Square of: sum of squared edges over 2 x area; 12 at best.
    double visited;       // Part of the vertices a pass looks at, shortest edges first.
};
constexpr std::array<Limits, 4> kLimits{{{0.09, 100.0, 0.6},
                                         {0.01, 3600.0, 0.6},
                                         {-2.0, 3600.0, 1.0},
                                         {-2.0, std::numeric_limits<double>::infinity(), 1.0}}};

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Collapser {
public:
    Collapser(const LinedSurface& fine, const CoarsenOptions& options, const Context& context);
    Coarser run();

private:
    struct Choice {
        std::size_t slot = 0;  // Of the ring.
        double shape = std::numeric_limits<double>::infinity();
    };

    bool on_line(int v) const { return line_[at(v)] >= 0 || mesh_.on_boundary(v); }
    int neighbour(std::size_t slot) const { return mesh_.ring()[slot].neighbour; }

    std::vector<int> shortest_first(double part) const;
    int pass(const Limits& limits);
    void look(int v);
    bool may_go(int v) const;
    bool is_line_slot(int v, std::size_t slot) const;
    double worst_shape(std::size_t slot, const Limits& limits, double give_up) const;
    bool keeps_lines(int v, std::size_t slot) const;
    Choice best_collapse(int v, const Limits& limits) const;
    void collapse(int v, std::size_t slot);
    Coarser compact();

    const CoarsenOptions& options_;
    const Context& context_;
    const std::vector<Eigen::Vector3d>& positions_;
    const std::vector<int>& line_;
    CollapsibleMesh mesh_;
    std::vector<int> parent_;     // What a vertex was collapsed to, itself if it is there.
    std::vector<int> line_size_;  // Vertices of each line.
    std::vector<int> locked_;     // Number of the pass in which its neighbours changed.
    std::vector<Eigen::Vector3d> normals_;  // Of the ring's triangles, twice as long as their area.
    int pass_ = 0;
    std::size_t left_ = 0;  // Vertices.
};

Collapser::Collapser(const LinedSurface& fine,
                     const CoarsenOptions& options,
                     const Context& context)
    : options_(options),
      context_(context),
      positions_(fine.mesh.positions),
      line_(fine.line_of_vertex),
      mesh_(fine.mesh.triangles, static_cast<int>(positions_.size())),
      parent_(positions_.size()),
      locked_(positions_.size(), 0),
      left_(positions_.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const int line : line_) {
        if (line >= 0) {
            line_size_.resize(std::max(line_size_.size(), at(line) + 1), 0);
            ++line_size_[at(line)];
        }
    }
}

// Vertices by the mean square of their edges, rounded to steps of a quarter of an octave: those
// alike come in the order of their numbers, which are often neighbours in memory. No step is torn.
std::vector<int> Collapser::shortest_first(double part) const {
    std::vector<float> sum(positions_.size(), 0.0F);
    std::vector<int> edges(positions_.size(), 0);
    for (int h = 0; h < mesh_.half_edges(); ++h) {
        const int from = mesh_.from_of(h);
        if (from >= 0) {
            sum[at(from)] += static_cast<float>(
                (positions_[at(mesh_.to_of(h))] - positions_[at(from)]).squaredNorm());
            ++edges[at(from)];
        }
    }
    std::vector<std::size_t> step(sum.size(), 0);
    std::array<std::size_t, kSteps + 1> start{};
    for (std::size_t v = 0; v < sum.size(); ++v) {
        if (edges[v] > 0) {
            const float mean = sum[v] / static_cast<float>(edges[v]);
            step[v] = std::bit_cast<std::uint32_t>(mean) >> kBitsBelowStep;
            ++start[step[v] + 1];
        }
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    const auto wanted = static_cast<std::size_t>(part * static_cast<double>(left_));
    const std::size_t count = *std::lower_bound(start.begin(), start.end(), wanted);
    std::vector<int> order(count);
    for (std::size_t v = 0; v < sum.size(); ++v) {
        if (edges[v] > 0 && start[step[v]] < count) {
            order[start[step[v]]++] = static_cast<int>(v);
        }
    }
    return order;
}

void Collapser::look(int v) {
    mesh_.look(v);
    const std::vector<CollapsibleEntry>& ring = mesh_.ring();
    normals_.clear();
    for (std::size_t k = 0; k < ring.size(); ++k) {
        if (ring[k].half_edge >= 0) {
            const Eigen::Vector3d& left = positions_[at(ring[k].neighbour)];
            const Eigen::Vector3d& right = positions_[at(neighbour((k + 1) % ring.size()))];
            normals_.emplace_back((left - positions_[at(v)]).cross(right - positions_[at(v)]));
        }
    }
}

// Line vertices go if their line has enough others and passes straight through them.
bool Collapser::may_go(int v) const {
    if (!on_line(v)) {
        return true;
    }
    const int line = line_[at(v)];
    if (line < 0 || line_size_[at(line)] <= std::max(options_.least_line_vertices, kLeastLine)) {
        return false;
    }
    int along = 0;
    for (std::size_t k = 0; k < mesh_.ring().size(); ++k) {
        along += is_line_slot(v, k) ? 1 : 0;
    }
    return along == 2;
}

bool Collapser::is_line_slot(int v, std::size_t slot) const {
    if (line_[at(v)] < 0 || line_[at(neighbour(slot))] != line_[at(v)]) {
        return false;
    }
    return mesh_.is_closed() || slot == 0 || slot + 1 == mesh_.ring().size();
}

// Shape, squared, of the worst triangle after the collapse to ring slot `slot`; infinity if one is
// against the limits or not below `give_up`.
double Collapser::worst_shape(std::size_t slot, const Limits& limits, double give_up) const {
    constexpr double kNo = std::numeric_limits<double>::infinity();
    const std::size_t count = mesh_.ring().size();
    const Eigen::Vector3d& u = positions_[at(neighbour(slot))];
    double worst = 0.0;
    for (std::size_t k = 0; k < normals_.size(); ++k) {
        const std::size_t after = k + 1 == count ? 0 : k + 1;
        if (k == slot || after == slot) {
            continue;
        }
        const Eigen::Vector3d left = positions_[at(neighbour(k))] - u;
        const Eigen::Vector3d right = positions_[at(neighbour(after))] - u;
        const Eigen::Vector3d normal = left.cross(right);
        const double size = normal.squaredNorm();
        const double squares =
            left.squaredNorm() + right.squaredNorm() + (right - left).squaredNorm();
        const double flat = kFlat * squares * squares;
        worst = std::max(worst, squares * squares / std::max(size, flat));
        if (worst > limits.worst_shape || worst >= give_up) {
            return kNo;
        }
        const double old_size = normals_[k].squaredNorm();
        const double along = normal.dot(normals_[k]);
        if (old_size > flat && along * std::abs(along) < limits.least_cosine * size * old_size) {
            return kNo;
        }
    }
    return worst;
}

// No new edge joins two vertices of lines, but for the one that replaces two edges of v's line.
bool Collapser::keeps_lines(int v, std::size_t slot) const {
    const bool along = on_line(v);
    if (along && !is_line_slot(v, slot)) {
        return false;
    }
    if (!on_line(neighbour(slot))) {
        return true;
    }
    const std::size_t count = mesh_.ring().size();
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t apart = (k + count - slot) % count;
        const bool facing = apart <= 1 || apart + 1 == count;
        const bool other_line_edge = along && is_line_slot(v, k);
        if (k == slot || !on_line(neighbour(k))) {
            continue;
        }
        if (mesh_.is_closed() && other_line_edge && facing) {
            return false;  // u is already joined to it, beside the line.
        }
        if (!other_line_edge && !facing) {
            return false;
        }
    }
    return true;
}

Collapser::Choice Collapser::best_collapse(int v, const Limits& limits) const {
    Choice best;
    for (std::size_t slot = 0; slot < mesh_.ring().size(); ++slot) {
        const double shape = worst_shape(slot, limits, best.shape);
        if (shape < best.shape && keeps_lines(v, slot) && mesh_.may_collapse(slot)) {
            best = {slot, shape};
        }
    }
    return best;
}

void Collapser::collapse(int v, std::size_t slot) {
    for (const CollapsibleEntry& entry : mesh_.ring()) {
        locked_[at(entry.neighbour)] = pass_;
    }
    parent_[at(v)] = neighbour(slot);
    if (line_[at(v)] >= 0) {
        --line_size_[at(line_[at(v)])];
    }
    mesh_.collapse(v, slot);
    --left_;
}

// Returns how many vertices went.
int Collapser::pass(const Limits& limits) {
    ++pass_;
    int gone = 0;
    int visits = 0;
    for (const int v : shortest_first(limits.visited)) {
        if (++visits % kCheckEvery == 0) {
            context_.check();
        }
        if (left_ <= options_.target_vertices) {
            break;
        }
        if (locked_[at(v)] == pass_) {
            continue;
        }
        look(v);
        if (!may_go(v)) {
            continue;
        }
        const Choice best = best_collapse(v, limits);
        if (std::isfinite(best.shape)) {
            collapse(v, best.slot);
            ++gone;
        }
    }
    return gone;
}

Coarser Collapser::compact() {
    Coarser out;
    std::vector<int> name(positions_.size(), -1);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        if (parent_[v] == static_cast<int>(v)) {
            name[v] = static_cast<int>(out.surface.mesh.positions.size());
            out.surface.mesh.positions.push_back(positions_[v]);
            out.surface.line_of_vertex.push_back(line_[v]);
        }
    }
    out.surface.mesh.triangles.reserve(2 * left_);
    for (int h = 0; h < mesh_.half_edges(); h += 3) {
        if (mesh_.from_of(h) >= 0) {
            out.surface.mesh.triangles.push_back({name[at(mesh_.from_of(h))],
                                                  name[at(mesh_.from_of(h + 1))],
                                                  name[at(mesh_.from_of(h + 2))]});
        }
    }
    out.representative.reserve(positions_.size());
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        int kept = static_cast<int>(v);
        while (parent_[at(kept)] != kept) {
            parent_[at(kept)] = parent_[at(parent_[at(kept)])];  // Path halving.
            kept = parent_[at(kept)];
        }
        out.representative.push_back(name[at(kept)]);
    }
    return out;
}

Coarser Collapser::run() {
    for (std::size_t stage = 0; stage < kLimits.size() && left_ > options_.target_vertices;) {
        const auto before = static_cast<double>(left_);
        const int gone = pass(kLimits[stage]);
        const bool last = stage + 1 == kLimits.size();
        stage += gone < (last ? kLastPass : kSlowPass) * before ? 1 : 0;
    }
    return compact();
}

}  // namespace

Coarser coarsen(const LinedSurface& fine, const CoarsenOptions& options, const Context& context) {
    return Collapser(fine, options, context).run();
}

}  // namespace leafcutter::geometry
