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
inline constexpr const char* kSelectCut =
    "SELECT cut.ordinal, cut.id, cut.job, cut.device, cut.sheets, cut.position, cut.state, "
    "cut.version, "
    "cut.lines_total, cut.lines_sent, cut.lines_acknowledged, cut.reason, cut.created_ms, "
    "cut.updated_ms, cut.rest_of, cut.rest_sha256, cut.beam, cut.owner, cut.fence FROM cut ";

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

// It ended early, and no other cut has begun, or is to begin, its rest: nothing is burnt twice.
bool is_open_ended(SqlSession& session, const CutRecord& cut);

}  // namespace leafcutter::server
