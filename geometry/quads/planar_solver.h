// Steps towards planar cells: Gauss-Newton on the wishes of planar_cell.h and the anchors of
// planar_anchors.h, planarity as a constraint by an augmented Lagrangian.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/quads/cell_blocks.h"
#include "geometry/quads/planar_anchors.h"
#include "geometry/quads/planar_cell.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/sparse_solver.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

class PlanarSolver {
public:
    struct State {
        std::vector<Eigen::Vector3d> vertices;
        std::vector<double> pull;      // Per cell the multiplier of its planarity.
        std::vector<double> firmness;  // Per cell, more where it would collapse.
    };
    struct Step {
        double wanted = 0.0;  // The longest step of a vertex before it was cut, in cells.
        double taken = 0.0;   // The part of the cut steps that was taken.
    };

    // Keeps references to all three; vertices are those of the mesh to begin with.
    PlanarSolver(const QuadMesh& mesh, const TriangleMesh& surface, const Context& context);

    const State& state() const { return state_; }
    void set_state(State state) { state_ = std::move(state); }

    // One step at this weight of planarity. No cell turns over or concave, no side collapses.
    Step step(double weight);

    // The multipliers of the constraint take over what the weight alone can't press flat.
    void raise_pulls(double weight);

    // Distance between diagonals over their mean length, of the worst cell and on average.
    struct Bend {
        double largest = 0.0;
        double mean = 0.0;
    };
    Bend bend() const { return bend_of_cells(state_.vertices); }
    Bend bend_of_cells(const std::vector<Eigen::Vector3d>& vertices) const;

    // How many cells are more bent than that.
    std::size_t cells_over(double bound) const;

    // Whether no cell of `vertices` is worse folded or squashed than allowed, those of the start
    // that were so from the beginning excepted.
    bool is_sound(const std::vector<Eigen::Vector3d>& vertices) const;

private:
    // The equations of one cell, and its energy.
    struct CellPart {
        Eigen::Matrix<double, 12, 12> block;
        Eigen::Matrix<double, 12, 1> gradient;
        double energy = 0.0;
    };
    CellCorners corners_of(std::size_t cell, const std::vector<Eigen::Vector3d>& vertices) const;
    void assemble(double weight);
    std::vector<Eigen::Vector3d> safe_steps();
    bool shorten_spoiling(std::vector<Eigen::Vector3d>& steps, int attempt);
    std::vector<char> spoiled(const std::vector<Eigen::Vector3d>& vertices) const;
    std::vector<double> cell_energies(const std::vector<Eigen::Vector3d>& vertices,
                                      double weight) const;
    double anchor_energy(const std::vector<Eigen::Vector3d>& vertices) const;
    void damp_where_bent(const std::vector<Eigen::Vector3d>& steps,
                         const std::vector<double>& energies);
    void damp_cell(std::size_t cell);
    void firm_up_weak_cells();
    CellWishes wishes_of(std::size_t cell, double weight) const {
        return {.planarity = weight, .pull = state_.pull[cell], .firmness = state_.firmness[cell]};
    }
    void relax_damping();

    const QuadMesh& mesh_;
    const Context& context_;
    PlanarAnchors anchors_;
    std::vector<CellCorners> start_;
    State state_;
    CellBlocks blocks_;
    std::vector<CellPart> parts_;
    Eigen::VectorXd gradient_;
    std::vector<double> damping_;  // Per vertex, against its size.
    std::optional<SparseSolver> factor_;
    double longest_ = 0.0;
};

}  // namespace leafcutter::geometry
