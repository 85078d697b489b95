#include "server/store/store.h"

#include <utility>

namespace leafcutter::server {

Store::Store(const std::filesystem::path& path, std::function<void()> after_commit)
    : folder(path),
      database(path / "leafcutter.db", std::move(after_commit)),
      blobs(path / "blobs"),
      jobs(database),
      cuts(database),
      devices(database),
      materials(database),
      events(database),
      accounts(database),
      webhooks(database) {
    jobs.recover();
    interrupted_devices = cuts.recover();
    blobs.sweep([this](const std::string& sha256) { return jobs.refers_to_blob(sha256); });
}

}  // namespace leafcutter::server
