// The append-only log of what happened to jobs and cuts. A row is written in the transaction of the
// change it tells of, so the numbers have no gaps; old ones may be let go from the front.

#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class EventLog {
public:
    virtual ~EventLog() = default;

    // Of the oldest and the newest one kept; 0 and the last ever given if there is none.
    virtual std::int64_t first_seq() const = 0;
    virtual std::int64_t last_seq() const = 0;
    virtual std::vector<EventRecord> after(std::int64_t seq, int limit) const = 0;

    // Lets go of at most `limit` events older than `age`. Returns how many.
    virtual int forget(std::chrono::milliseconds age, int limit) = 0;
};

}  // namespace leafcutter::server
