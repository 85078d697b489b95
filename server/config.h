// How the daemon is set up: a TOML file, overruled by the command line.

#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/fleet/node_role.h"
#include "server/log_format.h"
#include "server/queue/device_runner.h"
#include "server/store/records.h"
#include "server/webhook/webhook.h"

namespace leafcutter::server {

// The configuration is wrong; the message names the file, the line or the key.
class BadConfig : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct ListenAddress {
    std::string address = "127.0.0.1";
    int port = 8080;
};

struct Config {
    ListenAddress listen;
    std::filesystem::path state;               // Empty: default_state_dir().
    std::vector<std::string> hosts;            // Further names in Host headers that are ours.
    std::vector<std::string> trusted_proxies;  // Addresses whose X-Forwarded-… are believed.
    unsigned http_workers = 8;
    unsigned compute_workers = 1;
    unsigned threads_per_job = 0;  // 0: as many as the machine has.
    unsigned job_memory_mb = 0;  // Of one computation; 0: three quarters of the machine's, shared.
    unsigned job_minutes = 60;   // Likewise its time.
    StopPolicy stop_policy = StopPolicy::Pause;
    LogFormat log_format = LogFormat::Text;
    std::vector<DeviceRecord> devices;
    std::vector<WebhookConfig> webhooks;

    // Of a fleet; see server/fleet/README.md.
    std::string store;  // "postgresql://…"; empty: SQLite in the state folder, and no fleet.
    NodeRole role = NodeRole::All;
    std::string node;       // This node's name among the others; empty: the host's.
    std::string advertise;  // Where others reach it; empty: http:// and the listening address.
    std::string fleet_key;  // What the nodes know each other by.
    unsigned lease_s = 30;  // A node that was silent for so long is taken for lost.
};

// "127.0.0.1:8080", "[::1]:8080", "0.0.0.0:8080" or ":8080" (loopback). Throws BadConfig.
ListenAddress parse_listen(const std::string& text);

// What must be so, or not be, of the settings of a fleet. Fills in the node's name. Throws
// BadConfig.
void check_fleet(Config& config);

// Only this host can reach it.
bool is_loopback(const std::string& address);

// Throws BadConfig for what can't be read, unknown keys included.
Config read_config(const std::filesystem::path& file);

// $XDG_STATE_HOME/leafcutter, else ~/.local/state/leafcutter.
std::filesystem::path default_state_dir();

// Throws BadConfig unless `device` has a plain id, a name and a URI this build can open.
void check_device(const DeviceRecord& device);

// The same for a device that comes over the network: its simulated machine may keep a beam log only
// as a file of `burn_logs`, or anyone could have the daemon overwrite any file.
void check_remote_device(const DeviceRecord& device, const std::filesystem::path& burn_logs);

}  // namespace leafcutter::server
