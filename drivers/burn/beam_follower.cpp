#include "drivers/burn/beam_follower.h"

#include <algorithm>
#include <utility>

namespace leafcutter::drivers {

namespace {

using Kind = JournalRecord::Kind;

// Of what may be on the wire without being known to be: short lines go together, a long one alone.
// More where the beam is fast, or the stream would wait for the disk.
constexpr double kAheadMm = 0.5;
constexpr double kAheadSeconds = 0.04;
constexpr double kAstrayMm = 1.0;

Point work_position(const DeviceStatus& status) {
    return {status.work_position_mm[0], status.work_position_mm[1]};
}

TrackerOptions with_planner(std::size_t blocks) {
    TrackerOptions options;
    options.planner_blocks = blocks;
    return options;
}

}  // namespace

BeamFollower::BeamFollower(std::shared_ptr<const BeamPath> path,
                           std::shared_ptr<JournalSink> sink,
                           Clock clock,
                           std::size_t planner_blocks)
    : path_(std::move(path)),
      sink_(std::move(sink)),
      clock_(std::move(clock)),
      tracker_(*path_, with_planner(planner_blocks)) {}

std::size_t BeamFollower::lines_allowed(const JobProgress& progress, const DeviceStatus& status) {
    if (progress.outcome == JobOutcome::Running) {
        observe(progress, status);
        reserve(progress.lines_sent);
    }
    return sink_->lines_on_disk();
}

void BeamFollower::observe(const JobProgress& progress, const DeviceStatus& status) {
    const double now = clock_();
    if (progress.lines_sent != sent_) {
        sent_ = progress.lines_sent;
        sink_->note({.kind = Kind::Sent, .lines = sent_, .t_s = now});
        tracker_.sent(sent_);
    }
    if (progress.lines_acknowledged != acknowledged_) {
        acknowledged_ = progress.lines_acknowledged;
        sink_->note({.kind = Kind::Acknowledged, .lines = acknowledged_, .t_s = now});
        tracker_.acknowledged(acknowledged_, now);
    }
    if (status.reports != std::exchange(reports_, status.reports) && reports_known_) {
        sink_->note({.kind = Kind::Position, .t_s = now, .at_mm = work_position(status)});
        tracker_.sent(reserved_);
        const bool there = tracker_.position(work_position(status), now) ||
                           tracker_.near(work_position(status), kAstrayMm);
        astray_ = there ? 0 : astray_ + 1;
    }
    if (!reports_known_) {
        restarts_ = status.restarts;
    }
    reports_known_ = true;  // The first one seen is older than the program.
    burnt_mm_ = path_->burnt_at(tracker_.heard().likely_mm);
}

void BeamFollower::reserve(std::size_t sent) {
    const std::size_t safe = sink_->lines_on_disk();
    if (reserved_ > safe || reserved_ >= path_->lines()) {
        return;  // Asked for already, or nothing is left.
    }
    const double feed = path_->feed_after(sent) / 60.0;
    const double most = path_->burnt_after(sent) + std::max(kAheadMm, kAheadSeconds * feed);
    std::size_t wanted = reserved_;
    while (wanted < path_->lines() && path_->burnt_after(wanted + 1) <= most) {
        ++wanted;
    }
    if (wanted == reserved_ && sent >= reserved_) {
        ++wanted;
    }
    if (wanted > reserved_) {
        reserved_ = wanted;
        sink_->note({.kind = Kind::May, .lines = wanted, .t_s = clock_()});
    }
}

BeamEnd BeamFollower::end(const JobProgress& progress, const DeviceStatus& status) {
    const Point at = work_position(status);
    BeamEnd how = BeamEnd::Silent;
    if (progress.outcome != JobOutcome::LinkLost && status.state != MachineState::Disconnected) {
        tracker_.sent(reserved_);
        // A controller that restarted takes the place where it stands for its zero.
        const bool at_zero = status.machine_position_mm == std::array<double, 3>{};
        const bool fresh = (at_zero && tracker_.heard().least_mm > 1.0) ||
                           (reports_known_ && status.restarts != restarts_);
        const bool locked = status.state == MachineState::Alarm;
        const bool on_path = status.reports > 0 && !fresh && tracker_.stands(at);
        how = !on_path ? BeamEnd::Restarted : locked ? BeamEnd::Stopped : BeamEnd::Stands;
    }
    sink_->note({.kind = Kind::End, .t_s = clock_(), .at_mm = at, .end = how});
    burnt_mm_ = path_->burnt_at(tracker_.heard().likely_mm);
    return how;
}

}  // namespace leafcutter::drivers
