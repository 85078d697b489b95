#include "server/store/sql/cut_rows.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "server/store/sql/events.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

std::vector<int> parted(const std::string& text) {
    std::vector<int> numbers;
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        numbers.push_back(std::stoi(text.substr(at, comma - at)));
        at = comma + 1;
    }
    return numbers;
}

std::optional<BeamRecord> beam_from(const std::string& text) {
    BeamRecord beam;
    std::istringstream in(text);
    in >> beam.least_mm >> beam.likely_mm >> beam.most_mm >> beam.total_mm >> beam.line >>
        beam.at_mm[0] >> beam.at_mm[1] >> beam.certain >> beam.position_kept;
    return in.fail() ? std::nullopt : std::optional(beam);
}

}  // namespace

std::string joined(const std::vector<int>& numbers) {
    return fmt::format("{}", fmt::join(numbers, ","));
}

std::string written(const BeamRecord& beam) {
    return fmt::format("{:.3f} {:.3f} {:.3f} {:.3f} {} {:.3f} {:.3f} {:d} {:d}", beam.least_mm,
                       beam.likely_mm, beam.most_mm, beam.total_mm, beam.line, beam.at_mm[0],
                       beam.at_mm[1], beam.certain, beam.position_kept);
}

CutRecord cut_from(SqlSession& session, SqlStatement& row) {
    CutRecord cut;
    cut.ordinal = row.column(0).int64();
    cut.id = row.column(1).text();
    cut.job = row.column(2).text();
    cut.device = row.column(3).text();
    cut.sheets = parted(row.column(4).text());
    cut.position = static_cast<std::size_t>(row.column(5).int64());
    cut.state = cut_state_named(row.column(6).text()).value_or(CutState::Failed);
    cut.version = row.column(7).int64();
    cut.lines_total = row.column(8).int64();
    cut.lines_sent = row.column(9).int64();
    cut.lines_acknowledged = row.column(10).int64();
    cut.reason = row.column(11).text();
    cut.created_ms = row.column(12).int64();
    cut.updated_ms = row.column(13).int64();
    cut.rest_of = row.column(14).text();
    cut.beam = beam_from(row.column(16).text());
    cut.owner = row.column(17).text();
    cut.fence = row.column(18).int64();
    if (cut.is_rest()) {
        cut.program_sha256 = row.column(15).text();
        return cut;
    }
    SqlStatement program(session, "SELECT program_sha256 FROM sheet WHERE job = ? AND number = ?");
    program.bind(1, cut.job);
    program.bind(2, cut.sheet());
    if (program.step()) {
        cut.program_sha256 = program.column(0).text();
    }
    return cut;
}

std::optional<CutRecord> find_cut(SqlSession& session, const std::string& id) {
    SqlStatement query(session, std::string(kSelectCut) + "WHERE id = ?");
    query.bind(1, id);
    if (!query.step()) {
        return std::nullopt;
    }
    return cut_from(session, query);
}

std::vector<CutRecord> open_cuts(SqlSession& session, const std::string& device) {
    SqlStatement query(
        session,
        std::string(kSelectCut) +
            "WHERE device = ? AND state IN ('waiting','armed','cutting','paused','awaiting-sheet') "
            "ORDER BY ordinal");
    query.bind(1, device);
    std::vector<CutRecord> cuts;
    while (query.step()) {
        cuts.push_back(cut_from(session, query));
    }
    return cuts;
}

namespace {

void tell_of(SqlSession& session,
             const char* type,
             const std::string& subject,
             const std::string& job,
             std::string note) {
    EventRecord event;
    event.type = type;
    event.subject = subject;
    event.job = job;
    event.note = std::move(note);
    append_event(session, event);
}

}  // namespace

void tell(SqlSession& session, const CutRecord& cut, std::string note) {
    tell_of(session, "cut", cut.id, cut.job, std::move(note));
}

void tell_job_of(SqlSession& session, const CutRecord& cut, std::string note) {
    tell_of(session, "job", cut.job, cut.job, std::move(note));
}

bool move_cut(SqlSession& session, const CutRecord& cut, CutState to, const std::string& reason) {
    if (!may_follow(cut.state, to)) {
        throw std::logic_error(
            fmt::format("a cut never goes from {} to {}", to_string(cut.state), to_string(to)));
    }
    SqlStatement update(session,
                        "UPDATE cut SET state = ?, reason = ?, version = version + 1, "
                        "updated_ms = ? WHERE id = ? AND state = ?");
    update.bind(1, std::string(to_string(to)));
    update.bind(2, reason);
    update.bind(3, session.now_ms());
    update.bind(4, cut.id);
    update.bind(5, std::string(to_string(cut.state)));
    if (update.run() == 0) {
        return false;
    }
    tell(session, cut, fmt::format("{} -> {}", to_string(cut.state), to_string(to)));
    if (is_final(to)) {
        tell_job_of(session, cut, fmt::format("cut {}", to_string(to)));
    }
    return true;
}

bool is_open_ended(SqlSession& session, const CutRecord& cut) {
    if (!is_final(cut.state) || cut.state == CutState::Done) {
        return false;
    }
    SqlStatement rest(
        session,
        "SELECT 1 FROM cut WHERE rest_of = ? AND NOT (state = 'aborted' AND NOT EXISTS("
        "SELECT 1 FROM cut_intent WHERE cut_intent.cut = cut.id)) LIMIT 1");
    rest.bind(1, cut.id);
    return !rest.step();
}

}  // namespace leafcutter::server
