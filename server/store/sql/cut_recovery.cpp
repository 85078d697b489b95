// The part of SqlCutStore that says what is so after somebody was away.

#include <fmt/format.h>

#include "server/store/sql/cut_rows.h"
#include "server/store/sql/cuts.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

bool SqlCutStore::reclaim(const CutRecord& in_work) {
    const auto seen = find(in_work.id);
    if (!seen || seen->state != CutState::Interrupted) {
        return false;
    }
    bool reclaimed = false;
    database_.write([&](SqlSession& session) {
        const auto cut = find_cut(session, in_work.id);
        reclaimed = cut && cut->state == CutState::Interrupted && cut->owner == scope_.node &&
                    cut->position == in_work.position && is_open_ended(session, *cut);
        if (!reclaimed) {
            return;
        }
        SqlStatement update(session,
                            "UPDATE cut SET state = ?, reason = '', version = version + 1, "
                            "updated_ms = ? WHERE id = ?");
        update.bind(1, to_string(in_work.state));
        update.bind(2, session.now_ms());
        update.bind(3, cut->id);
        update.run();
        tell(session, *cut,
             fmt::format("interrupted -> {}: its station is back and never stopped",
                         to_string(in_work.state)));
        tell_job_of(session, *cut, fmt::format("cut {}", to_string(in_work.state)));
    });
    return reclaimed;
}

std::vector<CutRecord> SqlCutStore::in_hand() const {
    std::vector<CutRecord> cuts;
    database_.read([&](SqlSession& session) {
        cuts.clear();
        SqlStatement query(
            session, std::string(kSelectCut) + "WHERE state IN ('cutting','paused') AND owner = ?");
        query.bind(1, scope_.node);
        while (query.step()) {
            cuts.push_back(cut_from(session, query));
        }
    });
    return cuts;
}

std::vector<std::string> SqlCutStore::recover() {
    std::vector<std::string> devices;
    database_.write([&](SqlSession& session) {
        std::vector<CutRecord> open;
        SqlStatement query(session,
                           std::string(kSelectCut) + "WHERE state IN ('armed','cutting','paused')");
        while (query.step()) {
            open.push_back(cut_from(session, query));
        }
        for (const CutRecord& cut : open) {
            if (cut.state == CutState::Armed) {
                move_cut(session, cut, cut.before_arming(), "");
                continue;
            }
            devices.push_back(cut.device);
            move_cut(
                session, cut, CutState::Interrupted,
                fmt::format("the daemon died while sheet {} was being cut: at least {} of {} lines "
                            "were done; finish its rest if that is offered, or cut this sheet "
                            "again on fresh material",
                            cut.sheet(), cut.lines_acknowledged, cut.lines_total));
        }
    });
    return devices;
}

}  // namespace leafcutter::server
