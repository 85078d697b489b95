#include "server/store/sqlite/devices.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/database.h"

namespace leafcutter::server {

std::vector<DeviceRecord> SqliteDeviceStore::list() const {
    std::vector<DeviceRecord> devices;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                "SELECT id, name, uri, auto_start, bed_width_mm, bed_height_mm "
                                "FROM device ORDER BY id");
        while (query.executeStep()) {
            devices.push_back({query.getColumn(0).getString(),
                               query.getColumn(1).getString(),
                               query.getColumn(2).getString(),
                               query.getColumn(3).getInt() != 0,
                               {query.getColumn(4).getDouble(), query.getColumn(5).getDouble()}});
        }
    });
    return devices;
}

std::optional<DeviceRecord> SqliteDeviceStore::find(const std::string& id) const {
    for (DeviceRecord& device : list()) {
        if (device.id == id) {
            return std::move(device);
        }
    }
    return std::nullopt;
}

void SqliteDeviceStore::put(const DeviceRecord& device) {
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement upsert(database,
                                 "INSERT OR REPLACE INTO device(id, name, uri, auto_start, "
                                 "bed_width_mm, bed_height_mm) VALUES(?, ?, ?, ?, ?, ?)");
        upsert.bind(1, device.id);
        upsert.bind(2, device.name);
        upsert.bind(3, device.uri);
        upsert.bind(4, device.auto_start ? 1 : 0);
        upsert.bind(5, device.bed_mm[0]);
        upsert.bind(6, device.bed_mm[1]);
        upsert.exec();
    });
}

bool SqliteDeviceStore::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement erase(database, "DELETE FROM device WHERE id = ?");
        erase.bind(1, id);
        removed = erase.exec() > 0;
    });
    return removed;
}

}  // namespace leafcutter::server
