// Nodes and leases in SQL.

#pragma once

#include "server/store/fleet_store.h"

namespace leafcutter::server {

class SqlDatabase;
class SqlSession;

class SqlFleetStore final : public FleetStore {
public:
    SqlFleetStore(SqlDatabase& database, const NodeScope& scope)
        : database_(database), scope_(scope) {}

    NodeMode beat(const NodeRecord& node) override;
    std::vector<NodeRecord> nodes() const override;
    bool set_mode(const std::string& id, NodeMode mode) override;
    bool forget(const std::string& id) override;
    std::vector<std::string> renew(const std::vector<JobLease>& jobs) override;
    void adopt_machines() override;
    std::vector<MachineLease> hold_machines() override;
    void let_go_of_machines() override;
    std::vector<MachineLease> machine_leases() const override;
    std::vector<std::string> hold_duties(const std::vector<std::string>& duties) override;
    std::vector<MachineLease> duty_leases() const override;
    Reaped reap() override;

private:
    std::vector<MachineLease> leases(bool of_duties) const;

    SqlDatabase& database_;
    const NodeScope scope_;
};

// Within a transaction: whether the node may take up work.
bool is_active(SqlSession& session, const NodeScope& scope);

// The fence of a machine's lease that the node holds now; nothing: it holds none.
std::optional<std::int64_t> held_fence(SqlSession& session,
                                       const NodeScope& scope,
                                       const std::string& device);

}  // namespace leafcutter::server
