#include "server/store/writer.h"

#include <chrono>
#include <sqlite3.h>
#include <stdexcept>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/schema.h"

namespace leafcutter::server {

struct Writer::Request {
    const std::function<void(SQLite::Database&)>* work = nullptr;
    std::exception_ptr error;
    bool done = false;
};

Writer::Writer(const std::filesystem::path& file, std::function<void()> after_commit)
    : database_(std::make_unique<SQLite::Database>(
          file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, 5000)),
      after_commit_(std::move(after_commit)) {
    prepare_schema(*database_);
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

Writer::~Writer() {
    thread_.request_stop();
    thread_.join();
    sqlite3_wal_checkpoint_v2(database_->getHandle(), nullptr, SQLITE_CHECKPOINT_TRUNCATE, nullptr,
                              nullptr);
}

void Writer::run(const std::function<void(SQLite::Database&)>& work) {
    Request request;
    request.work = &work;
    std::unique_lock lock(mutex_);
    if (closed_) {
        throw std::runtime_error("the store is closed");
    }
    waiting_.push_back(&request);
    arrived_.notify_one();
    finished_.wait(lock, [&request] { return request.done; });
    if (request.error) {
        std::rethrow_exception(request.error);
    }
}

bool Writer::is_healthy() const {
    const std::scoped_lock lock(mutex_);
    return healthy_;
}

void Writer::loop(const std::stop_token& stop) {
    std::vector<Request*> group;
    while (true) {
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, stop, [this] { return !waiting_.empty(); });
            if (waiting_.empty()) {
                closed_ = true;
                return;
            }
            group.swap(waiting_);
        }
        const auto begin = std::chrono::steady_clock::now();
        commit_group(group);
        commit_latency_.add(std::chrono::steady_clock::now() - begin);
        {
            const std::scoped_lock lock(mutex_);
            for (Request* request : group) {
                request->done = true;
            }
        }
        finished_.notify_all();
        group.clear();
        if (after_commit_) {
            after_commit_();
        }
        checkpoint_if_due();
    }
}

void Writer::commit_group(const std::vector<Request*>& group) {
    try {
        database_->exec("BEGIN IMMEDIATE");
        for (Request* request : group) {
            database_->exec("SAVEPOINT request");
            try {
                (*request->work)(*database_);
            } catch (...) {  // Travels to whoever asked; the others of the group go on.
                request->error = std::current_exception();
                database_->exec("ROLLBACK TO request");
            }
            database_->exec("RELEASE request");
        }
        database_->exec("COMMIT");
    } catch (...) {
        // A commit that failed leaves the disk's word in doubt: nobody of the group was heard.
        const std::exception_ptr error = std::current_exception();
        sqlite3_exec(database_->getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
        const int code = database_->getErrorCode();
        const std::scoped_lock lock(mutex_);
        healthy_ = healthy_ && code != SQLITE_IOERR && code != SQLITE_CORRUPT;
        for (Request* request : group) {
            request->error = error;
        }
    }
}

void Writer::checkpoint_if_due() {
    constexpr int kGroupsPerCheckpoint = 500;
    if (++groups_since_checkpoint_ >= kGroupsPerCheckpoint) {
        groups_since_checkpoint_ = 0;
        sqlite3_wal_checkpoint_v2(database_->getHandle(), nullptr, SQLITE_CHECKPOINT_PASSIVE,
                                  nullptr, nullptr);
    }
}

}  // namespace leafcutter::server
