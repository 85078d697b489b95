// The runners of all machines, by the machine's id. Safe from any thread.

#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/usb_watch.h"
#include "server/queue/device_runner.h"

namespace leafcutter::server {

class DeviceFleet {
public:
    // Starts a runner for every machine of the store that hangs on this node.
    DeviceFleet(Store& store, DeviceHooks hooks);

    // Shared: a request may still use a runner that is being removed.
    std::shared_ptr<DeviceRunner> find(const std::string& id) const;
    std::vector<std::shared_ptr<DeviceRunner>> all() const;

    // Puts a runner in the place of the one there was. Throws drivers::Refused while that one has a
    // cut in work.
    void put(const DeviceRecord& device);
    void remove(const std::string& id);

    // Sheets in work go on, nothing else is begun; returns when no machine is at work.
    void finish_sheets();

    // Stops every machine, each holding its cut; returns when all stand.
    void stop_all();

private:
    void check_idle(const std::string& id) const;

    Store& store_;
    const DeviceHooks hooks_;
    std::mutex changing_;       // One put or remove at a time: each waits for a runner's end.
    mutable std::mutex mutex_;  // Guards runners_.
    std::map<std::string, std::shared_ptr<DeviceRunner>> runners_;
    std::unique_ptr<drivers::UsbWatch> usb_watch_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
