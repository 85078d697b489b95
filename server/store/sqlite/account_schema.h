// The tables of accounts: one migration of the schema.

#pragma once

namespace leafcutter::server {

constexpr const char* kAccountSchema = R"sql(
CREATE TABLE account(
    name TEXT PRIMARY KEY,
    role TEXT NOT NULL,
    password_hash TEXT NOT NULL,
    created_ms INTEGER NOT NULL) WITHOUT ROWID;

CREATE TABLE api_key(
    id TEXT PRIMARY KEY,
    account TEXT NOT NULL REFERENCES account(name) ON DELETE CASCADE,
    label TEXT NOT NULL,
    role TEXT NOT NULL,
    may_fire INTEGER NOT NULL,
    secret_hash TEXT NOT NULL,
    created_ms INTEGER NOT NULL,
    expires_ms INTEGER NOT NULL) WITHOUT ROWID;

CREATE TABLE session(
    token_hash TEXT PRIMARY KEY,
    account TEXT NOT NULL REFERENCES account(name) ON DELETE CASCADE,
    created_ms INTEGER NOT NULL) WITHOUT ROWID;

-- Append-only: nothing in this program changes or removes a row, and the file refuses to.
CREATE TABLE audit(
    seq INTEGER PRIMARY KEY AUTOINCREMENT,
    at_ms INTEGER NOT NULL,
    account TEXT NOT NULL,
    remote TEXT NOT NULL,
    action TEXT NOT NULL,
    note TEXT NOT NULL,
    status INTEGER NOT NULL);
CREATE TRIGGER audit_stays BEFORE UPDATE ON audit
    BEGIN SELECT raise(ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER audit_stays_whole BEFORE DELETE ON audit
    BEGIN SELECT raise(ABORT, 'the audit log is append-only'); END;
)sql";

}  // namespace leafcutter::server
