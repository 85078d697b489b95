#include "server/store/sqlite/database.h"

#include <sqlite3.h>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/errors.h"
#include "server/store/sqlite/seal.h"
#include "server/store/sqlite/session.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

Database::Database(std::filesystem::path file, std::function<void()> after_commit)
    : file_(std::move(file)), writer_(std::make_unique<Writer>(file_, std::move(after_commit))) {}

Database::Database(std::filesystem::path file, std::string trouble)
    : file_(std::move(file)), trouble_(std::move(trouble)) {}

Database::~Database() {
    const bool is_whole = writer_ && writer_->trouble().empty();
    idle_readers_.clear();
    writer_.reset();
    if (is_whole) {
        put_seal(file_);
    }
}

std::unique_ptr<SQLite::Database> open_reader(const std::filesystem::path& file) {
    constexpr int kPatienceMs = 5000;
    auto reader =
        std::make_unique<SQLite::Database>(file.string(), SQLite::OPEN_READONLY, kPatienceMs);
    // A reader that closes last would checkpoint beside the writer; SQLite before 3.51.3 can damage
    // the file then.
    sqlite3_db_config(reader->getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    return reader;
}

std::unique_ptr<SQLite::Database> Database::take_reader() const {
    {
        const std::scoped_lock lock(mutex_);
        if (!idle_readers_.empty()) {
            std::unique_ptr<SQLite::Database> reader = std::move(idle_readers_.back());
            idle_readers_.pop_back();
            return reader;
        }
    }
    return open_reader(file_);
}

void Database::write(const Work& work, WriteOrder /*order*/) {
    if (!writer_) {
        throw StoreError(StoreTrouble::ReadOnly, trouble_);
    }
    writer_->run(work);
}

void Database::write_soon(const std::string& /*key*/, const Work& work) {
    write(work);  // The disk is never far.
}

void Database::read(const Work& work) const {
    try {
        std::unique_ptr<SQLite::Database> reader = take_reader();
        {
            SQLite::Transaction view(*reader);
            SqliteSession session(*reader);
            work(session);
        }
        const std::scoped_lock lock(mutex_);
        idle_readers_.push_back(std::move(reader));
    } catch (const SQLite::Exception& error) {
        throw store_error_of(error);
    }
}

std::string Database::trouble() const {
    return writer_ ? writer_->trouble() : trouble_;
}

void Database::note_damage(const std::string& what) {
    if (writer_) {
        writer_->give_up(what);
    }
}

}  // namespace leafcutter::server
