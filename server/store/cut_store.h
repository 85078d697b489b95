// Cuts in the queues of their devices. Every change is a compare-and-set on the state, on disk when
// the call returns, with its event.

#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/store/job_store.h"
#include "server/store/records.h"

namespace leafcutter::server {

struct CutProgress {
    std::int64_t lines_total = 0;
    std::int64_t lines_sent = 0;
    std::int64_t lines_acknowledged = 0;
    double burnt_mm = 0.0;  // Of a cut in work; not kept.
    double burn_mm = 0.0;
};

// Part of a job, for one machine.
struct CutWish {
    std::string device;
    std::vector<int> sheets;  // In order; empty: those not cut yet, or all if every one is.
};

// The job can't be cut as wanted: not computed yet, or it has no such sheet.
class NotCuttable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class CutStore {
public:
    virtual ~CutStore() = default;

    // A waiting cut for each wish, or none at all; those of the earlier request if `key` was used
    // before. Throws NotCuttable, KeyReused.
    virtual std::vector<CutRecord> add(const std::string& job,
                                       const std::vector<CutWish>& wishes,
                                       const std::optional<IdempotencyKey>& key) = 0;
    std::vector<CutRecord> add(const std::string& job, const std::vector<CutWish>& wishes) {
        return add(job, wishes, std::nullopt);
    }

    virtual std::optional<CutRecord> find(const std::string& id) const = 0;

    // Newest first.
    virtual std::vector<CutRecord> list(
        int limit, std::optional<std::int64_t> below_ordinal = std::nullopt) const = 0;

    // The cuts of a device that are not over, in the order of its queue.
    virtual std::vector<CutRecord> open_on(const std::string& device) const = 0;

    // False if the cut is no longer in `from`. Throws std::logic_error if the table of states
    // forbids the move.
    virtual bool move(const std::string& id,
                      CutState from,
                      CutState to,
                      const std::string& reason = {}) = 0;

    // Waiting or awaiting a sheet -> armed, unless another cut occupies the device. The program
    // must be that of the current sheet.
    virtual bool arm(const CutRecord& cut) = 0;

    // Armed -> cutting, with the intent to fire on disk: only after this may the beam come on. In a
    // fleet only for who holds the machine's lease; otherwise the cut is disarmed.
    virtual bool begin_sheet(const CutRecord& cut) = 0;

    // Cutting or paused -> awaiting the next sheet, or done; the sheet counts as cut, and the job
    // as done when all its sheets are.
    virtual bool finish_sheet(const CutRecord& cut, const CutProgress& progress) = 0;

    // How far the beam got; no event.
    virtual void record_progress(const std::string& id, const CutProgress& progress) = 0;

    // How far the beam of a cut that is over got.
    virtual void record_beam(const std::string& id, const BeamRecord& beam) = 0;

    // It ended early, and its rest is in nobody's hands.
    virtual bool may_be_finished(const CutRecord& cut) const = 0;

    // A waiting cut of the rest: of the current sheet by that program, of the others whole. Nothing
    // if something else happened to `of` since it was read.
    virtual std::optional<CutRecord> add_rest(const CutRecord& of,
                                              const std::string& program_sha256) = 0;

    // The cut that last had the beam of a device.
    virtual std::optional<CutRecord> last_begun_on(const std::string& device) const = 0;

    virtual std::int64_t count(CutState state) const = 0;

    // A cut that this station has in work was called interrupted because the station was out of
    // reach: it is in work again, unless somebody began something with its rest.
    virtual bool reclaim(const CutRecord& in_work) = 0;

    // Cutting or paused, begun by this station.
    virtual std::vector<CutRecord> in_hand() const = 0;

    // At start: armed cuts are disarmed, cuts in mid-beam are interrupted. Returns the devices of
    // the latter.
    virtual std::vector<std::string> recover() = 0;
};

}  // namespace leafcutter::server
