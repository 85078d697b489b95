// What has to be done now and then, on a thread of its own that nobody waits for: backups, old jobs
// and events let go, files that nobody names removed, the database looked through.

#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "server/fleet/duties.h"
#include "server/store/store.h"

namespace leafcutter::server {

class Housekeeper {
public:
    // What concerns the rows is done while `duties` has kHousekeeping; the files are each node's
    // own.
    Housekeeper(Store& store, const Duties& duties);
    ~Housekeeper();
    Housekeeper(const Housekeeper&) = delete;
    Housekeeper& operator=(const Housekeeper&) = delete;

    // The settings changed: there may be something to do.
    void wake();

private:
    using Clock = std::chrono::steady_clock;

    void loop(const std::stop_token& stop);
    void work(const std::stop_token& stop);
    void back_up_if_due();
    void let_go(const std::stop_token& stop);
    void sweep_if_due();

    Store& store_;
    const Duties& duties_;
    Clock::time_point last_backup_;
    Clock::time_point next_sweep_;
    bool checked_ = false;

    std::mutex mutex_;  // Guards woken_.
    std::condition_variable_any nudged_;
    bool woken_ = false;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
