// Which request made what, so that the same one again makes nothing.

#pragma once

#include <optional>
#include <string>

#include "server/store/job_store.h"

namespace leafcutter::server {

class SqlSession;

// What an earlier request with this key made, if any: as it was remembered. Throws KeyReused.
std::optional<std::string> made_with(SqlSession& session, const IdempotencyKey& key);

// Kept for a week.
void remember_key(SqlSession& session, const IdempotencyKey& key, const std::string& made);

}  // namespace leafcutter::server
