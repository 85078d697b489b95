#include "fab/guide/step_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "fab/guide/wording.h"

namespace leafcutter::fab::guide {

namespace {

bool lays(const AssemblyMove& move) {
    return move.kind == MoveKind::Lay || move.kind == MoveKind::Thread;
}

class StepWriter {
public:
    StepWriter(const JobIndex& index, const PlannedStep& step)
        : index_(index), job_(index.job()), step_(step) {}

    StepText write() const {
        switch (step_.kind) {
            case StepKind::TableJoints:
                return table_joints();
            case StepKind::Base:
                return base();
            case StepKind::Weave:
                return step_.strips.size() == 1 ? weave_one() : weave_many();
            case StepKind::Joints:
                break;
        }
        return joints();
    }

private:
    const AssemblyMove& move(int number) const {
        return job_.assembly.moves[static_cast<std::size_t>(number)];
    }
    const Strip& strip(int number) const { return job_.strips[static_cast<std::size_t>(number)]; }
    bool slots() const { return job_.params.fit.joint == Joint::Slot; }

    std::vector<std::string> ids_of(const std::vector<int>& strips) const {
        std::vector<std::string> ids;
        for (const int number : strips) {
            ids.push_back(strip(number).id);
        }
        return ids;
    }

    StepText table_joints() const {
        std::vector<std::string> strips;
        for (const int number : step_.moves) {
            const std::string& id = strip(move(number).strip).id;
            if (strips.empty() || strips.back() != id) {
                strips.push_back(id);
            }
        }
        return {fmt::format("Join the pieces of {}", id_ranges(strips)),
                {slots() ? "On the table, before they are woven: put each tab through the slit of "
                           "the next piece. All arrows of a strip point the same way."
                         : "On the table, before they are woven: glue each tab under the start of "
                           "the next piece, edge to edge. All arrows of a strip point the same "
                           "way."}};
    }

    StepText base() const {
        const std::vector<std::string> ids = ids_of(step_.strips);
        if (ids.size() == 1) {
            return {fmt::format("Lay {}", ids.front()), {"Writing up. It crosses nothing yet."}};
        }
        StepText text{fmt::format("Lay {} side by side", id_ranges(ids)),
                      {"Writing up, all arrows the same way, in this order from left to right. A "
                       "piece of tape across one end holds them together."}};
        const Strip& first = strip(step_.strips.front());
        const Strip& last = strip(step_.strips.back());
        if (are_beside(first, last) && ids.size() > 2) {
            text.texts.push_back(fmt::format(
                "Later, when the rings close, {} comes to lie beside {}.", last.id, first.id));
        }
        return text;
    }

    bool are_beside(const Strip& one, const Strip& other) const {
        for (const geometry::QuadSide& side :
             index_.neighbours().across[static_cast<std::size_t>(one.quads.front())]) {
            if (side.quad >= 0 && index_.strip_at(side.quad, one.family) >= 0 &&
                strip(index_.strip_at(side.quad, one.family)).id == other.id) {
                return true;
            }
        }
        return false;
    }

    std::string way_of(const AssemblyMove& laid) const {
        std::vector<int> cells = laid.cells;
        std::sort(cells.begin(), cells.end());
        const std::vector<Crossing>& crossings =
            job_.crossings[static_cast<std::size_t>(laid.strip)];
        std::vector<NamedCrossing> way;
        for (const int cell : cells) {
            const Crossing& crossing = crossings[static_cast<std::size_t>(cell)];
            way.push_back({strip(crossing.strip).id, crossing.on_top});
        }
        return crossing_text(way);
    }

    // The strip, or the pieces of it that are laid where that is not all of it.
    std::string name_of(const AssemblyMove& laid) const {
        const Strip& one = strip(laid.strip);
        return laid.pieces.empty() || laid.pieces.size() == one.pieces.size()
                   ? one.id
                   : id_ranges(laid.pieces);
    }

    std::string threading(const AssemblyMove& laid) const {
        if (laid.held.empty()) {
            return {};
        }
        std::vector<std::string> ids;
        for (const int cell : laid.held) {
            ids.push_back(strip(job_.crossings[static_cast<std::size_t>(laid.strip)]
                                              [static_cast<std::size_t>(cell)]
                                                  .strip)
                              .id);
        }
        const bool backwards = laid.cells.size() > 1 && laid.cells.front() > laid.cells.back();
        return fmt::format(
            "Thread it, {} first: push it through lengthwise under {} (ringed), which can't be "
            "folded back here.",
            backwards ? "its start" : "its end", first_of({id_ranges(ids)}, 1));
    }

    std::string joint_text(const AssemblyMove& joint) const {
        const std::string tucked =
            joint.tucked > 0
                ? fmt::format(" Tuck the tab in under {}.",
                              counted(static_cast<std::size_t>(joint.tucked), "crossing strip"))
                : "";
        const std::string what =
            joint.piece == joint.onto
                ? std::string(slots() ? "put its tab through the slit at its own start"
                                      : "glue its tab under its own start")
                : fmt::format("{} {} {} {}", slots() ? "put the tab of" : "glue the tab of",
                              joint.piece, slots() ? "through the slit of" : "under the start of",
                              joint.onto);
        return fmt::format("{}: {}.{}", joint.kind == MoveKind::Close ? "Close the ring" : "Join",
                           what, tucked);
    }

    StepText weave_one() const {
        StepText text;
        for (const int number : step_.moves) {
            const AssemblyMove& one = move(number);
            if (!lays(one)) {
                text.texts.push_back(joint_text(one));
                continue;
            }
            const char* verb = one.held.empty() ? "Weave in" : "Thread";
            text.title = fmt::format("{} {}, {}", verb, name_of(one), index_.place_of(one.strip));
            text.texts.push_back(fmt::format("Along the arrow: {}.", way_of(one)));
            if (const std::string thread = threading(one); !thread.empty()) {
                text.texts.push_back(thread);
            }
        }
        return text;
    }

    StepText weave_many() const {
        StepText text;
        text.title =
            fmt::format("Weave in {}, one after the other", id_ranges(ids_of(step_.strips)));
        for (const int number : step_.moves) {
            const AssemblyMove& one = move(number);
            if (lays(one)) {
                text.texts.push_back(fmt::format("{}, {}: {}.", name_of(one),
                                                 index_.place_of(one.strip), way_of(one)));
                if (const std::string thread = threading(one); !thread.empty()) {
                    text.texts.back() += fmt::format(" {}", thread);
                }
            } else if (text.texts.empty()) {
                text.texts.push_back(joint_text(one));
            } else {
                text.texts.back() += fmt::format(" {}", joint_text(one));
            }
        }
        return text;
    }

    StepText joints() const {
        StepText text;
        if (step_.moves.size() == 1) {
            const AssemblyMove& one = move(step_.moves.front());
            text.title = fmt::format("Join {}", joint_name(one));
            text.texts.push_back(joint_text(one));
            return text;
        }
        const std::string where = step_.region == step_.other_region
                                      ? fmt::format("in region {}", step_.region + 1)
                                      : fmt::format("between regions {} and {}", step_.region + 1,
                                                    step_.other_region + 1);
        text.title = fmt::format("{} {}", counted(step_.moves.size(), "joint"), where);
        text.texts.push_back(slots() ? "Put each tab through the slit of the piece named with it."
                                     : "Glue each tab under the start of the piece named with it.");
        const auto tucked = std::count_if(step_.moves.begin(), step_.moves.end(),
                                          [&](int number) { return move(number).tucked > 0; });
        if (tucked > 0) {
            text.texts.push_back(
                "Where it says \"tuck\", push the tab in between the strips that lie there.");
        }
        return text;
    }

    const JobIndex& index_;
    const JobResult& job_;
    const PlannedStep& step_;
};

}  // namespace

StepText step_text(const JobIndex& index, const PlannedStep& step) {
    return StepWriter(index, step).write();
}

std::string joint_name(const AssemblyMove& move) {
    return move.piece == move.onto ? fmt::format("{} to itself", move.piece)
                                   : fmt::format("{} to {}", move.piece, move.onto);
}

}  // namespace leafcutter::fab::guide
