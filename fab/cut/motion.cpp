#include "fab/cut/motion.h"

#include <algorithm>
#include <utility>

#include "fab/cut/path_walk.h"

namespace leafcutter::fab {

namespace {

// Half the last digit of a program: a move shorter than this is no move.
constexpr double kNoMoveMm = 5e-4;

class MotionList {
public:
    MotionList(const CutProgram& program, const MachineProfile& machine)
        : program_(program), machine_(machine) {}

    void add(const CutPath& path) {
        const LaserSettings& settings = settings_of(program_, path);
        const bool closed = path.points.front() == path.points.back();
        const std::vector<Polyline> runs = burnt_runs(path);
        go_to(path.lead_in.value_or(path.points.front()));
        if (path.lead_in) {
            burn({*path.lead_in, path.points.front()}, settings);
        }
        for (int pass = 0; pass < std::max(1, settings.passes); ++pass) {
            const bool backward = !closed && pass % 2 == 1;
            for (std::size_t i = 0; i < runs.size(); ++i) {
                Polyline run = runs[backward ? runs.size() - 1 - i : i];
                if (backward) {
                    std::reverse(run.begin(), run.end());
                }
                go_to(run.front());
                burn(run, settings);
            }
        }
        if (closed && path.over_cut_mm > 0.0) {
            burn(stretch(path.points, 0.0, path.over_cut_mm), settings);
        }
    }

    void go_to(const Eigen::Vector2d& to) {
        if ((to - at_).norm() > kNoMoveMm) {
            moves_.push_back({to, machine_.rapid_mm_per_min, 0.0, false});
            at_ = to;
        }
    }

    std::vector<Motion> take() { return std::move(moves_); }

private:
    void burn(const Polyline& run, const LaserSettings& settings) {
        for (std::size_t i = 1; i < run.size(); ++i) {
            moves_.push_back({run[i], settings.feed_mm_per_min, settings.power_percent, true});
        }
        at_ = run.back();
    }

    const CutProgram& program_;
    const MachineProfile& machine_;
    Eigen::Vector2d at_ = Eigen::Vector2d::Zero();
    std::vector<Motion> moves_;
};

}  // namespace

const LaserSettings& settings_of(const CutProgram& program, const CutPath& path) {
    if (path.settings) {
        return *path.settings;
    }
    switch (path.operation) {
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
    MotionList list(program, machine);
    for (const CutPath& path : program.paths) {
        if (path.points.size() > 1) {
            list.add(path);
        }
    }
    list.go_to(Eigen::Vector2d::Zero());
    return list.take();
}

}  // namespace leafcutter::fab
