// What the pure core may know of its surroundings: a stop request, a thread budget, and whom to
// tell how far it is. No clock, no logger, no globals.

#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

#include "geometry/error.h"

namespace leafcutter::geometry {

struct Context {
    std::stop_token stop;
    unsigned threads = 1;  // May be used, never needed: results don't depend on it.

    // Called with the stage's name and the fraction of the whole work done, in [0, 1], not falling.
    // Called from the thread that called the core. May be empty.
    std::function<void(std::string_view stage, double fraction)> progress;

    // Seconds since any fixed moment, for reports of time spent. May be empty: then reports say 0.
    std::function<double()> clock_s;

    // Throws Cancelled after a stop request. Called at least every few tens of milliseconds of
    // work.
    void check() const {
        if (stop.stop_requested()) {
            throw Cancelled();
        }
    }
    void report(std::string_view stage, double fraction) const {
        check();
        if (progress) {
            progress(stage, fraction);
        }
    }
    double now_s() const { return clock_s ? clock_s() : 0.0; }
};

}  // namespace leafcutter::geometry
