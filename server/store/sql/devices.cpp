#include "server/store/sql/devices.h"

#include "server/store/sql/session.h"

namespace leafcutter::server {

std::vector<DeviceRecord> SqlDeviceStore::list() const {
    std::vector<DeviceRecord> devices;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session,
                           "SELECT id, name, uri, auto_start, bed_width_mm, bed_height_mm, station "
                           "FROM device ORDER BY id");
        while (query.step()) {
            devices.push_back({query.column(0).text(),
                               query.column(1).text(),
                               query.column(2).text(),
                               query.column(3).integer() != 0,
                               {query.column(4).real(), query.column(5).real()},
                               query.column(6).text()});
        }
    });
    return devices;
}

std::optional<DeviceRecord> SqlDeviceStore::find(const std::string& id) const {
    for (DeviceRecord& device : list()) {
        if (device.id == id) {
            return std::move(device);
        }
    }
    return std::nullopt;
}

void SqlDeviceStore::put(const DeviceRecord& device) {
    database_.write([&](SqlSession& session) {
        SqlStatement upsert(session,
                            "INSERT INTO device(id, name, uri, auto_start, "
                            "bed_width_mm, bed_height_mm, station) VALUES(?, ?, ?, ?, ?, ?, ?) "
                            "ON CONFLICT(id) DO UPDATE SET name = excluded.name, "
                            "uri = excluded.uri, auto_start = excluded.auto_start, "
                            "bed_width_mm = excluded.bed_width_mm, "
                            "bed_height_mm = excluded.bed_height_mm, "
                            "station = excluded.station");
        upsert.bind(1, device.id);
        upsert.bind(2, device.name);
        upsert.bind(3, device.uri);
        upsert.bind(4, device.auto_start ? 1 : 0);
        upsert.bind(5, device.bed_mm[0]);
        upsert.bind(6, device.bed_mm[1]);
        upsert.bind(7, device.station);
        upsert.run();
    });
}

bool SqlDeviceStore::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SqlSession& session) {
        SqlStatement erase(session, "DELETE FROM device WHERE id = ?");
        erase.bind(1, id);
        removed = erase.run() > 0;
    });
    return removed;
}

}  // namespace leafcutter::server
