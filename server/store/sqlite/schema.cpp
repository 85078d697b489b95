#include "server/store/sqlite/schema.h"

#include <array>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/store/sqlite/account_schema.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace {

// Migration N leads to user_version N + 1. Never edit one that was released: add another.
constexpr std::array kMigrations{
    R"sql(
CREATE TABLE job(
    ordinal INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    name TEXT NOT NULL,
    state TEXT NOT NULL,
    version INTEGER NOT NULL DEFAULT 1,
    created_ms INTEGER NOT NULL,
    updated_ms INTEGER NOT NULL,
    file_name TEXT NOT NULL,
    file_bytes INTEGER NOT NULL,
    file_sha256 TEXT NOT NULL,
    params TEXT NOT NULL,
    attempt INTEGER NOT NULL DEFAULT 0,
    error_kind TEXT, error_code TEXT, error_detail TEXT,
    summary TEXT);
CREATE INDEX job_queued ON job(ordinal) WHERE state = 'queued';
CREATE INDEX job_state ON job(state, ordinal);
CREATE INDEX job_blob ON job(file_sha256);

CREATE TABLE artifact(
    job TEXT NOT NULL REFERENCES job(id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    path TEXT NOT NULL,
    bytes INTEGER NOT NULL,
    sha256 TEXT NOT NULL,
    media_type TEXT NOT NULL,
    PRIMARY KEY(job, path)) WITHOUT ROWID;
CREATE INDEX artifact_blob ON artifact(sha256);

CREATE TABLE sheet(
    job TEXT NOT NULL REFERENCES job(id) ON DELETE CASCADE,
    number INTEGER NOT NULL,
    material TEXT NOT NULL,
    program_sha256 TEXT NOT NULL,
    estimated_s REAL NOT NULL,
    cut INTEGER NOT NULL DEFAULT 0,
    PRIMARY KEY(job, number)) WITHOUT ROWID;

CREATE TABLE cut(
    ordinal INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    job TEXT NOT NULL REFERENCES job(id) ON DELETE CASCADE,
    device TEXT NOT NULL,
    sheets TEXT NOT NULL,
    position INTEGER NOT NULL DEFAULT 0,
    state TEXT NOT NULL,
    version INTEGER NOT NULL DEFAULT 1,
    lines_total INTEGER NOT NULL DEFAULT 0,
    lines_sent INTEGER NOT NULL DEFAULT 0,
    lines_acknowledged INTEGER NOT NULL DEFAULT 0,
    reason TEXT NOT NULL DEFAULT '',
    created_ms INTEGER NOT NULL,
    updated_ms INTEGER NOT NULL);
CREATE INDEX cut_of_job ON cut(job, ordinal);
CREATE INDEX cut_of_device ON cut(device, state, ordinal);

-- On disk before the beam may come on: which program was let loose, and when.
CREATE TABLE cut_intent(
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    cut TEXT NOT NULL,
    sheet INTEGER NOT NULL,
    program_sha256 TEXT NOT NULL,
    at_ms INTEGER NOT NULL);

CREATE TABLE device(
    id TEXT PRIMARY KEY,
    name TEXT NOT NULL,
    uri TEXT NOT NULL,
    auto_start INTEGER NOT NULL,
    bed_width_mm REAL NOT NULL,
    bed_height_mm REAL NOT NULL) WITHOUT ROWID;

CREATE TABLE event(
    seq INTEGER PRIMARY KEY AUTOINCREMENT,
    at_ms INTEGER NOT NULL,
    type TEXT NOT NULL,
    subject TEXT NOT NULL,
    job TEXT NOT NULL,
    note TEXT NOT NULL);

CREATE TABLE idempotency(
    key TEXT PRIMARY KEY,
    request_hash TEXT NOT NULL,
    job TEXT NOT NULL,
    at_ms INTEGER NOT NULL) WITHOUT ROWID;

INSERT INTO device VALUES('sim', 'Simulated laser', 'sim:grbl', 0, 600, 400);
)sql",
    R"sql(
CREATE TABLE material(
    id TEXT PRIMARY KEY,
    record TEXT NOT NULL) WITHOUT ROWID;

-- The job whose pieces it cuts again.
ALTER TABLE job ADD COLUMN recut_of TEXT NOT NULL DEFAULT '';
)sql",
    R"sql(
-- The cut whose rest its first sheet is, with the program of that; and how far its own beam got.
ALTER TABLE cut ADD COLUMN rest_of TEXT NOT NULL DEFAULT '';
ALTER TABLE cut ADD COLUMN rest_sha256 TEXT NOT NULL DEFAULT '';
ALTER TABLE cut ADD COLUMN beam TEXT NOT NULL DEFAULT '';
CREATE INDEX cut_rest ON cut(rest_of) WHERE rest_of <> '';
CREATE INDEX cut_rest_blob ON cut(rest_sha256) WHERE rest_sha256 <> '';
CREATE INDEX cut_intent_of ON cut_intent(cut);
)sql",
    R"sql(
-- The queue has an order of its own: priority, then place.
ALTER TABLE job ADD COLUMN priority INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN place INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN retries INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN retry_cause TEXT NOT NULL DEFAULT '';
UPDATE job SET place = ordinal * 1048576;
DROP INDEX job_queued;
CREATE INDEX job_queued ON job(priority DESC, place, ordinal) WHERE state = 'queued';
CREATE INDEX job_dead ON job(ordinal) WHERE error_code = 'poison-job' AND state = 'failed';
CREATE INDEX job_ended ON job(updated_ms) WHERE state IN ('done','failed','cancelled');
CREATE INDEX idempotency_at ON idempotency(at_ms);

-- What a sheet is cut from, and what it leaves.
ALTER TABLE sheet ADD COLUMN width_mm REAL NOT NULL DEFAULT 0;
ALTER TABLE sheet ADD COLUMN height_mm REAL NOT NULL DEFAULT 0;
ALTER TABLE sheet ADD COLUMN stock TEXT NOT NULL DEFAULT '';
ALTER TABLE sheet ADD COLUMN offcut TEXT NOT NULL DEFAULT '';
CREATE INDEX sheet_of_stock ON sheet(stock) WHERE stock <> '' AND cut = 0;

CREATE TABLE stock(
    id TEXT PRIMARY KEY,
    record TEXT NOT NULL,
    material TEXT NOT NULL,
    quantity INTEGER,
    note TEXT NOT NULL DEFAULT '',
    from_job TEXT NOT NULL DEFAULT '',
    from_sheet INTEGER NOT NULL DEFAULT 0,
    created_ms INTEGER NOT NULL,
    updated_ms INTEGER NOT NULL) WITHOUT ROWID;

CREATE TABLE preset(
    id TEXT PRIMARY KEY,
    record TEXT NOT NULL) WITHOUT ROWID;

CREATE TABLE setting(
    key TEXT PRIMARY KEY,
    value TEXT NOT NULL) WITHOUT ROWID;
)sql", kAccountSchema,
    R"sql(
-- Who has a job or a machine, for a fleet: a daemon alone leaves them empty. See fleet_store.h.
ALTER TABLE job ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN fence INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN lease_until_ms INTEGER NOT NULL DEFAULT 0;
CREATE INDEX job_lease ON job(lease_until_ms) WHERE state = 'computing';
ALTER TABLE cut ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE cut ADD COLUMN fence INTEGER NOT NULL DEFAULT 0;
ALTER TABLE device ADD COLUMN station TEXT NOT NULL DEFAULT '';

CREATE TABLE machine_lease(
    device TEXT PRIMARY KEY,
    owner TEXT NOT NULL,
    fence INTEGER NOT NULL,
    lease_until_ms INTEGER NOT NULL) WITHOUT ROWID;

CREATE TABLE node(
    id TEXT PRIMARY KEY,
    role TEXT NOT NULL,
    url TEXT NOT NULL,
    version TEXT NOT NULL,
    mode TEXT NOT NULL,
    facts TEXT NOT NULL DEFAULT '{}',
    started_ms INTEGER NOT NULL,
    seen_ms INTEGER NOT NULL) WITHOUT ROWID;
)sql",
    R"sql(
ALTER TABLE job ADD COLUMN recut TEXT NOT NULL DEFAULT '';
CREATE INDEX job_recut ON job(priority DESC, place, ordinal) WHERE state = 'queued' AND recut <> '';
)sql"};

// Durability first: FULL syncs every commit, and only the writer's own checkpoints touch the file.
constexpr const char* kPragmas = R"sql(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = FULL;
PRAGMA foreign_keys = ON;
PRAGMA mmap_size = 0;
PRAGMA trusted_schema = OFF;
PRAGMA cell_size_check = ON;
PRAGMA journal_size_limit = 67108864;
PRAGMA wal_autocheckpoint = 0;
)sql";

}  // namespace

void prepare_connection(SQLite::Database& database) {
    database.exec(kPragmas);
}

int schema_version(SQLite::Database& database) {
    return database.execAndGet("PRAGMA user_version").getInt();
}

int newest_schema() {
    return static_cast<int>(kMigrations.size());
}

std::string quick_check(SQLite::Database& database) {
    const std::string verdict = database.execAndGet("PRAGMA quick_check(1)").getString();
    return verdict == "ok" ? std::string() : verdict;
}

void migrate(SQLite::Database& database) {
    const int version = schema_version(database);
    if (version > newest_schema()) {
        throw DatabaseUnusable(
            fmt::format("the database has schema {}, this Leafcutter knows {}: use the newer one",
                        version, newest_schema()));
    }
    for (int step = version; step < newest_schema(); ++step) {
        SQLite::Transaction transaction(database);
        database.exec(kMigrations[static_cast<std::size_t>(step)]);
        database.exec(fmt::format("PRAGMA user_version = {}", step + 1));
        crash_point("migrate.before-commit");
        transaction.commit();
        crash_point("migrate.after-commit");
    }
}

}  // namespace leafcutter::server
