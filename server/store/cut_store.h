// Cuts in the queues of their devices. Every change is a compare-and-set on the state, on disk when
// the call returns, with its event.

#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class Database;

struct CutProgress {
    std::int64_t lines_total = 0;
    std::int64_t lines_sent = 0;
    std::int64_t lines_acknowledged = 0;
    double burnt_mm = 0.0;  // Of a cut in work; not kept.
    double burn_mm = 0.0;
};

// The job can't be cut as wanted: not computed yet, or it has no such sheet.
class NotCuttable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class CutStore {
public:
    explicit CutStore(Database& database) : database_(database) {}

    // Without `sheets`: those of the job not cut yet, or all if every one is. Throws NotCuttable.
    CutRecord add(const std::string& job, const std::string& device, std::vector<int> sheets);

    std::optional<CutRecord> find(const std::string& id) const;

    // Newest first.
    std::vector<CutRecord> list(int limit) const;

    // The cuts of a device that are not over, in the order of its queue.
    std::vector<CutRecord> open_on(const std::string& device) const;

    // False if the cut is no longer in `from`. Throws std::logic_error if the table of states
    // forbids the move.
    bool move(const std::string& id, CutState from, CutState to, const std::string& reason = {});

    // Waiting or awaiting a sheet -> armed, unless another cut occupies the device. The program
    // must be that of the current sheet.
    bool arm(const CutRecord& cut);

    // Armed -> cutting, with the intent to fire on disk: only after this may the beam come on.
    bool begin_sheet(const CutRecord& cut);

    // Cutting or paused -> awaiting the next sheet, or done; the sheet counts as cut, and the job
    // as done when all its sheets are.
    bool finish_sheet(const CutRecord& cut, const CutProgress& progress);

    // How far the beam got; no event.
    void record_progress(const std::string& id, const CutProgress& progress);

    // How far the beam of a cut that is over got.
    void record_beam(const std::string& id, const BeamRecord& beam);

    // It ended early, and its rest is in nobody's hands.
    bool may_be_finished(const CutRecord& cut) const;

    // A waiting cut of the rest: of the current sheet by that program, of the others whole. Nothing
    // if something else happened to `of` since it was read.
    std::optional<CutRecord> add_rest(const CutRecord& of, const std::string& program_sha256);

    // The cut that last had the beam of a device.
    std::optional<CutRecord> last_begun_on(const std::string& device) const;

    std::int64_t count(CutState state) const;

    // At start: armed cuts are disarmed, cuts in mid-beam are interrupted. Returns the devices of
    // the latter.
    std::vector<std::string> recover();

private:
    Database& database_;
};

}  // namespace leafcutter::server
