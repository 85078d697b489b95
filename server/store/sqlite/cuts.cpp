#include "server/store/sqlite/cuts.h"

#include <algorithm>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/store/ids.h"
#include "server/store/sqlite/cut_rows.h"
#include "server/store/sqlite/database.h"
#include "server/store/sqlite/events.h"
#include "server/store/sqlite/job_rows.h"
#include "server/store/sqlite/stock.h"

namespace leafcutter::server {

namespace {

void set_progress(SQLite::Database& database, const std::string& id, const CutProgress& progress) {
    SQLite::Statement update(
        database,
        "UPDATE cut SET lines_total = ?, lines_sent = ?, lines_acknowledged = ? WHERE id = ?");
    update.bind(1, progress.lines_total);
    update.bind(2, progress.lines_sent);
    update.bind(3, progress.lines_acknowledged);
    update.bind(4, id);
    update.exec();
}

enum class Which { All, Uncut };

std::vector<int> sheets_of(SQLite::Database& database, const std::string& job, Which which) {
    SQLite::Statement query(database,
                            "SELECT number, cut FROM sheet WHERE job = ? AND program_sha256 <> '' "
                            "ORDER BY number");
    query.bind(1, job);
    std::vector<int> sheets;
    while (query.executeStep()) {
        if (which == Which::All || query.getColumn(1).getInt() == 0) {
            sheets.push_back(query.getColumn(0).getInt());
        }
    }
    return sheets;
}

void check_sheets(SQLite::Database& database, const std::string& job, std::vector<int>& sheets) {
    SQLite::Statement state(database, "SELECT state FROM job WHERE id = ?");
    state.bind(1, job);
    const std::string found = state.executeStep() ? state.getColumn(0).getString() : "gone";
    if (found != "ready" && found != "done") {
        throw NotCuttable(fmt::format("the job is {}: only a ready one can be cut", found));
    }
    const std::vector<int> all = sheets_of(database, job, Which::All);
    if (sheets.empty()) {
        sheets = sheets_of(database, job, Which::Uncut);
        if (sheets.empty()) {
            sheets = all;
        }
    }
    if (sheets.empty()) {
        throw NotCuttable("the job has no sheets");
    }
    for (const int sheet : sheets) {
        if (std::find(all.begin(), all.end(), sheet) == all.end()) {
            throw NotCuttable(fmt::format("the job has no sheet {}", sheet));
        }
    }
}

void count_sheet_as_cut(SQLite::Database& database, const CutRecord& cut) {
    SQLite::Statement mark(database,
                           "UPDATE sheet SET cut = 1 WHERE job = ? AND number = ? AND cut = 0");
    mark.bind(1, cut.job);
    mark.bind(2, cut.sheet());
    if (mark.exec() > 0) {
        book_cut_sheet(database, cut.job, cut.sheet());
    }
    if (!sheets_of(database, cut.job, Which::Uncut).empty() ||
        !move_job(database, cut.job, JobState::Ready, JobState::Done)) {
        tell_job_of(database, cut, fmt::format("sheet {} cut", cut.sheet()));
    }
}

struct NewCut {
    std::string job;
    std::string device;
    std::vector<int> sheets;
};

// Returns its id.
std::string insert_cut(SQLite::Database& database, const NewCut& wanted) {
    CutRecord cut;
    cut.id = new_id("c_");
    cut.job = wanted.job;
    SQLite::Statement insert(database,
                             "INSERT INTO cut(id, job, device, sheets, state, created_ms, "
                             "updated_ms) VALUES(?, ?, ?, ?, 'waiting', ?, ?)");
    const std::int64_t now = wall_clock_ms();
    insert.bind(1, cut.id);
    insert.bind(2, cut.job);
    insert.bind(3, wanted.device);
    insert.bind(4, joined(wanted.sheets));
    insert.bind(5, now);
    insert.bind(6, now);
    insert.exec();
    tell(database, cut, "waiting");
    tell_job_of(database, cut, "cut waiting");
    return cut.id;
}

// It ended early, and no other cut has begun, or is to begin, its rest: nothing is burnt twice.
bool is_open_ended(SQLite::Database& database, const CutRecord& cut) {
    if (!is_final(cut.state) || cut.state == CutState::Done) {
        return false;
    }
    SQLite::Statement rest(
        database,
        "SELECT 1 FROM cut WHERE rest_of = ? AND NOT (state = 'aborted' AND NOT EXISTS("
        "SELECT 1 FROM cut_intent WHERE cut_intent.cut = cut.id)) LIMIT 1");
    rest.bind(1, cut.id);
    return !rest.executeStep();
}

}  // namespace

std::vector<CutRecord> SqliteCutStore::add(const std::string& job,
                                           const std::vector<CutWish>& wishes) {
    std::vector<CutRecord> cuts;
    database_.write([&](SQLite::Database& database) {
        for (const CutWish& wish : wishes) {
            std::vector<int> sheets = wish.sheets;
            check_sheets(database, job, sheets);
            const std::string id = insert_cut(database, {job, wish.device, sheets});
            cuts.push_back(find_cut(database, id).value());
        }
    });
    return cuts;
}

std::optional<CutRecord> SqliteCutStore::find(const std::string& id) const {
    std::optional<CutRecord> cut;
    database_.read([&](SQLite::Database& database) { cut = find_cut(database, id); });
    return cut;
}

std::vector<CutRecord> SqliteCutStore::list(int limit) const {
    std::vector<CutRecord> cuts;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                std::string(kSelectCut) + "ORDER BY ordinal DESC LIMIT ?");
        query.bind(1, limit);
        while (query.executeStep()) {
            cuts.push_back(cut_from(database, query));
        }
    });
    return cuts;
}

std::vector<CutRecord> SqliteCutStore::open_on(const std::string& device) const {
    std::vector<CutRecord> cuts;
    database_.read([&](SQLite::Database& database) { cuts = open_cuts(database, device); });
    return cuts;
}

bool SqliteCutStore::move(const std::string& id,
                          CutState from,
                          CutState to,
                          const std::string& reason) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        const auto cut = find_cut(database, id);
        moved = cut && cut->state == from && move_cut(database, *cut, to, reason);
    });
    return moved;
}

bool SqliteCutStore::arm(const CutRecord& wanted) {
    bool armed = false;
    database_.write([&](SQLite::Database& database) {
        for (const CutRecord& other : open_cuts(database, wanted.device)) {
            if (other.id != wanted.id && occupies_device(other.state)) {
                return;
            }
        }
        const auto cut = find_cut(database, wanted.id);
        armed = cut && cut->state == wanted.state && cut->position == wanted.position &&
                move_cut(database, *cut, CutState::Armed, "");
    });
    return armed;
}

bool SqliteCutStore::begin_sheet(const CutRecord& cut) {
    bool begun = false;
    database_.write([&](SQLite::Database& database) {
        if (cut.state != CutState::Armed || !move_cut(database, cut, CutState::Cutting, "")) {
            return;
        }
        set_progress(database, cut.id, {});
        SQLite::Statement intent(
            database,
            "INSERT INTO cut_intent(cut, sheet, program_sha256, at_ms) VALUES(?, ?, ?, ?)");
        intent.bind(1, cut.id);
        intent.bind(2, cut.sheet());
        intent.bind(3, cut.program_sha256);
        intent.bind(4, wall_clock_ms());
        crash_point("begin-sheet.before-intent");
        intent.exec();
        begun = true;
    });
    return begun;
}

bool SqliteCutStore::finish_sheet(const CutRecord& wanted, const CutProgress& progress) {
    bool finished = false;
    database_.write([&](SQLite::Database& database) {
        const auto cut = find_cut(database, wanted.id);
        if (!cut || (cut->state != CutState::Cutting && cut->state != CutState::Paused)) {
            return;
        }
        set_progress(database, cut->id, progress);
        count_sheet_as_cut(database, *cut);
        if (!cut->on_last_sheet()) {
            SQLite::Statement next(database, "UPDATE cut SET position = position + 1 WHERE id = ?");
            next.bind(1, cut->id);
            next.exec();
            set_progress(database, cut->id, {});
        }
        finished = move_cut(database, *cut,
                            cut->on_last_sheet() ? CutState::Done : CutState::AwaitingSheet, "");
    });
    return finished;
}

void SqliteCutStore::record_progress(const std::string& id, const CutProgress& progress) {
    database_.write([&](SQLite::Database& database) { set_progress(database, id, progress); });
}

void SqliteCutStore::record_beam(const std::string& id, const BeamRecord& beam) {
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement update(database,
                                 "UPDATE cut SET beam = ?, version = version + 1 WHERE id = ?");
        update.bind(1, written(beam));
        update.bind(2, id);
        update.exec();
        if (const auto cut = find_cut(database, id)) {
            tell(database, *cut,
                 fmt::format("beam: {:.1f} to {:.1f} of {:.1f} mm burnt", beam.least_mm,
                             beam.most_mm, beam.total_mm));
        }
    });
}

bool SqliteCutStore::may_be_finished(const CutRecord& cut) const {
    bool free = false;
    database_.read([&](SQLite::Database& database) { free = is_open_ended(database, cut); });
    return free;
}

std::optional<CutRecord> SqliteCutStore::add_rest(const CutRecord& of,
                                                  const std::string& program_sha256) {
    std::optional<CutRecord> added;
    database_.write([&](SQLite::Database& database) {
        const auto cut = find_cut(database, of.id);
        if (!cut || cut->version != of.version || !is_open_ended(database, *cut)) {
            return;
        }
        const std::vector<int> sheets(
            cut->sheets.begin() + static_cast<std::ptrdiff_t>(cut->position), cut->sheets.end());
        const std::string id = insert_cut(database, {cut->job, cut->device, sheets});
        SQLite::Statement rest(database,
                               "UPDATE cut SET rest_of = ?, rest_sha256 = ? WHERE id = ?");
        rest.bind(1, cut->id);
        rest.bind(2, program_sha256);
        rest.bind(3, id);
        rest.exec();
        tell(database, *cut, fmt::format("its rest is {}", id));
        added = find_cut(database, id);
    });
    return added;
}

std::optional<CutRecord> SqliteCutStore::last_begun_on(const std::string& device) const {
    std::optional<CutRecord> cut;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                "SELECT cut_intent.cut FROM cut_intent JOIN cut ON cut.id = "
                                "cut_intent.cut WHERE cut.device = ? ORDER BY cut_intent.id DESC "
                                "LIMIT 1");
        query.bind(1, device);
        if (query.executeStep()) {
            cut = find_cut(database, query.getColumn(0).getString());
        }
    });
    return cut;
}

std::int64_t SqliteCutStore::count(CutState state) const {
    std::int64_t counted = 0;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database, "SELECT count(*) FROM cut WHERE state = ?");
        query.bind(1, std::string(to_string(state)));
        counted = query.executeStep() ? query.getColumn(0).getInt64() : 0;
    });
    return counted;
}

std::vector<std::string> SqliteCutStore::recover() {
    std::vector<std::string> devices;
    database_.write([&](SQLite::Database& database) {
        std::vector<CutRecord> open;
        SQLite::Statement query(
            database, std::string(kSelectCut) + "WHERE state IN ('armed','cutting','paused')");
        while (query.executeStep()) {
            open.push_back(cut_from(database, query));
        }
        for (const CutRecord& cut : open) {
            if (cut.state == CutState::Armed) {
                move_cut(database, cut, cut.before_arming(), "");
                continue;
            }
            devices.push_back(cut.device);
            move_cut(
                database, cut, CutState::Interrupted,
                fmt::format("the daemon died while sheet {} was being cut: at least {} of {} lines "
                            "were done; finish its rest if that is offered, or cut this sheet "
                            "again on fresh material",
                            cut.sheet(), cut.lines_acknowledged, cut.lines_total));
        }
    });
    return devices;
}

}  // namespace leafcutter::server
