#include "server/store/sql/idempotency.h"

#include "server/store/sql/session.h"

namespace leafcutter::server {

std::optional<std::string> made_with(SqlSession& session, const IdempotencyKey& key) {
    SqlStatement query(session, "SELECT request_hash, job FROM idempotency WHERE key = ?");
    query.bind(1, key.key);
    if (!query.step()) {
        return std::nullopt;
    }
    if (query.column(0).text() != key.request_hash) {
        throw KeyReused("this Idempotency-Key belongs to a different request");
    }
    return query.column(1).text();
}

void remember_key(SqlSession& session, const IdempotencyKey& key, const std::string& made) {
    constexpr std::int64_t kKeptMs = 7LL * 24 * 3600 * 1000;
    SqlStatement forget(session, "DELETE FROM idempotency WHERE at_ms < ?");
    forget.bind(1, session.now_ms() - kKeptMs);
    forget.run();
    SqlStatement insert(session,
                        "INSERT INTO idempotency(key, request_hash, job, at_ms) VALUES(?, ?, ?, ?) "
                        "ON CONFLICT(key) DO UPDATE SET request_hash = excluded.request_hash, "
                        "job = excluded.job, at_ms = excluded.at_ms");
    insert.bind(1, key.key);
    insert.bind(2, key.request_hash);
    insert.bind(3, made);
    insert.bind(4, session.now_ms());
    insert.run();
}

}  // namespace leafcutter::server
