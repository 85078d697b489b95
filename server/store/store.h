// Everything the daemon remembers, in one folder: leafcutter.db and blobs/.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/store/account_store.h"
#include "server/store/blobs.h"
#include "server/store/cut_store.h"
#include "server/store/database.h"
#include "server/store/device_store.h"
#include "server/store/event_log.h"
#include "server/store/job_store.h"
#include "server/store/material_store.h"
#include "server/store/state_dir.h"
#include "server/store/webhook_store.h"

namespace leafcutter::server {

struct Store {
    // Locks the folder, opens, migrates and recovers. `after_commit` is called by the writer's
    // thread and must not wait. Throws StateDirUnusable, DatabaseUnusable.
    Store(const std::filesystem::path& folder, std::function<void()> after_commit);

    StateDir folder;
    Database database;
    Blobs blobs;
    JobStore jobs;
    CutStore cuts;
    DeviceStore devices;
    MaterialStore materials;
    EventLog events;
    AccountStore accounts;
    WebhookStore webhooks;
    std::vector<std::string> interrupted_devices;  // Whose cut a dead daemon left in mid-beam.
};

}  // namespace leafcutter::server
