// One of the searches of a compaction.

#pragma once

#include <cstdint>
#include <stop_token>

#include "fab/nest/compaction.h"

namespace leafcutter::fab {

class Search {
public:
    Search() = default;
    Search(const Search&) = delete;
    Search& operator=(const Search&) = delete;
    virtual ~Search() = default;

    // Works for about that many evaluations. `progress` in [0, 1]: of the whole search. Throws
    // Cancelled after a stop request.
    virtual void advance(std::int64_t evaluations,
                         double progress,
                         const std::stop_token& stop) = 0;

    virtual const Packing& best() const = 0;
    virtual double best_area() const = 0;
    virtual std::int64_t evaluations() const = 0;

    // Whether it seeks its own way, worse for a while, and shall not take over what others found.
    virtual bool wanders() const { return false; }

    // Takes over what another search found. Better than its own, or else its own was refused.
    virtual void adopt(const Packing& better) = 0;
};

}  // namespace leafcutter::fab
