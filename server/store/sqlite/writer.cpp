#include "server/store/sqlite/writer.h"

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

Writer::Writer(const std::filesystem::path& file, std::function<void()> after_commit)
    : file_(file),
      database_(std::make_unique<SQLite::Database>(
          file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kPatienceMs)),
      after_commit_(std::move(after_commit)) {
    prepare_connection(*database_);
    migrate(*database_);
    queue_ = std::make_unique<CommitQueue>(
        [this](const CommitQueue::Group& group) { commit(group); }, [this] { after_group(); });
}

Writer::~Writer() {
    queue_.reset();
    if (trouble_.empty()) {
        sqlite3_wal_checkpoint_v2(database_->getHandle(), nullptr, SQLITE_CHECKPOINT_TRUNCATE,
                                  nullptr, nullptr);
    }
}

void Writer::run(const SqlDatabase::Work& work) {
    if (const std::string why = trouble(); !why.empty()) {
        throw StoreError(StoreTrouble::ReadOnly, why);
    }
    try {
        queue_->run(work, WriteOrder::Alone);
    } catch (const SQLite::Exception& error) {
        throw store_error_of(error);
    }
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

void Writer::after_group() {
    if (after_commit_) {
        after_commit_();
    }
    checkpoint_if_due();
}

void Writer::commit(const CommitQueue::Group& group) {
    try {
        database_->exec("BEGIN IMMEDIATE");
        SqliteSession session(*database_);
        for (CommitQueue::Request* request : group) {
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
        for (CommitQueue::Request* request : group) {
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
