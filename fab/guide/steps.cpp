#include "fab/guide/steps.h"

#include <algorithm>
#include <tuple>

namespace leafcutter::fab::guide {

namespace {

constexpr std::size_t kMostTableJoints = 36;
constexpr std::size_t kMostJoints = 18;
constexpr std::size_t kMostBase = 60;

bool lays(const AssemblyMove& move) {
    return move.kind == MoveKind::Lay || move.kind == MoveKind::Thread;
}

// How many moves go into one step.
struct GroupSizes {
    std::size_t weave = 1;
    std::size_t joints = kMostJoints;
};

class StepPlanner {
public:
    StepPlanner(const JobIndex& index, const GroupSizes& sizes)
        : index_(index), moves_(index.job().assembly.moves), sizes_(sizes) {}

    std::vector<PlannedStep> plan() {
        for (std::size_t begin = 0; begin < moves_.size();) {
            std::size_t end = begin;
            while (end < moves_.size() && moves_[end].region == moves_[begin].region) {
                ++end;
            }
            add_table_joints(begin, end);
            for (std::size_t i = begin; i < end; ++i) {
                add(i);
            }
            begin = end;
        }
        return std::move(steps_);
    }

private:
    static bool on_table(const AssemblyMove& move) { return !lays(move) && !move.in_place; }

    void add_table_joints(std::size_t begin, std::size_t end) {
        bool is_first = true;
        for (std::size_t i = begin; i < end; ++i) {
            if (!on_table(moves_[i])) {
                continue;
            }
            if (is_first || steps_.back().moves.size() >= kMostTableJoints) {
                start(StepKind::TableJoints, moves_[i]);
            }
            is_first = false;
            steps_.back().moves.push_back(static_cast<int>(i));
        }
    }

    void start(StepKind kind, const AssemblyMove& move) {
        PlannedStep step;
        step.kind = kind;
        step.region = step.other_region = move.region;
        steps_.push_back(std::move(step));
        weaves_ = 0;
    }

    bool goes_on(StepKind kind, const AssemblyMove& move) const {
        return !steps_.empty() && steps_.back().kind == kind && steps_.back().region == move.region;
    }

    void add(std::size_t number) {
        const AssemblyMove& move = moves_[number];
        if (on_table(move)) {
            return;
        }
        if (!lays(move)) {
            add_joint(move);
        } else if (move.cells.empty()) {
            if (!goes_on(StepKind::Base, move) || steps_.back().strips.size() >= kMostBase) {
                start(StepKind::Base, move);
            }
            steps_.back().strips.push_back(move.strip);
        } else {
            if (!goes_on(StepKind::Weave, move) || weaves_ >= sizes_.weave ||
                !same_family(steps_.back().strips.back(), move.strip)) {
                start(StepKind::Weave, move);
            }
            steps_.back().strips.push_back(move.strip);
            ++weaves_;
        }
        steps_.back().moves.push_back(static_cast<int>(number));
    }

    bool same_family(int one, int other) const {
        const std::vector<Strip>& strips = index_.job().strips;
        return strips[static_cast<std::size_t>(one)].family ==
               strips[static_cast<std::size_t>(other)].family;
    }

    // Joints of the strip just woven belong to its step.
    void add_joint(const AssemblyMove& move) {
        const bool of_last = goes_on(StepKind::Weave, move) &&
                             std::find(steps_.back().strips.begin(), steps_.back().strips.end(),
                                       move.strip) != steps_.back().strips.end();
        const auto [one, other] = regions_of(move);
        if (of_last && one == other) {
            return;
        }
        const bool same = !steps_.empty() && steps_.back().kind == StepKind::Joints &&
                          steps_.back().region == one && steps_.back().other_region == other;
        if (!same || steps_.back().moves.size() >= sizes_.joints) {
            start(StepKind::Joints, move);
            steps_.back().region = one;
            steps_.back().other_region = other;
        }
    }

    // The regions on both sides of a joint, the lower number first.
    std::pair<int, int> regions_of(const AssemblyMove& move) const {
        const Piece* piece = index_.piece(move.piece);
        const Piece* onto = index_.piece(move.onto);
        int one = move.region;
        int other = move.region;
        if (piece != nullptr && piece->cell_count > 0) {
            one = index_.region_of(index_.quads_of(*piece).back());
        }
        if (onto != nullptr && onto->cell_count > 0) {
            other = index_.region_of(index_.quads_of(*onto).front());
        }
        one = one < 0 ? move.region : one;
        other = other < 0 ? move.region : other;
        return {std::min(one, other), std::max(one, other)};
    }

    const JobIndex& index_;
    const std::vector<AssemblyMove>& moves_;
    GroupSizes sizes_;
    std::vector<PlannedStep> steps_;
    std::size_t weaves_ = 0;  // In the last step.
};

}  // namespace

std::vector<PlannedStep> plan_steps(const JobIndex& index, std::size_t most) {
    constexpr std::size_t kMostWeaves = 6;
    std::vector<PlannedStep> steps;
    for (std::size_t weave = 1; weave <= kMostWeaves; ++weave) {
        steps = StepPlanner(index, {weave, kMostJoints + 6 * (weave - 1)}).plan();
        if (steps.size() <= most) {
            break;
        }
    }
    return steps;
}

}  // namespace leafcutter::fab::guide
