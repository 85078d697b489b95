// Machines in SQLite.

#pragma once

#include "server/store/device_store.h"

namespace leafcutter::server {

class Database;

class SqliteDeviceStore final : public DeviceStore {
public:
    explicit SqliteDeviceStore(Database& database) : database_(database) {}

    std::vector<DeviceRecord> list() const override;
    std::optional<DeviceRecord> find(const std::string& id) const override;
    void put(const DeviceRecord& device) override;
    bool remove(const std::string& id) override;

private:
    Database& database_;
};

}  // namespace leafcutter::server
