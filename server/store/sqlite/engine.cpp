#include "server/store/sqlite/engine.h"

#include <sqlite3.h>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/store/durable_file.h"
#include "server/store/ids.h"
#include "server/store/sql/tables.h"
#include "server/store/sqlite/database.h"
#include "server/store/sqlite/errors.h"
#include "server/store/sqlite/rescue.h"
#include "server/store/sqlite/schema.h"
#include "server/store/sqlite/seal.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

class SqliteEngine final : public SqlTables {
public:
    explicit SqliteEngine(std::unique_ptr<Database> database, const NodeScope& scope = {})
        : SqlTables(*database, scope), database_(std::move(database)) {}

    const LatencyHistogram* commit_latency() const override { return database_->commit_latency(); }
    std::string trouble() const override { return database_->trouble(); }
    SqlDatabase& rows() override { return *database_; }
    void pass_on(const std::string& /*key*/, const std::string& /*text*/) override {
    }  // There is nobody else.
    std::string check() const override;
    void back_up_to(const fs::path& file) const override;

private:
    std::unique_ptr<Database> database_;
};

std::string SqliteEngine::check() const {
    std::string damage;
    try {
        damage = quick_check(*open_reader(database_->file()));
    } catch (const SQLite::Exception& error) {
        damage = error.what();
    }
    if (!damage.empty()) {
        database_->note_damage(fmt::format(
            "the database is damaged ({}): nothing is changed any more; start the daemon again, "
            "and it takes the newest good backup",
            damage));
    }
    return damage;
}

// In one step: a reader's view stays the same however long it takes, and nobody waits for it.
void copy_rows(SQLite::Database& from, SQLite::Database& to) {
    sqlite3_backup* copying = sqlite3_backup_init(to.getHandle(), "main", from.getHandle(), "main");
    if (copying == nullptr) {
        throw SQLite::Exception(to.getHandle());
    }
    const int code = sqlite3_backup_step(copying, -1);
    sqlite3_backup_finish(copying);
    if (code != SQLITE_DONE) {
        throw SQLite::Exception(to.getHandle(), code);
    }
}

void SqliteEngine::back_up_to(const fs::path& file) const {
    const fs::path part = file.string() + ".part";
    try {
        fs::remove(part);
        {
            SQLite::Database copy(part.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
            copy_rows(*open_reader(database_->file()), copy);
            // One file, without a journal beside it.
            copy.exec("PRAGMA journal_mode = DELETE");
            const std::string damage = quick_check(copy);
            if (!damage.empty()) {
                throw StoreError(StoreTrouble::Damaged, damage);
            }
        }
        sync_file(part);
        crash_point("backup.before-rename");
        rename_durably(part, file);
        crash_point("backup.after-rename");
        put_seal(file);
    } catch (const SQLite::Exception& error) {
        fs::remove(part);
        throw store_error_of(error);
    } catch (const std::system_error& error) {
        throw StoreError(StoreTrouble::Failed, error.what());
    }
}

// Whoever migrates keeps what there was: a migration can't be undone.
void keep_before_migration(const fs::path& file, const fs::path& backups) {
    int version = 0;
    {
        SQLite::Database database(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE,
                                  5000);
        version = schema_version(database);
    }
    if (version == 0 || version >= newest_schema()) {
        return;
    }
    const SqliteEngine old(std::make_unique<Database>(file, "read before it is migrated"));
    old.back_up_to(backups / fmt::format("{}-schema-{}.db", rfc3339(wall_clock_ms()), version));
}

}  // namespace

OpenedEngine open_sqlite(const fs::path& folder,
                         const fs::path& backups,
                         std::function<void()> after_commit,
                         const NodeScope& scope) {
    const fs::path file = folder / "leafcutter.db";
    fs::create_directories(backups);
    const Rescue rescue = make_usable(file, backups);
    OpenedEngine opened;
    opened.notice = rescue.notice;
    opened.restored = rescue.restored;
    if (!rescue.trouble.empty()) {
        opened.engine =
            std::make_unique<SqliteEngine>(std::make_unique<Database>(file, rescue.trouble), scope);
        return opened;
    }
    try {
        keep_before_migration(file, backups);
        opened.engine = std::make_unique<SqliteEngine>(
            std::make_unique<Database>(file, std::move(after_commit)), scope);
    } catch (const SQLite::Exception& error) {
        throw DatabaseUnusable(fmt::format("{} can't be opened: {}", file.string(), error.what()));
    }
    return opened;
}

}  // namespace leafcutter::server
