#include "server/auth/audit_log.h"

#include <exception>
#include <utility>

#include <spdlog/spdlog.h>

#include "server/store/account_store.h"
#include "server/store/ids.h"

namespace leafcutter::server {

AuditLog::AuditLog(AccountStore& store)
    : store_(store), thread_([this](const std::stop_token& stop) { loop(stop); }) {}

AuditLog::~AuditLog() {
    thread_.request_stop();
    thread_.join();
}

void AuditLog::append(AuditRecord record) {
    record.at_ms = wall_clock_ms();
    spdlog::info("audit: {} {} from {}: {} {}", record.user.empty() ? "-" : record.user,
                 record.action, record.remote, record.status, record.note);
    {
        const std::scoped_lock lock(mutex_);
        if (waiting_.size() >= kMostWaiting) {
            return;
        }
        waiting_.push_back(std::move(record));
    }
    arrived_.notify_one();
}

void AuditLog::flush() {
    std::unique_lock lock(mutex_);
    written_.wait(lock, [this] { return waiting_.empty() && !writing_; });
}

void AuditLog::loop(const std::stop_token& stop) {
    std::vector<AuditRecord> records;
    while (true) {
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, stop, [this] { return !waiting_.empty(); });
            if (waiting_.empty()) {
                return;
            }
            records.swap(waiting_);
            writing_ = true;
        }
        try {
            store_.append(records);
        } catch (const std::exception& error) {  // The text log has them.
            spdlog::error("audit log: {}", error.what());
        }
        records.clear();
        {
            const std::scoped_lock lock(mutex_);
            writing_ = false;
        }
        written_.notify_all();
    }
}

}  // namespace leafcutter::server
