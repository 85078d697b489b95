#include "server/store/database.h"

#include <sqlite3.h>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>

namespace leafcutter::server {

Database::Database(std::filesystem::path file, std::function<void()> after_commit)
    : file_(std::move(file)), writer_(file_, std::move(after_commit)) {}

Database::~Database() = default;

std::unique_ptr<SQLite::Database> Database::take_reader() const {
    {
        const std::scoped_lock lock(mutex_);
        if (!idle_readers_.empty()) {
            std::unique_ptr<SQLite::Database> reader = std::move(idle_readers_.back());
            idle_readers_.pop_back();
            return reader;
        }
    }
    auto reader = std::make_unique<SQLite::Database>(file_.string(), SQLite::OPEN_READONLY, 5000);
    // A reader that closes last would checkpoint beside the writer; SQLite before 3.51.3 can damage
    // the file then.
    sqlite3_db_config(reader->getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    return reader;
}

void Database::read(const std::function<void(SQLite::Database&)>& work) const {
    std::unique_ptr<SQLite::Database> reader = take_reader();
    {
        SQLite::Transaction view(*reader);
        work(*reader);
    }
    const std::scoped_lock lock(mutex_);
    idle_readers_.push_back(std::move(reader));
}

}  // namespace leafcutter::server
