// The engine for one machine: SQLite in the state folder.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "server/store/engine.h"

namespace leafcutter::server {

// Opens or creates `folder`/leafcutter.db, migrated; damaged ones are put aside for a backup of
// `backups`, or opened for reading alone. `after_commit` is called by a thread of the engine and
// must not wait. Throws DatabaseUnusable.
OpenedEngine open_sqlite(const std::filesystem::path& folder,
                         const std::filesystem::path& backups,
                         std::function<void()> after_commit,
                         const NodeScope& scope = {});

}  // namespace leafcutter::server
