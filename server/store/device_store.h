// The machines this daemon knows.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class Database;

class DeviceStore {
public:
    explicit DeviceStore(Database& database) : database_(database) {}

    std::vector<DeviceRecord> list() const;
    std::optional<DeviceRecord> find(const std::string& id) const;
    void put(const DeviceRecord& device);
    bool remove(const std::string& id);

private:
    Database& database_;
};

}  // namespace leafcutter::server
