// How long what is kept: a setting that an administrator changes at run time.

#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "server/store/settings.h"

namespace leafcutter::server {

struct Retention {
    int jobs_days = 0;      // After a job's end; 0: for ever.
    int packages_days = 0;  // Likewise; its row stays.
    int events_days = 90;
    int backup_every_min = 60;  // 0: never by itself.
    int backups_kept = 24;
};

Retention retention_of(const Settings& settings);
void put_retention(Settings& settings, const Retention& retention);

nlohmann::json retention_to_json(const Retention& retention);

// What is absent keeps its value. Throws geometry::Error(BadOption).
Retention retention_from_json(const nlohmann::json& value, Retention retention);

}  // namespace leafcutter::server
