// The rows of cuts, as the store's parts read and change them.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
class Statement;
}  // namespace SQLite

namespace leafcutter::server {

// The columns that cut_from() takes, up to "FROM cut ".
extern const char* const kSelectCut;

CutRecord cut_from(SQLite::Database& database, SQLite::Statement& row);
std::optional<CutRecord> find_cut(SQLite::Database& database, const std::string& id);
std::vector<CutRecord> open_cuts(SQLite::Database& database, const std::string& device);

// As the column `sheets` holds them.
std::string joined(const std::vector<int>& numbers);

// As the column `beam` holds it.
std::string written(const BeamRecord& beam);

// Events: of the cut, and of its job, whose view has its cuts, and what it allows depends on
// whether they are over.
void tell(SQLite::Database& database, const CutRecord& cut, std::string note);
void tell_job_of(SQLite::Database& database, const CutRecord& cut, std::string note);

// The one place where a cut changes its state. False if it is no longer in the state it was read
// in. Throws std::logic_error if the table of states forbids the move.
bool move_cut(SQLite::Database& database,
              const CutRecord& cut,
              CutState to,
              const std::string& reason);

}  // namespace leafcutter::server
