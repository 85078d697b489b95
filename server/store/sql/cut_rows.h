// The rows of cuts, as the store's parts read and change them.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class SqlSession;
class SqlStatement;

// The columns that cut_from() takes, up to "FROM cut ".
extern const char* const kSelectCut;

CutRecord cut_from(SqlSession& session, SqlStatement& row);
std::optional<CutRecord> find_cut(SqlSession& session, const std::string& id);
std::vector<CutRecord> open_cuts(SqlSession& session, const std::string& device);

// As the column `sheets` holds them.
std::string joined(const std::vector<int>& numbers);

// As the column `beam` holds it.
std::string written(const BeamRecord& beam);

// Events: of the cut, and of its job, whose view has its cuts, and what it allows depends on
// whether they are over.
void tell(SqlSession& session, const CutRecord& cut, std::string note);
void tell_job_of(SqlSession& session, const CutRecord& cut, std::string note);

// The one place where a cut changes its state. False if it is no longer in the state it was read
// in. Throws std::logic_error if the table of states forbids the move.
bool move_cut(SqlSession& session, const CutRecord& cut, CutState to, const std::string& reason);

}  // namespace leafcutter::server
