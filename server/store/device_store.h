// The machines this daemon knows.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class DeviceStore {
public:
    virtual ~DeviceStore() = default;

    virtual std::vector<DeviceRecord> list() const = 0;
    virtual std::optional<DeviceRecord> find(const std::string& id) const = 0;
    virtual void put(const DeviceRecord& device) = 0;
    virtual bool remove(const std::string& id) = 0;
};

}  // namespace leafcutter::server
