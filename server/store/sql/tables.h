// The stores of an engine that speaks SQL: all of an Engine but what its kind of database does by
// itself.

#pragma once

#include "server/store/engine.h"
#include "server/store/sql/accounts.h"
#include "server/store/sql/cuts.h"
#include "server/store/sql/devices.h"
#include "server/store/sql/events.h"
#include "server/store/sql/fleet.h"
#include "server/store/sql/jobs.h"
#include "server/store/sql/named_records.h"
#include "server/store/sql/settings.h"
#include "server/store/sql/stock.h"

namespace leafcutter::server {

class SqlTables : public Engine {
public:
    // `database` outlives this.
    SqlTables(SqlDatabase& database, const NodeScope& scope);

    JobStore& jobs() override { return jobs_; }
    CutStore& cuts() override { return cuts_; }
    DeviceStore& devices() override { return devices_; }
    StockStore& stock() override { return stock_; }
    NamedRecords& materials() override { return materials_; }
    NamedRecords& presets() override { return presets_; }
    Settings& settings() override { return settings_; }
    EventLog& events() override { return events_; }
    AccountStore& accounts() override { return accounts_; }
    FleetStore& fleet() override { return fleet_; }
    QueueAges queue_ages() const override;

private:
    SqlDatabase& rows_;
    SqlJobStore jobs_;
    SqlCutStore cuts_;
    SqlDeviceStore devices_;
    SqlStockStore stock_;
    SqlNamedRecords materials_;
    SqlNamedRecords presets_;
    SqlSettings settings_;
    SqlEventLog events_;
    SqlAccountStore accounts_;
    SqlFleetStore fleet_;
};

}  // namespace leafcutter::server
