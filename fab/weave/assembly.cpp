#include "fab/weave/assembly.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "fab/weave/assembly_regions.h"
#include "fab/weave/joints.h"
#include "fab/weave/lay_order.h"

namespace leafcutter::fab {

namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

enum class JointState { Apart, OnTable, InPlace };

// What lies where by now, and where strips can still be folded back.
class Bench {
public:
    Bench(std::span<const Strip> strips, std::span<const Piece> pieces, const Crossings& crossings)
        : strips_(strips),
          pieces_(pieces),
          crossings_(crossings),
          joints_(joints_of(strips, pieces)),
          state_(joints_.size(), JointState::Apart),
          joint_before_(strips.size()),
          start_joined_(strips.size(), 0),
          end_joined_(strips.size(), 0),
          placed_(strips.size(), 0) {
        for (std::size_t i = 0; i < strips.size(); ++i) {
            joint_before_[i].assign(strips[i].quads.size(), -1);
        }
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            if (joints_[i].before >= 0) {
                joint_before_[at(joints_[i].strip)][at(joints_[i].before)] = static_cast<int>(i);
            }
        }
    }

    const std::vector<StripJoint>& joints() const { return joints_; }
    bool is_placed(int strip) const { return placed_[at(strip)] != 0; }
    void place(int strip) { placed_[at(strip)] = 1; }
    JointState state(int joint) const { return state_[at(joint)]; }

    void join(int number, JointState how) {
        const StripJoint& joint = joints_[at(number)];
        state_[at(number)] = how;
        if (joint.before < 0) {
            end_joined_[at(joint.strip)] = 1;
            start_joined_[at(joint.onto_strip)] = 1;
        }
    }

    // Crossing strips under which the tab of this joint has to be pushed, made now.
    int tucked(const StripJoint& joint) const {
        const Piece& onto = pieces_[at(joint.onto)];
        const auto& crossings = crossings_[at(joint.onto_strip)];
        const int cells = cells_under_tab(joint, pieces_);
        int count = 0;
        for (int i = 0; i < cells; ++i) {
            const auto cell = (at(onto.first_cell) + at(i)) % crossings.size();
            const Crossing& crossing = crossings[cell];
            const bool above = !crossing.on_top && is_placed(crossing.strip);
            count += above && !folds_back(crossing.strip, crossing.cell) ? 1 : 0;
        }
        return count;
    }

private:
    bool folds_back(int strip, int cell) const {
        return is_free(strip, cell, 1) || is_free(strip, cell, -1);
    }

    // Whether from the cell on that way to an end nothing holds the strip.
    bool is_free(int strip, int cell, int way) const {
        const int count = static_cast<int>(strips_[at(strip)].quads.size());
        for (int i = 0; i < count; ++i) {
            const int joint = joint_before_[at(strip)][at(way > 0 ? (cell + 1) % count : cell)];
            if (joint >= 0 && state(joint) != JointState::OnTable) {
                return state(joint) == JointState::Apart;
            }
            cell += way;
            if (cell < 0 || cell == count) {
                if (!strips_[at(strip)].closed) {
                    return (way > 0 ? end_joined_ : start_joined_)[at(strip)] == 0;
                }
                cell = (cell + count) % count;
            }
            const Crossing& crossing = crossings_[at(strip)][at(cell)];
            if (!crossing.on_top && is_placed(crossing.strip)) {
                return false;
            }
        }
        return false;
    }

    std::span<const Strip> strips_;
    std::span<const Piece> pieces_;
    const Crossings& crossings_;
    std::vector<StripJoint> joints_;
    std::vector<JointState> state_;               // Per joint.
    std::vector<std::vector<int>> joint_before_;  // Per strip and cell; -1: none.
    std::vector<char> start_joined_;              // Per strip: to another one.
    std::vector<char> end_joined_;
    std::vector<char> placed_;
};

class Planner {
public:
    Planner(std::span<const Strip> strips,
            std::span<const Piece> pieces,
            const Crossings& crossings)
        : strips_(strips),
          pieces_(pieces),
          crossings_(crossings),
          bench_(strips, pieces, crossings),
          own_(pieces_of_strips(strips, pieces)),
          joints_of_strip_(strips.size()),
          cells_apart_(strips.size()) {
        const std::vector<StripJoint>& joints = bench_.joints();
        for (std::size_t i = 0; i < joints.size(); ++i) {
            if (joints[i].before >= 0) {
                joints_of_strip_[at(joints[i].strip)].push_back(static_cast<int>(i));
                cells_apart_[at(joints[i].strip)].push_back(joints[i].before);
            }
        }
        for (std::vector<int>& cells : cells_apart_) {
            std::sort(cells.begin(), cells.end());
        }
    }

    Assembly run(std::vector<AssemblyRegion> regions, const geometry::QuadMesh& mesh) {
        plan_.regions = std::move(regions);
        const auto members = members_of(plan_.regions, mesh, strips_);
        region_.resize(strips_.size());
        for (std::size_t i = 0; i < members.size(); ++i) {
            for (const int strip : members[i]) {
                region_[at(strip)] = static_cast<int>(i);
            }
        }
        for (std::size_t i = 0; i < members.size(); ++i) {
            weave_region(i, members[i]);
        }
        join_strips();
        glue_rims();
        return std::move(plan_);
    }

private:
    // The warp lies first, unless that takes more threading, or the weft lies below everywhere.
    LayOrder best_order(std::span<const int> members) const {
        const LayProblem problem{strips_, crossings_, cells_apart_};
        LayOrder warp = find_lay_order(problem, members, Family::Warp);
        const bool weft_below = std::all_of(members.begin(), members.end(), [&](int strip) {
            const auto& crossings = crossings_[at(strip)];
            return strips_[at(strip)].family == Family::Weft ||
                   std::all_of(crossings.begin(), crossings.end(),
                               [](const Crossing& crossing) { return crossing.on_top; });
        });
        if (warp.threaded_crossings == 0 && !weft_below) {
            return warp;
        }
        LayOrder weft = find_lay_order(problem, members, Family::Weft);
        const auto effort = [](const LayOrder& order) {
            return std::tuple(order.threaded_crossings, order.longest_thread);
        };
        return weft_below || effort(weft) < effort(warp) ? weft : warp;
    }

    void weave_region(std::size_t region, std::span<const int> members) {
        LayOrder order = best_order(members);
        plan_.regions[region].base = order.base;
        std::vector<int> base;  // In the order in which they are laid.
        for (WovenIn& woven : order.woven) {
            for (const int cell : woven.cells) {
                const int strip = crossings_[at(woven.strip)][at(cell)].strip;
                if (!bench_.is_placed(strip)) {
                    lay_base(strip, order.open_joints[at(strip)]);
                    base.push_back(strip);
                }
            }
            weave_in(woven);
        }
        for (const int strip : base) {
            join_open(strip);
        }
    }

    void add_joint(int number, MoveKind kind, JointState how) {
        const StripJoint& joint = bench_.joints()[at(number)];
        AssemblyMove move;
        move.kind = kind;
        move.region = region_[at(joint.strip)];
        move.strip = joint.strip;
        move.piece = pieces_[at(joint.piece)].id;
        move.onto = pieces_[at(joint.onto)].id;
        if (how == JointState::InPlace) {
            move.in_place = true;
            move.tucked = bench_.tucked(joint);
            plan_.tucked_joints += move.tucked > 0 ? 1 : 0;
        }
        ++(move.in_place ? plan_.place_joints : plan_.table_joints);
        plan_.moves.push_back(std::move(move));
        bench_.join(number, how);
    }

    // All but those that stay open for now.
    void join_on_table(int strip, const std::vector<int>& open) {
        for (const int joint : joints_of_strip_[at(strip)]) {
            const int before = bench_.joints()[at(joint)].before;
            if (std::find(open.begin(), open.end(), before) == open.end()) {
                add_joint(joint, MoveKind::Join, JointState::OnTable);
            }
        }
    }

    // Pieces from one open joint to the next.
    std::vector<std::vector<int>> runs_of(int strip, const std::vector<int>& open) const {
        std::vector<std::vector<int>> runs;
        std::vector<int> wrapped;  // Of a closed strip: pieces that follow its last ones.
        for (const int piece : own_[at(strip)]) {
            const int cell = pieces_[at(piece)].first_cell;
            const bool begins = !strips_[at(strip)].closed && piece == own_[at(strip)].front();
            if (begins || std::find(open.begin(), open.end(), cell) != open.end()) {
                runs.emplace_back();
            }
            (runs.empty() ? wrapped : runs.back()).push_back(piece);
        }
        if (!wrapped.empty()) {
            runs.back().insert(runs.back().end(), wrapped.begin(), wrapped.end());
        }
        return runs;
    }

    AssemblyMove laying(int strip, const std::vector<int>& run) {
        AssemblyMove move;
        move.region = region_[at(strip)];
        move.strip = strip;
        for (const int piece : run) {
            move.pieces.push_back(pieces_[at(piece)].id);
        }
        bench_.place(strip);
        return move;
    }

    // Nothing that crosses it is there yet.
    void lay_base(int strip, const std::vector<int>& open) {
        join_on_table(strip, open);
        for (const std::vector<int>& run : runs_of(strip, open)) {
            plan_.moves.push_back(laying(strip, run));
            ++plan_.laid;
        }
        const auto& crossings = crossings_[at(strip)];
        if (std::none_of(crossings.begin(), crossings.end(),
                         [](const Crossing& crossing) { return crossing.on_top; })) {
            join_open(strip);  // It never has to be folded back.
        }
    }

    void weave_in(WovenIn& woven) {
        std::vector<int> open;
        if (strips_[at(woven.strip)].closed) {
            open.push_back(cells_apart_[at(woven.strip)].front());
        }
        join_on_table(woven.strip, open);
        AssemblyMove move = laying(woven.strip, runs_of(woven.strip, open).front());
        const int held = static_cast<int>(woven.held.size());
        move.kind = held == 0 ? MoveKind::Lay : MoveKind::Thread;
        move.cells = std::move(woven.cells);
        move.held = std::move(woven.held);
        plan_.moves.push_back(std::move(move));
        ++(held == 0 ? plan_.laid : plan_.threaded);
        plan_.threaded_crossings += held;
        plan_.longest_thread = std::max(plan_.longest_thread, held);
        join_open(woven.strip);
    }

    void join_open(int strip) {
        std::vector<int> open;
        for (const int joint : joints_of_strip_[at(strip)]) {
            if (bench_.state(joint) == JointState::Apart) {
                open.push_back(joint);
            }
        }
        for (const int joint : open) {
            const bool closes = strips_[at(strip)].closed && joint == open.back();
            add_joint(joint, closes ? MoveKind::Close : MoveKind::Join, JointState::InPlace);
        }
    }

    // Of strips with those behind a critical leaf: border after border, along it.
    void join_strips() {
        std::vector<std::tuple<int, int, int>> order;  // Later region, earlier one, joint.
        for (std::size_t i = 0; i < bench_.joints().size(); ++i) {
            const StripJoint& joint = bench_.joints()[i];
            if (joint.before < 0) {
                const int one = region_[at(joint.strip)];
                const int other = region_[at(joint.onto_strip)];
                order.emplace_back(std::max(one, other), std::min(one, other), static_cast<int>(i));
            }
        }
        std::sort(order.begin(), order.end());
        for (const auto& [later, earlier, joint] : order) {
            add_joint(joint, MoveKind::Join, JointState::InPlace);
        }
    }

    // Ends that are glued to a cylinder beside theirs: rim after rim, region after region.
    void glue_rims() {
        std::vector<std::tuple<int, bool, int>> order;  // Region, end of a strip, strip.
        for (std::size_t i = 0; i < strips_.size(); ++i) {
            const int strip = static_cast<int>(i);
            for (const bool end : {false, true}) {
                if ((end ? strips_[i].glued_end : strips_[i].glued_start).has_tab) {
                    order.emplace_back(region_[i], end, strip);
                }
            }
        }
        std::sort(order.begin(), order.end());
        for (const auto& [region, end, strip] : order) {
            const std::vector<int>& own = own_[at(strip)];
            const Piece& piece = pieces_[at(end ? own.back() : own.front())];
            AssemblyMove move;
            move.kind = MoveKind::Join;
            move.region = region;
            move.strip = strip;
            move.piece = piece.id;
            move.onto = (end ? piece.end_tab : piece.start_tab).onto;
            move.at_start = !end;
            move.in_place = true;
            plan_.moves.push_back(std::move(move));
            ++plan_.place_joints;
        }
    }

    std::span<const Strip> strips_;
    std::span<const Piece> pieces_;
    const Crossings& crossings_;
    Bench bench_;
    std::vector<std::vector<int>> own_;              // Per strip: its pieces in walking order.
    std::vector<std::vector<int>> joints_of_strip_;  // Per strip: those between its own pieces,
    std::vector<std::vector<int>> cells_apart_;      // and the cells behind them, ascending.
    std::vector<int> region_;                        // Per strip.
    Assembly plan_;
};

}  // namespace

Assembly plan_assembly(const geometry::QuadMesh& mesh,
                       std::span<const Strip> strips,
                       std::span<const Piece> pieces,
                       const Crossings& crossings,
                       std::span<const Part> parts) {
    return Planner(strips, pieces, crossings).run(assembly_regions(mesh, strips, parts), mesh);
}

}  // namespace leafcutter::fab
