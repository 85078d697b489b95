#include "geometry/quads/planar_solver.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "geometry/parallel.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;
using Vertices = std::vector<Vector3d>;

// No vertex goes further in one step, in cells.
constexpr double kLongestStep = 0.3;
constexpr double kLongestOfSide = 0.5;  // Nor further than that part of its shortest side.

// Cells may not come below, nor those that lie below already get worse.
constexpr double kSmallestSine = 0.02;
constexpr double kSmallestStretch = 0.1;

// Below these they become firmer with every step.
constexpr double kWeakSine = 0.1;
constexpr double kWeakStretch = 0.2;
constexpr double kFirming = 1.5;
constexpr double kFirmest = 300.0;

constexpr int kHalvings = 7;        // Of the whole step, until the energy falls.
constexpr int kLocalHalvings = 6;   // Of the steps around a spoiled cell, before they are nought.
constexpr int kLocalAttempts = 12;  // With nought more.
constexpr double kDescent = 1e-5;

// Levenberg's damping, vertex by vertex: up around cells that don't do what their equations say,
// down again afterwards.
constexpr double kLeastDamping = 1e-8;
constexpr double kFirstDamping = 1.0;
constexpr double kMostDamping = 1e10;
constexpr double kDampingGrowth = 10.0;
constexpr double kDampingDecay = 0.3;
constexpr double kNearWorst = 0.1;  // Cells with an error of that part of the worst are damped.

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double sum_of(const std::vector<double>& parts) {
    return std::accumulate(parts.begin(), parts.end(), 0.0);
}

}  // namespace

PlanarSolver::PlanarSolver(const QuadMesh& mesh,
                           const TriangleMesh& surface,
                           const Context& context)
    : mesh_(mesh),
      context_(context),
      anchors_(mesh, surface),
      state_{.vertices = mesh.vertices,
             .pull = std::vector<double>(mesh.quads.size(), 0.0),
             .firmness = std::vector<double>(mesh.quads.size(), 1.0)},
      blocks_(mesh.vertices.size(), mesh.quads),
      parts_(mesh.quads.size()),
      damping_(mesh.vertices.size(), kLeastDamping) {
    for (std::size_t cell = 0; cell < mesh.quads.size(); ++cell) {
        start_.push_back(corners_of(cell, mesh.vertices));
    }
}

CellCorners PlanarSolver::corners_of(std::size_t cell, const Vertices& vertices) const {
    const auto& quad = mesh_.quads[cell];
    return {vertices[at(quad[0])], vertices[at(quad[1])], vertices[at(quad[2])],
            vertices[at(quad[3])]};
}

PlanarSolver::Bend PlanarSolver::bend_of_cells(const Vertices& vertices) const {
    Bend bend;
    for (std::size_t cell = 0; cell < mesh_.quads.size(); ++cell) {
        const double own = std::abs(bend_of(corners_of(cell, vertices)));
        bend.largest = std::max(bend.largest, own);
        bend.mean += own / static_cast<double>(mesh_.quads.size());
    }
    return bend;
}

std::size_t PlanarSolver::cells_over(double bound) const {
    std::size_t over = 0;
    for (std::size_t cell = 0; cell < mesh_.quads.size(); ++cell) {
        over += std::abs(bend_of(corners_of(cell, state_.vertices))) > bound ? 1U : 0U;
    }
    return over;
}

void PlanarSolver::raise_pulls(double weight) {
    for (std::size_t cell = 0; cell < mesh_.quads.size(); ++cell) {
        state_.pull[cell] += weight * weight * twist_of(corners_of(cell, state_.vertices));
    }
}

void PlanarSolver::assemble(double weight) {
    for_each_index(parts_.size(), context_, [&](std::size_t cell) {
        CellResidual residual;
        CellJacobian jacobian;
        cell_rows(start_[cell], corners_of(cell, state_.vertices), wishes_of(cell, weight),
                  residual, &jacobian);
        parts_[cell].block.noalias() = jacobian.transpose() * jacobian;
        parts_[cell].gradient.noalias() = jacobian.transpose() * residual;
        parts_[cell].energy = residual.squaredNorm();
    });
    blocks_.clear();
    gradient_.setZero(static_cast<Eigen::Index>(3 * state_.vertices.size()));
    for (std::size_t v = 0; v < state_.vertices.size(); ++v) {
        const double size = anchors_.size(v);
        const Eigen::Matrix3d damping = Eigen::Matrix3d::Identity() * (damping_[v] / (size * size));
        Vector3d gradient = Vector3d::Zero();
        blocks_.add_vertex(v, damping);
        for (const Anchor* anchor : {&anchors_.held(v), &anchors_.start(v)}) {
            blocks_.add_vertex(v, anchor->weight);
            gradient += anchor->weight * (state_.vertices[v] - anchor->place);
        }
        gradient_.segment<3>(static_cast<Eigen::Index>(3 * v)) = gradient;
    }
    for (std::size_t cell = 0; cell < parts_.size(); ++cell) {
        blocks_.add_cell(cell, parts_[cell].block);
        for (std::size_t i = 0; i < 4; ++i) {
            gradient_.segment<3>(static_cast<Eigen::Index>(3 * at(mesh_.quads[cell][i]))) +=
                parts_[cell].gradient.segment<3>(static_cast<Eigen::Index>(3 * i));
        }
    }
}

std::vector<double> PlanarSolver::cell_energies(const Vertices& vertices, double weight) const {
    std::vector<double> energies(mesh_.quads.size(), 0.0);
    for_each_index(energies.size(), context_, [&](std::size_t cell) {
        CellResidual residual;
        cell_rows(start_[cell], corners_of(cell, vertices), wishes_of(cell, weight), residual,
                  nullptr);
        energies[cell] = residual.squaredNorm();
    });
    return energies;
}

double PlanarSolver::anchor_energy(const Vertices& vertices) const {
    double sum = 0.0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        for (const Anchor* anchor : {&anchors_.held(v), &anchors_.start(v)}) {
            const Vector3d away = vertices[v] - anchor->place;
            sum += away.dot(anchor->weight * away);
        }
    }
    return sum;
}

void PlanarSolver::damp_cell(std::size_t cell) {
    for (const int vertex : mesh_.quads[cell]) {
        double& damping = damping_[at(vertex)];
        damping = std::clamp(kDampingGrowth * damping, kFirstDamping, kMostDamping);
    }
}

void PlanarSolver::firm_up_weak_cells() {
    for (std::size_t cell = 0; cell < mesh_.quads.size(); ++cell) {
        const CellCorners now = corners_of(cell, state_.vertices);
        const bool thin = smallest_stretch(start_[cell], now) < kWeakStretch;
        const double sine = std::min(kWeakSine, smallest_sine(start_[cell]));
        if (thin || smallest_sine(now) < sine) {
            double& firmness = state_.firmness[cell];
            firmness = std::min(kFirming * firmness, kFirmest);
        }
    }
}

void PlanarSolver::relax_damping() {
    for (double& damping : damping_) {
        damping = std::max(kDampingDecay * damping, kLeastDamping);
    }
}

// Damps the cells whose energy after the steps is most above what their equations promised.
void PlanarSolver::damp_where_bent(const Vertices& steps, const std::vector<double>& energies) {
    std::vector<double> errors(energies.size(), 0.0);
    double worst = 0.0;
    for (std::size_t cell = 0; cell < energies.size(); ++cell) {
        Eigen::Matrix<double, 12, 1> step;
        for (std::size_t i = 0; i < 4; ++i) {
            step.segment<3>(static_cast<Eigen::Index>(3 * i)) = steps[at(mesh_.quads[cell][i])];
        }
        const CellPart& part = parts_[cell];
        const double promised =
            part.energy + 2.0 * part.gradient.dot(step) + step.dot(part.block * step);
        errors[cell] = energies[cell] - promised;
        worst = std::max(worst, errors[cell]);
    }
    for (std::size_t cell = 0; cell < errors.size(); ++cell) {
        if (errors[cell] > 0.0 && errors[cell] >= kNearWorst * worst) {
            damp_cell(cell);
        }
    }
}

std::vector<char> PlanarSolver::spoiled(const Vertices& vertices) const {
    std::vector<char> of_cell(mesh_.quads.size(), 0);
    for_each_index(of_cell.size(), context_, [&](std::size_t cell) {
        const CellCorners now = corners_of(cell, vertices);
        const CellCorners before = corners_of(cell, state_.vertices);
        const double sine = std::min(kSmallestSine, smallest_sine(before));
        const double stretch = std::min(kSmallestStretch, smallest_stretch(start_[cell], before));
        const bool concave = smallest_sine(now) < sine;
        const bool squashed = smallest_stretch(start_[cell], now) < stretch;
        of_cell[cell] = static_cast<char>(concave || squashed);
    });
    return of_cell;
}

bool PlanarSolver::is_sound(const Vertices& vertices) const {
    for (std::size_t cell = 0; cell < mesh_.quads.size(); ++cell) {
        const CellCorners now = corners_of(cell, vertices);
        if (smallest_sine(now) < std::min(0.0, smallest_sine(start_[cell]))) {
            return false;
        }
    }
    return true;
}

// Shortens the steps around cells that they would spoil. Whether there were any.
bool PlanarSolver::shorten_spoiling(Vertices& steps, int attempt) {
    Vertices moved(steps.size());
    for (std::size_t v = 0; v < steps.size(); ++v) {
        moved[v] = state_.vertices[v] + steps[v];
    }
    const std::vector<char> cells = spoiled(moved);
    std::vector<char> shorten(steps.size(), 0);
    bool any = false;
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
        if (cells[cell] == 0) {
            continue;
        }
        any = true;
        for (const int vertex : mesh_.quads[cell]) {
            shorten[at(vertex)] = 1;
        }
        if (attempt == 0) {
            damp_cell(cell);
        }
    }
    for (std::size_t v = 0; v < steps.size(); ++v) {
        if (shorten[v] != 0) {
            steps[v] *= attempt < kLocalHalvings ? 0.5 : 0.0;
        }
    }
    return any;
}

// The steps of Gauss-Newton, cut to length one by one, and shorter around cells they would spoil.
Vertices PlanarSolver::safe_steps() {
    if (factor_) {
        factor_->refactor(blocks_.matrix());
    } else {
        factor_.emplace(blocks_.matrix());
    }
    context_.check();
    const Eigen::VectorXd solution = factor_->solve(gradient_);
    Vertices steps(state_.vertices.size());
    longest_ = 0.0;
    for (std::size_t v = 0; v < steps.size(); ++v) {
        steps[v] = -solution.segment<3>(static_cast<Eigen::Index>(3 * v));
        const double length = steps[v].norm() / anchors_.size(v);
        longest_ = std::max(longest_, length);
        const double allowed =
            std::min(kLongestStep, kLongestOfSide * anchors_.shortest_side(v) / anchors_.size(v));
        steps[v] *= std::min(1.0, allowed / std::max(length, 1e-300));
    }
    int attempt = 0;
    while (attempt < kLocalAttempts && shorten_spoiling(steps, attempt)) {
        ++attempt;
    }
    return steps;
}

PlanarSolver::Step PlanarSolver::step(double weight) {
    anchors_.update(state_.vertices, context_);
    firm_up_weak_cells();
    assemble(weight);
    const Vertices steps = safe_steps();
    const double before =
        sum_of(cell_energies(state_.vertices, weight)) + anchor_energy(state_.vertices);
    Vertices moved(steps.size());
    double part = 1.0;
    for (int halving = 0; halving < kHalvings; ++halving, part *= 0.5) {
        for (std::size_t v = 0; v < steps.size(); ++v) {
            moved[v] = state_.vertices[v] + part * steps[v];
        }
        const std::vector<double> energies = cell_energies(moved, weight);
        const bool lower =
            sum_of(energies) + anchor_energy(moved) < before * (1.0 - kDescent * part);
        if (halving == 0 && !lower) {
            damp_where_bent(steps, energies);
        }
        if (lower) {
            state_.vertices = std::move(moved);
            relax_damping();
            return {.wanted = longest_, .taken = part};
        }
    }
    return {.wanted = longest_, .taken = 0.0};
}

}  // namespace leafcutter::geometry
