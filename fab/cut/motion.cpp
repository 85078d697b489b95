#include "fab/cut/motion.h"

#include <algorithm>

namespace leafcutter::fab {

namespace {

// Half the last digit of a program: a move shorter than this is no move.
constexpr double kNoMoveMm = 5e-4;

void add_pass(const CutPath& path,
              const LaserSettings& settings,
              bool backward,
              std::vector<Motion>& out) {
    const std::size_t count = path.points.size();
    for (std::size_t i = 1; i < count; ++i) {
        const Eigen::Vector2d& to = path.points[backward ? count - 1 - i : i];
        out.push_back({to, settings.feed_mm_per_min, true, path.operation});
    }
}

}  // namespace

const LaserSettings& settings_of(const CutProgram& program, Operation operation) {
    switch (operation) {
        case Operation::Engrave:
            return program.engrave;
        case Operation::Score:
            return program.score;
        case Operation::Cut:
            break;
    }
    return program.cut;
}

std::vector<Motion> motions(const CutProgram& program, const MachineProfile& machine) {
    std::vector<Motion> out;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    for (const CutPath& path : program.paths) {
        if (path.points.size() < 2) {
            continue;
        }
        if ((path.points.front() - at).norm() > kNoMoveMm) {
            out.push_back({path.points.front(), machine.rapid_mm_per_min, false, path.operation});
        }
        const LaserSettings& settings = settings_of(program, path.operation);
        const bool closed = path.points.front() == path.points.back();
        for (int pass = 0; pass < std::max(1, settings.passes); ++pass) {
            add_pass(path, settings, !closed && pass % 2 == 1, out);
        }
        at = out.back().to;
    }
    if (at.norm() > kNoMoveMm) {
        out.push_back({Eigen::Vector2d::Zero(), machine.rapid_mm_per_min, false, Operation::Cut});
    }
    return out;
}

}  // namespace leafcutter::fab
