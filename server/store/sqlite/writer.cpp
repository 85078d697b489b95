#include "server/store/sqlite/writer.h"

#include <chrono>
#include <sqlite3.h>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/store/sqlite/errors.h"
#include "server/store/sqlite/rescue.h"
#include "server/store/sqlite/schema.h"
#include "server/store/sqlite/session.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace {

constexpr int kPatienceMs = 5000;

}  // namespace

struct Writer::Request {
    const SqlDatabase::Work* work = nullptr;
    std::exception_ptr error;
    bool done = false;
};

Writer::Writer(const std::filesystem::path& file, std::function<void()> after_commit)
    : file_(file),
      database_(std::make_unique<SQLite::Database>(
          file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kPatienceMs)),
      after_commit_(std::move(after_commit)) {
    prepare_connection(*database_);
    migrate(*database_);
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

Writer::~Writer() {
    thread_.request_stop();
    thread_.join();
    if (trouble_.empty()) {
        sqlite3_wal_checkpoint_v2(database_->getHandle(), nullptr, SQLITE_CHECKPOINT_TRUNCATE,
                                  nullptr, nullptr);
    }
}

void Writer::run(const SqlDatabase::Work& work) {
    Request request;
    request.work = &work;
    wait_until_done(request);
    if (!request.error) {
        return;
    }
    try {
        std::rethrow_exception(request.error);
    } catch (const SQLite::Exception& error) {
        throw store_error_of(error);
    }
}

void Writer::wait_until_done(Request& request) {
    std::unique_lock lock(mutex_);
    if (closed_) {
        throw StoreError(StoreTrouble::Failed, "the store is closed");
    }
    if (!trouble_.empty()) {
        throw StoreError(StoreTrouble::ReadOnly, trouble_);
    }
    waiting_.push_back(&request);
    arrived_.notify_one();
    finished_.wait(lock, [&request] { return request.done; });
}

std::string Writer::trouble() const {
    const std::scoped_lock lock(mutex_);
    return trouble_;
}

void Writer::give_up(const std::string& what) {
    mark_suspect(file_);
    const std::scoped_lock lock(mutex_);
    if (trouble_.empty()) {
        trouble_ = what;
    }
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
        SqliteSession session(*database_);
        for (Request* request : group) {
            database_->exec("SAVEPOINT request");
            try {
                (*request->work)(session);
            } catch (...) {  // Travels to whoever asked; the others of the group go on.
                request->error = std::current_exception();
                database_->exec("ROLLBACK TO request");
            }
            database_->exec("RELEASE request");
        }
        crash_point("commit.before");
        database_->exec("COMMIT");
        crash_point("commit.after");
    } catch (const SQLite::Exception& error) {
        // A commit that failed leaves the disk's word in doubt: nobody of the group was heard.
        const std::exception_ptr thrown = std::current_exception();
        sqlite3_exec(database_->getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
        if (is_fatal_for_writing(error)) {
            give_up(fmt::format("the database takes nothing more since the disk failed: {}",
                                error.what()));
        }
        for (Request* request : group) {
            request->error = thrown;
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
