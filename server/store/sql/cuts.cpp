#include "server/store/sql/cuts.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/store/ids.h"
#include "server/store/sql/cut_rows.h"
#include "server/store/sql/events.h"
#include "server/store/sql/fleet.h"
#include "server/store/sql/idempotency.h"
#include "server/store/sql/job_rows.h"
#include "server/store/sql/session.h"
#include "server/store/sql/stock.h"

namespace leafcutter::server {

namespace {

void set_progress(SqlSession& session, const std::string& id, const CutProgress& progress) {
    SqlStatement update(
        session,
        "UPDATE cut SET lines_total = ?, lines_sent = ?, lines_acknowledged = ? WHERE id = ?");
    update.bind(1, progress.lines_total);
    update.bind(2, progress.lines_sent);
    update.bind(3, progress.lines_acknowledged);
    update.bind(4, id);
    update.run();
}

enum class Which { All, Uncut };

std::vector<int> sheets_of(SqlSession& session, const std::string& job, Which which) {
    SqlStatement query(session,
                       "SELECT number, cut FROM sheet WHERE job = ? AND program_sha256 <> '' "
                       "ORDER BY number");
    query.bind(1, job);
    std::vector<int> sheets;
    while (query.step()) {
        if (which == Which::All || query.column(1).integer() == 0) {
            sheets.push_back(query.column(0).integer());
        }
    }
    return sheets;
}

void check_sheets(SqlSession& session, const std::string& job, std::vector<int>& sheets) {
    SqlStatement state(session, "SELECT state FROM job WHERE id = ?");
    state.bind(1, job);
    const std::string found = state.step() ? state.column(0).text() : "gone";
    if (found != "ready" && found != "done") {
        throw NotCuttable(fmt::format("the job is {}: only a ready one can be cut", found));
    }
    const std::vector<int> all = sheets_of(session, job, Which::All);
    if (sheets.empty()) {
        sheets = sheets_of(session, job, Which::Uncut);
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

void count_sheet_as_cut(SqlSession& session, const CutRecord& cut) {
    SqlStatement mark(session, "UPDATE sheet SET cut = 1 WHERE job = ? AND number = ? AND cut = 0");
    mark.bind(1, cut.job);
    mark.bind(2, cut.sheet());
    if (mark.run() > 0) {
        book_cut_sheet(session, cut.job, cut.sheet());
    }
    if (!sheets_of(session, cut.job, Which::Uncut).empty() ||
        !move_job(session, cut.job, JobState::Ready, JobState::Done)) {
        tell_job_of(session, cut, fmt::format("sheet {} cut", cut.sheet()));
    }
}

void disarm(SqlSession& session, const CutRecord& cut, const std::string& why) {
    if (cut.state == CutState::Armed) {
        move_cut(session, cut, cut.before_arming(), why);
    }
}

struct Holder {
    std::string node;
    std::int64_t fence = 0;
};

void set_holder(SqlSession& session, const std::string& id, const Holder& holder) {
    SqlStatement update(session, "UPDATE cut SET owner = ?, fence = ? WHERE id = ?");
    update.bind(1, holder.node);
    update.bind(2, holder.fence);
    update.bind(3, id);
    update.run();
}

struct NewCut {
    std::string job;
    std::string device;
    std::vector<int> sheets;
};

// Returns its id.
std::string insert_cut(SqlSession& session, const NewCut& wanted) {
    CutRecord cut;
    cut.id = new_id("c_");
    cut.job = wanted.job;
    SqlStatement insert(session,
                        "INSERT INTO cut(id, job, device, sheets, state, created_ms, "
                        "updated_ms) VALUES(?, ?, ?, ?, 'waiting', ?, ?)");
    const std::int64_t now = session.now_ms();
    insert.bind(1, cut.id);
    insert.bind(2, cut.job);
    insert.bind(3, wanted.device);
    insert.bind(4, joined(wanted.sheets));
    insert.bind(5, now);
    insert.bind(6, now);
    insert.run();
    tell(session, cut, "waiting");
    tell_job_of(session, cut, "cut waiting");
    return cut.id;
}

// Those of them that are still there.
std::vector<CutRecord> cuts_made_with(SqlSession& session, const IdempotencyKey& key) {
    std::vector<CutRecord> cuts;
    std::istringstream ids(made_with(session, key).value_or(""));
    for (std::string id; ids >> id;) {
        if (auto cut = find_cut(session, id)) {
            cuts.push_back(*std::move(cut));
        }
    }
    return cuts;
}

}  // namespace

std::vector<CutRecord> SqlCutStore::add(const std::string& job,
                                        const std::vector<CutWish>& wishes,
                                        const std::optional<IdempotencyKey>& key) {
    std::vector<CutRecord> cuts;
    database_.write([&](SqlSession& session) {
        cuts = key ? cuts_made_with(session, *key) : std::vector<CutRecord>{};
        if (!cuts.empty()) {
            return;
        }
        std::vector<std::string> ids;
        for (const CutWish& wish : wishes) {
            std::vector<int> sheets = wish.sheets;
            check_sheets(session, job, sheets);
            ids.push_back(insert_cut(session, {job, wish.device, sheets}));
            cuts.push_back(find_cut(session, ids.back()).value());
        }
        if (key) {
            remember_key(session, *key, fmt::format("{}", fmt::join(ids, " ")));
        }
    });
    return cuts;
}

std::optional<CutRecord> SqlCutStore::find(const std::string& id) const {
    std::optional<CutRecord> cut;
    database_.read([&](SqlSession& session) { cut = find_cut(session, id); });
    return cut;
}

std::vector<CutRecord> SqlCutStore::list(int limit,
                                         std::optional<std::int64_t> below_ordinal) const {
    std::vector<CutRecord> cuts;
    database_.read([&](SqlSession& session) {
        SqlStatement query(
            session, std::string(kSelectCut) + "WHERE ordinal < ? ORDER BY ordinal DESC LIMIT ?");
        query.bind(1, below_ordinal.value_or(std::numeric_limits<std::int64_t>::max()));
        query.bind(2, limit);
        while (query.step()) {
            cuts.push_back(cut_from(session, query));
        }
    });
    return cuts;
}

std::vector<CutRecord> SqlCutStore::open_on(const std::string& device) const {
    std::vector<CutRecord> cuts;
    database_.read([&](SqlSession& session) { cuts = open_cuts(session, device); });
    return cuts;
}

bool SqlCutStore::move(const std::string& id,
                       CutState from,
                       CutState to,
                       const std::string& reason) {
    bool moved = false;
    database_.write([&](SqlSession& session) {
        const auto cut = find_cut(session, id);
        moved = cut && cut->state == from && move_cut(session, *cut, to, reason);
    });
    return moved;
}

bool SqlCutStore::arm(const CutRecord& wanted) {
    bool armed = false;
    database_.write([&](SqlSession& session) {
        for (const CutRecord& other : open_cuts(session, wanted.device)) {
            if (other.id != wanted.id && occupies_device(other.state)) {
                return;
            }
        }
        const auto cut = find_cut(session, wanted.id);
        armed = cut && cut->state == wanted.state && cut->position == wanted.position &&
                move_cut(session, *cut, CutState::Armed, "");
    });
    return armed;
}

bool SqlCutStore::begin_sheet(const CutRecord& cut) {
    bool begun = false;
    database_.write([&](SqlSession& session) {
        const std::optional<std::int64_t> fence = held_fence(session, scope_, cut.device);
        if (!fence || !is_active(session, scope_)) {
            begun = false;
            disarm(session, cut,
                   fence ? "its station takes up no work now"
                         : "its station does not hold the machine now");
            return;
        }
        if (cut.state != CutState::Armed || !move_cut(session, cut, CutState::Cutting, "")) {
            return;
        }
        set_progress(session, cut.id, {});
        set_holder(session, cut.id, {scope_.node, *fence});
        SqlStatement intent(
            session,
            "INSERT INTO cut_intent(cut, sheet, program_sha256, at_ms) VALUES(?, ?, ?, ?)");
        intent.bind(1, cut.id);
        intent.bind(2, cut.sheet());
        intent.bind(3, cut.program_sha256);
        intent.bind(4, session.now_ms());
        crash_point("begin-sheet.before-intent");
        intent.run();
        begun = true;
    });
    return begun;
}

bool SqlCutStore::finish_sheet(const CutRecord& wanted, const CutProgress& progress) {
    bool finished = false;
    database_.write([&](SqlSession& session) {
        const auto cut = find_cut(session, wanted.id);
        if (!cut || (cut->state != CutState::Cutting && cut->state != CutState::Paused)) {
            return;
        }
        set_progress(session, cut->id, progress);
        count_sheet_as_cut(session, *cut);
        if (!cut->on_last_sheet()) {
            SqlStatement next(session, "UPDATE cut SET position = position + 1 WHERE id = ?");
            next.bind(1, cut->id);
            next.run();
            set_progress(session, cut->id, {});
        }
        finished = move_cut(session, *cut,
                            cut->on_last_sheet() ? CutState::Done : CutState::AwaitingSheet, "");
    });
    return finished;
}

void SqlCutStore::record_progress(const std::string& id, const CutProgress& progress) {
    database_.write_soon(
        id, [id, progress](SqlSession& session) { set_progress(session, id, progress); });
}

void SqlCutStore::record_beam(const std::string& id, const BeamRecord& beam) {
    database_.write([&](SqlSession& session) {
        SqlStatement update(session, "UPDATE cut SET beam = ?, version = version + 1 WHERE id = ?");
        update.bind(1, written(beam));
        update.bind(2, id);
        update.run();
        if (const auto cut = find_cut(session, id)) {
            tell(session, *cut,
                 fmt::format("beam: {:.1f} to {:.1f} of {:.1f} mm burnt", beam.least_mm,
                             beam.most_mm, beam.total_mm));
        }
    });
}

bool SqlCutStore::may_be_finished(const CutRecord& cut) const {
    bool free = false;
    database_.read([&](SqlSession& session) { free = is_open_ended(session, cut); });
    return free;
}

std::optional<CutRecord> SqlCutStore::add_rest(const CutRecord& of,
                                               const std::string& program_sha256) {
    std::optional<CutRecord> added;
    database_.write([&](SqlSession& session) {
        const auto cut = find_cut(session, of.id);
        if (!cut || cut->version != of.version || !is_open_ended(session, *cut)) {
            return;
        }
        const std::vector<int> sheets(
            cut->sheets.begin() + static_cast<std::ptrdiff_t>(cut->position), cut->sheets.end());
        const std::string id = insert_cut(session, {cut->job, cut->device, sheets});
        SqlStatement rest(session, "UPDATE cut SET rest_of = ?, rest_sha256 = ? WHERE id = ?");
        rest.bind(1, cut->id);
        rest.bind(2, program_sha256);
        rest.bind(3, id);
        rest.run();
        tell(session, *cut, fmt::format("its rest is {}", id));
        added = find_cut(session, id);
    });
    return added;
}

std::optional<CutRecord> SqlCutStore::last_begun_on(const std::string& device) const {
    std::optional<CutRecord> cut;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session,
                           "SELECT cut_intent.cut FROM cut_intent JOIN cut ON cut.id = "
                           "cut_intent.cut WHERE cut.device = ? ORDER BY cut_intent.id DESC "
                           "LIMIT 1");
        query.bind(1, device);
        if (query.step()) {
            cut = find_cut(session, query.column(0).text());
        }
    });
    return cut;
}

std::int64_t SqlCutStore::count(CutState state) const {
    std::int64_t counted = 0;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session, "SELECT count(*) FROM cut WHERE state = ?");
        query.bind(1, std::string(to_string(state)));
        counted = query.step() ? query.column(0).int64() : 0;
    });
    return counted;
}

}  // namespace leafcutter::server
