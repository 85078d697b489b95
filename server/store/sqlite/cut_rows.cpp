#include "server/store/sqlite/cut_rows.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/sqlite/events.h"

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

const char* const kSelectCut =
    "SELECT cut.ordinal, cut.id, cut.job, cut.device, cut.sheets, cut.position, cut.state, "
    "cut.version, "
    "cut.lines_total, cut.lines_sent, cut.lines_acknowledged, cut.reason, cut.created_ms, "
    "cut.updated_ms, cut.rest_of, cut.rest_sha256, cut.beam FROM cut ";

std::string joined(const std::vector<int>& numbers) {
    return fmt::format("{}", fmt::join(numbers, ","));
}

std::string written(const BeamRecord& beam) {
    return fmt::format("{:.3f} {:.3f} {:.3f} {:.3f} {} {:.3f} {:.3f} {:d} {:d}", beam.least_mm,
                       beam.likely_mm, beam.most_mm, beam.total_mm, beam.line, beam.at_mm[0],
                       beam.at_mm[1], beam.certain, beam.position_kept);
}

CutRecord cut_from(SQLite::Database& database, SQLite::Statement& row) {
    CutRecord cut;
    cut.ordinal = row.getColumn(0).getInt64();
    cut.id = row.getColumn(1).getString();
    cut.job = row.getColumn(2).getString();
    cut.device = row.getColumn(3).getString();
    cut.sheets = parted(row.getColumn(4).getString());
    cut.position = static_cast<std::size_t>(row.getColumn(5).getInt64());
    cut.state = cut_state_named(row.getColumn(6).getString()).value_or(CutState::Failed);
    cut.version = row.getColumn(7).getInt64();
    cut.lines_total = row.getColumn(8).getInt64();
    cut.lines_sent = row.getColumn(9).getInt64();
    cut.lines_acknowledged = row.getColumn(10).getInt64();
    cut.reason = row.getColumn(11).getString();
    cut.created_ms = row.getColumn(12).getInt64();
    cut.updated_ms = row.getColumn(13).getInt64();
    cut.rest_of = row.getColumn(14).getString();
    cut.beam = beam_from(row.getColumn(16).getString());
    if (cut.is_rest()) {
        cut.program_sha256 = row.getColumn(15).getString();
        return cut;
    }
    SQLite::Statement program(database,
                              "SELECT program_sha256 FROM sheet WHERE job = ? AND number = ?");
    program.bind(1, cut.job);
    program.bind(2, cut.sheet());
    if (program.executeStep()) {
        cut.program_sha256 = program.getColumn(0).getString();
    }
    return cut;
}

std::optional<CutRecord> find_cut(SQLite::Database& database, const std::string& id) {
    SQLite::Statement query(database, std::string(kSelectCut) + "WHERE id = ?");
    query.bind(1, id);
    if (!query.executeStep()) {
        return std::nullopt;
    }
    return cut_from(database, query);
}

std::vector<CutRecord> open_cuts(SQLite::Database& database, const std::string& device) {
    SQLite::Statement query(
        database,
        std::string(kSelectCut) +
            "WHERE device = ? AND state IN ('waiting','armed','cutting','paused','awaiting-sheet') "
            "ORDER BY ordinal");
    query.bind(1, device);
    std::vector<CutRecord> cuts;
    while (query.executeStep()) {
        cuts.push_back(cut_from(database, query));
    }
    return cuts;
}

void tell(SQLite::Database& database, const CutRecord& cut, std::string note) {
    EventRecord event;
    event.type = "cut";
    event.subject = cut.id;
    event.job = cut.job;
    event.note = std::move(note);
    append_event(database, event);
}

void tell_job_of(SQLite::Database& database, const CutRecord& cut, std::string note) {
    EventRecord event;
    event.type = "job";
    event.subject = cut.job;
    event.job = cut.job;
    event.note = std::move(note);
    append_event(database, event);
}

bool move_cut(SQLite::Database& database,
              const CutRecord& cut,
              CutState to,
              const std::string& reason) {
    if (!may_follow(cut.state, to)) {
        throw std::logic_error(
            fmt::format("a cut never goes from {} to {}", to_string(cut.state), to_string(to)));
    }
    SQLite::Statement update(database,
                             "UPDATE cut SET state = ?, reason = ?, version = version + 1, "
                             "updated_ms = ? WHERE id = ? AND state = ?");
    update.bind(1, std::string(to_string(to)));
    update.bind(2, reason);
    update.bind(3, wall_clock_ms());
    update.bind(4, cut.id);
    update.bind(5, std::string(to_string(cut.state)));
    if (update.exec() == 0) {
        return false;
    }
    tell(database, cut, fmt::format("{} -> {}", to_string(cut.state), to_string(to)));
    if (is_final(to)) {
        tell_job_of(database, cut, fmt::format("cut {}", to_string(to)));
    }
    return true;
}

}  // namespace leafcutter::server
