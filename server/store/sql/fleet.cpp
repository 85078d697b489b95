#include "server/store/sql/fleet.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "server/store/job_store.h"
#include "server/store/sql/cut_rows.h"
#include "server/store/sql/events.h"
#include "server/store/sql/job_rows.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

constexpr std::array<std::pair<NodeMode, std::string_view>, 3> kModes{
    {{NodeMode::Active, "active"}, {NodeMode::Paused, "paused"}, {NodeMode::Draining, "draining"}}};

// In the table of machines' leases; no machine's id has a colon.
constexpr std::string_view kDutyPrefix = "duty:";

void tell_node(SqlSession& session, const std::string& id, std::string note) {
    EventRecord event;
    event.type = "node";
    event.subject = id;
    event.note = std::move(note);
    append_event(session, event);
}

std::vector<std::string> machines_of(SqlSession& session, const std::string& station) {
    SqlStatement query(session, "SELECT id FROM device WHERE station = ? ORDER BY id");
    query.bind(1, station);
    std::vector<std::string> machines;
    while (query.step()) {
        machines.push_back(query.column(0).text());
    }
    return machines;
}

// The fence grows with every change of hands, and with every lease that had run out.
void hold(SqlSession& session, const NodeScope& scope, const std::string& device) {
    SqlStatement take(
        session,
        "INSERT INTO machine_lease(device, owner, fence, lease_until_ms) VALUES(?1, ?2, 1, ?3) "
        "ON CONFLICT(device) DO UPDATE SET owner = excluded.owner, lease_until_ms = "
        "excluded.lease_until_ms, fence = machine_lease.fence + CASE WHEN machine_lease.owner = "
        "excluded.owner AND machine_lease.lease_until_ms > ?4 THEN 0 ELSE 1 END "
        "WHERE machine_lease.owner = excluded.owner OR machine_lease.lease_until_ms <= ?4");
    take.bind(1, device);
    take.bind(2, scope.node);
    take.bind(3, session.now_ms() + scope.lease.count());
    take.bind(4, session.now_ms());
    take.run();
}

int reap_jobs(SqlSession& session) {
    std::vector<JobRecord> lost;
    SqlStatement query(session,
                       fmt::format("{} WHERE state = 'computing' AND lease_until_ms > 0 AND "
                                   "lease_until_ms < ?",
                                   kSelectJob));
    query.bind(1, session.now_ms());
    while (query.step()) {
        lost.push_back(job_from(query));
    }
    for (const JobRecord& job : lost) {
        give_back(session, job, fmt::format("the worker {} went away", job.owner));
    }
    return static_cast<int>(lost.size());
}

int reap_cuts(SqlSession& session) {
    std::vector<CutRecord> lost;
    SqlStatement query(session,
                       fmt::format("{}WHERE state IN ('armed','cutting','paused') AND EXISTS("
                                   "SELECT 1 FROM machine_lease WHERE machine_lease.device = "
                                   "cut.device AND lease_until_ms < ?)",
                                   kSelectCut));
    query.bind(1, session.now_ms());
    while (query.step()) {
        lost.push_back(cut_from(session, query));
    }
    for (const CutRecord& cut : lost) {
        if (cut.state == CutState::Armed) {
            move_cut(session, cut, cut.before_arming(), "its station is out of reach");
            continue;
        }
        move_cut(session, cut, CutState::Interrupted,
                 fmt::format("the station {} is out of reach: at least {} of {} lines of sheet {} "
                             "were done, and the machine may still be cutting. Look at it; what "
                             "became of the cut is told when the station is back",
                             cut.owner, cut.lines_acknowledged, cut.lines_total, cut.sheet()));
    }
    return static_cast<int>(lost.size());
}

}  // namespace

std::string_view to_string(NodeMode mode) {
    for (const auto& [candidate, name] : kModes) {
        if (candidate == mode) {
            return name;
        }
    }
    return "active";
}

std::optional<NodeMode> node_mode_named(std::string_view name) {
    for (const auto& [mode, candidate] : kModes) {
        if (candidate == name) {
            return mode;
        }
    }
    return std::nullopt;
}

bool is_active(SqlSession& session, const NodeScope& scope) {
    SqlStatement query(session, "SELECT 1 FROM node WHERE id = ? AND mode <> 'active'");
    query.bind(1, scope.node);
    return !query.step();
}

std::optional<std::int64_t> held_fence(SqlSession& session,
                                       const NodeScope& scope,
                                       const std::string& device) {
    if (scope.lease.count() == 0) {
        return 0;
    }
    SqlStatement query(session,
                       "SELECT fence FROM machine_lease WHERE device = ? AND owner = ? AND "
                       "lease_until_ms > ?");
    query.bind(1, device);
    query.bind(2, scope.node);
    query.bind(3, session.now_ms());
    return query.step() ? std::optional(query.column(0).int64()) : std::nullopt;
}

NodeMode SqlFleetStore::beat(const NodeRecord& node) {
    NodeMode mode = NodeMode::Active;
    database_.write(
        [&](SqlSession& session) {
            SqlStatement known(session, "SELECT mode FROM node WHERE id = ?");
            known.bind(1, node.id);
            const bool is_new = !known.step();
            mode = is_new ? NodeMode::Active
                          : node_mode_named(known.column(0).text()).value_or(NodeMode::Paused);
            SqlStatement upsert(
                session,
                "INSERT INTO node(id, role, url, version, mode, facts, started_ms, seen_ms) "
                "VALUES(?1, ?2, ?3, ?4, 'active', ?5, ?6, ?6) ON CONFLICT(id) DO UPDATE SET "
                "role = excluded.role, url = excluded.url, version = excluded.version, "
                "facts = excluded.facts, seen_ms = excluded.seen_ms");
            upsert.bind(1, node.id);
            upsert.bind(2, node.role);
            upsert.bind(3, node.url);
            upsert.bind(4, node.version);
            upsert.bind(5, node.facts_json);
            upsert.bind(6, session.now_ms());
            upsert.run();
            if (is_new) {
                tell_node(session, node.id, "joined");
            }
        },
        WriteOrder::Beside);
    return mode;
}

std::vector<NodeRecord> SqlFleetStore::nodes() const {
    std::vector<NodeRecord> nodes;
    database_.read([&nodes](SqlSession& session) {
        SqlStatement query(session,
                           "SELECT id, role, url, version, mode, facts, started_ms, seen_ms "
                           "FROM node ORDER BY id");
        nodes.clear();
        while (query.step()) {
            NodeRecord& node = nodes.emplace_back();
            node.id = query.column(0).text();
            node.role = query.column(1).text();
            node.url = query.column(2).text();
            node.version = query.column(3).text();
            node.mode = node_mode_named(query.column(4).text()).value_or(NodeMode::Paused);
            node.facts_json = query.column(5).text();
            node.started_ms = query.column(6).int64();
            node.seen_ms = query.column(7).int64();
            node.silent_ms = session.now_ms() - node.seen_ms;
        }
    });
    return nodes;
}

bool SqlFleetStore::set_mode(const std::string& id, NodeMode mode) {
    bool found = false;
    database_.write([&](SqlSession& session) {
        SqlStatement update(session, "UPDATE node SET mode = ? WHERE id = ?");
        update.bind(1, to_string(mode));
        update.bind(2, id);
        found = update.run() > 0;
        if (found) {
            tell_node(session, id, std::string(to_string(mode)));
        }
    });
    return found;
}

bool SqlFleetStore::forget(const std::string& id) {
    bool found = false;
    database_.write([&](SqlSession& session) {
        SqlStatement erase(session, "DELETE FROM node WHERE id = ?");
        erase.bind(1, id);
        found = erase.run() > 0;
        if (found) {
            tell_node(session, id, "forgotten");
        }
    });
    return found;
}

std::vector<std::string> SqlFleetStore::renew(const std::vector<JobLease>& jobs) {
    std::vector<std::string> lost;
    database_.write(
        [&](SqlSession& session) {
            lost.clear();
            SqlStatement update(session,
                                "UPDATE job SET lease_until_ms = ? WHERE id = ? AND owner = ? AND "
                                "fence = ? AND state = 'computing'");
            for (const JobLease& each : jobs) {
                update.bind(1, session.now_ms() + scope_.lease.count());
                update.bind(2, each.job);
                update.bind(3, scope_.node);
                update.bind(4, each.fence);
                if (update.run() == 0) {
                    lost.push_back(each.job);
                }
            }
        },
        WriteOrder::Beside);
    return lost;
}

void SqlFleetStore::adopt_machines() {
    database_.write([this](SqlSession& session) {
        SqlStatement update(session, "UPDATE device SET station = ? WHERE station = ''");
        update.bind(1, scope_.node);
        update.run();
    });
}

std::vector<MachineLease> SqlFleetStore::hold_machines() {
    std::vector<MachineLease> held;
    database_.write(
        [&](SqlSession& session) {
            held.clear();
            for (const std::string& device : machines_of(session, scope_.node)) {
                hold(session, scope_, device);
                if (const auto fence = held_fence(session, scope_, device)) {
                    held.push_back({device, scope_.node, *fence, scope_.lease.count()});
                }
            }
        },
        WriteOrder::Beside);
    return held;
}

void SqlFleetStore::let_go_of_machines() {
    database_.write(
        [this](SqlSession& session) {
            SqlStatement update(session,
                                "UPDATE machine_lease SET lease_until_ms = ? WHERE owner = ? AND "
                                "lease_until_ms > ?1");
            update.bind(1, session.now_ms());
            update.bind(2, scope_.node);
            update.run();
        },
        WriteOrder::Beside);
}

std::vector<MachineLease> SqlFleetStore::machine_leases() const {
    return leases(/*of_duties=*/false);
}

std::vector<std::string> SqlFleetStore::hold_duties(const std::vector<std::string>& duties) {
    std::vector<std::string> held;
    database_.write(
        [&](SqlSession& session) {
            held.clear();
            for (const std::string& duty : duties) {
                const std::string name = fmt::format("{}{}", kDutyPrefix, duty);
                hold(session, scope_, name);
                if (held_fence(session, scope_, name)) {
                    held.push_back(duty);
                }
            }
        },
        WriteOrder::Beside);
    return held;
}

std::vector<MachineLease> SqlFleetStore::duty_leases() const {
    return leases(/*of_duties=*/true);
}

std::vector<MachineLease> SqlFleetStore::leases(bool of_duties) const {
    std::vector<MachineLease> leases;
    database_.read([&leases, of_duties](SqlSession& session) {
        leases.clear();
        SqlStatement query(session,
                           "SELECT device, owner, fence, lease_until_ms FROM machine_lease "
                           "ORDER BY device");
        while (query.step()) {
            const std::string name = query.column(0).text();
            const bool is_duty = name.starts_with(kDutyPrefix);
            if (is_duty == of_duties) {
                leases.push_back({is_duty ? name.substr(kDutyPrefix.size()) : name,
                                  query.column(1).text(), query.column(2).int64(),
                                  query.column(3).int64() - session.now_ms()});
            }
        }
    });
    return leases;
}

Reaped SqlFleetStore::reap() {
    Reaped reaped;
    database_.write([&reaped](SqlSession& session) {
        reaped = {reap_jobs(session), reap_cuts(session)};
    });
    return reaped;
}

}  // namespace leafcutter::server
