#include "server/retention.h"

#include <nlohmann/json.hpp>

#include "server/json_reader.h"

namespace leafcutter::server {

namespace {

constexpr const char* kKey = "retention";

}  // namespace

nlohmann::json retention_to_json(const Retention& retention) {
    return {{"jobs_days", retention.jobs_days},
            {"packages_days", retention.packages_days},
            {"events_days", retention.events_days},
            {"backup_every_min", retention.backup_every_min},
            {"backups_kept", retention.backups_kept}};
}

Retention retention_from_json(const nlohmann::json& value, Retention retention) {
    constexpr Range kDays{0.0, 36500.0};
    constexpr Range kMinutes{0.0, 525600.0};
    constexpr Range kCopies{1.0, 1000.0};
    ObjectReader reader(value, "");
    reader.integer("jobs_days", retention.jobs_days, kDays);
    reader.integer("packages_days", retention.packages_days, kDays);
    reader.integer("events_days", retention.events_days, kDays);
    reader.integer("backup_every_min", retention.backup_every_min, kMinutes);
    reader.integer("backups_kept", retention.backups_kept, kCopies);
    reader.finish();
    return retention;
}

Retention retention_of(const Settings& settings) {
    const auto stored = settings.get(kKey);
    return stored ? retention_from_json(nlohmann::json::parse(*stored), {}) : Retention{};
}

void put_retention(Settings& settings, const Retention& retention) {
    settings.put(kKey, retention_to_json(retention).dump());
}

}  // namespace leafcutter::server
