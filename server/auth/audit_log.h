// Who did what, kept for ever: written behind the calls' backs by a thread of its own, so that no
// stop waits for the disk. Safe from any thread.

#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "server/auth/account.h"

namespace leafcutter::server {

class AccountStore;

class AuditLog {
public:
    static constexpr std::size_t kMostWaiting = 10000;  // Beyond it only the text log has them.

    explicit AuditLog(AccountStore& store);

    // Writes what still waits.
    ~AuditLog();
    AuditLog(const AuditLog&) = delete;
    AuditLog& operator=(const AuditLog&) = delete;

    // `record.at_ms` is set here. Never waits for the disk.
    void append(AuditRecord record);

    // Returns when everything appended so far is on disk, or was refused by it.
    void flush();

private:
    void loop(const std::stop_token& stop);

    AccountStore& store_;
    std::mutex mutex_;  // Guards the members below.
    std::condition_variable_any arrived_;
    std::condition_variable written_;
    std::vector<AuditRecord> waiting_;
    bool writing_ = false;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
