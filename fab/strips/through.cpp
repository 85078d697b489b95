#include "fab/strips/through.h"

#include <cmath>

#include "fab/strips/joints.h"
#include "fab/strips/overlap.h"
#include "fab/strips/parting_plan.h"
#include "fab/strips/sheet_fit.h"
#include "fab/strips/unfold.h"

namespace leafcutter::fab {

namespace {

// Evenly long strips against those that end at kinks of up to 60 degrees.
constexpr double kEvenness = 0.5;
constexpr double kKinkDeg = 60.0;

// A thread as the sections between its leaves.
class Sections {
public:
    Sections(const geometry::QuadMesh& mesh,
             const geometry::Thread& thread,
             const ThroughLimits& limits)
        : mesh_(mesh), limits_(limits), closed_(thread.closed), firsts_(thread.leaves) {
        if (!closed_) {
            firsts_.insert(firsts_.begin(), 0);
        }
        Strip strip;
        strip.family = thread.family;
        strip.closed = thread.closed;
        strip.quads = thread.quads;
        cells_ = walk_cells(mesh, strip);
        measure();
    }

    int count() const { return static_cast<int>(firsts_.size()); }
    int first_quad(int section) const { return firsts_[static_cast<std::size_t>(section)]; }

    PartingProblem problem() const {
        PartingProblem problem;
        problem.cells = count();
        problem.closed = closed_;
        problem.evenness = kEvenness;
        for (int i = 0; i < count(); ++i) {
            problem.length.push_back(length({i, 1}));
            const auto rung = static_cast<std::size_t>(first_quad(i) > 0 ? first_quad(i) : total());
            problem.joint_cost.push_back(1.0 - turns_[rung] / kKinkDeg);
        }
        problem.good = [this](int first, int count) { return is_good({first, count}); };
        return problem;
    }

    bool is_good(const CellRun& sections) const {
        const CellRun run = cells_of(sections);
        if (length(sections) > limits_.max_length_mm || turning(run) > limits_.max_turning_deg) {
            return false;
        }
        const Unfolded flat = unfold(mesh_, cells_, run);
        Ring ring(flat.right);
        ring.insert(ring.end(), flat.left.rbegin(), flat.left.rend());
        const Ring outline = snapped(ring);
        return fits_sheet(outline, limits_.usable_sheet, limits_.rotation) && is_simple(outline) &&
               keeps_gap(outline, limits_.self_gap_mm);
    }

private:
    int total() const { return static_cast<int>(cells_.size()); }

    CellRun cells_of(const CellRun& sections) const {
        const int behind = sections.first + sections.count;
        int end = total();
        if (behind < count()) {
            end = first_quad(behind);
        } else if (closed_) {
            end = first_quad(behind - count()) + total();
        }
        return {first_quad(sections.first), end - first_quad(sections.first)};
    }

    // Sums along the middle, twice round.
    void measure() {
        const Unfolded flat = unfold(mesh_, cells_, {0, total() + (closed_ ? 1 : 0)});
        const auto n = static_cast<std::size_t>(total());
        length_to_.push_back(0.0);
        turns_.push_back(0.0);
        for (std::size_t i = 0; i < n; ++i) {
            const Eigen::Vector2d step =
                (flat.left[i + 1] + flat.right[i + 1] - flat.left[i] - flat.right[i]) / 2.0;
            length_to_.push_back(length_to_.back() + step.norm());
            turns_.push_back(std::abs(turning_deg(flat, i + 1)));
        }
        turning_to_.push_back(0.0);
        for (std::size_t i = 0; i < 2 * n; ++i) {
            turning_to_.push_back(turning_to_.back() + turns_[i % n + 1]);
            if (i >= n) {
                length_to_.push_back(length_to_[i] + length_to_[i - n + 1] - length_to_[i - n]);
            }
        }
    }

    double length(const CellRun& sections) const {
        const CellRun run = cells_of(sections);
        const auto from = static_cast<std::size_t>(run.first);
        return length_to_[from + static_cast<std::size_t>(run.count)] - length_to_[from];
    }

    // Between the cells of a run.
    double turning(const CellRun& run) const {
        const auto from = static_cast<std::size_t>(run.first);
        return run.count < 2 ? 0.0
                             : turning_to_[from + static_cast<std::size_t>(run.count) - 1] -
                                   turning_to_[from];
    }

    const geometry::QuadMesh& mesh_;
    const ThroughLimits& limits_;
    bool closed_;
    std::vector<int> firsts_;  // Places of the sections' first quads.
    std::vector<WalkedCell> cells_;
    std::vector<double> turns_;       // Degrees at each rung.
    std::vector<double> length_to_;   // Before each cell,
    std::vector<double> turning_to_;  // and up to the rung before it.
};

}  // namespace

std::vector<geometry::Thread> parted_at_leaves(const geometry::QuadMesh& mesh,
                                               geometry::Thread thread,
                                               const ThroughLimits& limits) {
    if (thread.leaves.empty()) {
        return {std::move(thread)};
    }
    std::vector<int> firsts;
    {
        const Sections sections(mesh, thread, limits);
        const std::vector<int> parts = plan_parting(sections.problem());
        if (parts.size() == 1 && sections.is_good({parts[0], sections.count()})) {
            return {std::move(thread)};
        }
        for (const int part : parts) {
            if (thread.closed || part > 0) {
                firsts.push_back(sections.first_quad(part));
            }
        }
    }
    return geometry::parted(std::move(thread), firsts);
}

}  // namespace leafcutter::fab
