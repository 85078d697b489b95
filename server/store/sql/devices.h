// Machines in SQL.

#pragma once

#include "server/store/device_store.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlDeviceStore final : public DeviceStore {
public:
    explicit SqlDeviceStore(SqlDatabase& database) : database_(database) {}

    std::vector<DeviceRecord> list() const override;
    std::optional<DeviceRecord> find(const std::string& id) const override;
    void put(const DeviceRecord& device) override;
    bool remove(const std::string& id) override;

private:
    SqlDatabase& database_;
};

}  // namespace leafcutter::server
