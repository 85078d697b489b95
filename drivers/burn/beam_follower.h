// Follows the beam while a program runs: keeps its journal, knows how much is burnt, and lets no
// line go that the journal on disk does not have.

#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

#include "drivers/burn/beam_tracker.h"
#include "drivers/burn/journal.h"
#include "drivers/device.h"

namespace leafcutter::drivers {

// Where a journal's records go.
class JournalSink {
public:
    virtual ~JournalSink() = default;

    // Waits for nothing.
    virtual void note(const JournalRecord& record) = 0;

    // The greatest number of lines whose record May is safe.
    virtual std::size_t lines_on_disk() const = 0;
};

class BeamFollower final : public JobWatch {
public:
    using Clock = std::function<double()>;  // Seconds since the journal's beginning.

    BeamFollower(std::shared_ptr<const BeamPath> path,
                 std::shared_ptr<JournalSink> sink,
                 Clock clock,
                 std::size_t planner_blocks = 0);

    std::size_t lines_allowed(const JobProgress& progress, const DeviceStatus& status) override;

    // The program is over, and `status` is what the machine says since. Writes how it ended.
    BeamEnd end(const JobProgress& progress, const DeviceStatus& status);

    // As far as is known now; from any thread.
    double burnt_mm() const { return burnt_mm_.load(); }

    // Reports in a row of a head that is not on the path.
    std::size_t astray() const { return astray_; }

private:
    void reserve(std::size_t sent);
    void observe(const JobProgress& progress, const DeviceStatus& status);

    const std::shared_ptr<const BeamPath> path_;
    const std::shared_ptr<JournalSink> sink_;
    const Clock clock_;
    BeamTracker tracker_;
    std::size_t reserved_ = 0;
    std::size_t sent_ = 0;
    std::size_t acknowledged_ = 0;
    std::size_t reports_ = 0;
    std::size_t restarts_ = 0;
    bool reports_known_ = false;
    std::size_t astray_ = 0;
    std::atomic<double> burnt_mm_{0.0};
};

}  // namespace leafcutter::drivers
