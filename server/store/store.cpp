#include "server/store/store.h"

#include <utility>

#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/postgres/engine.h"
#include "server/store/sqlite/engine.h"
#include "server/store/sqlite/rescue.h"

namespace leafcutter::server {

OpenedEngine open_engine(const std::filesystem::path& folder,
                         std::function<void()> after_commit,
                         const StoreChoice& choice) {
    if (choice.uri.empty()) {
        return open_sqlite(folder, folder / "backups", std::move(after_commit), choice.scope);
    }
    std::filesystem::create_directories(folder / "backups");
    return open_postgres(choice.uri, choice.scope, {std::move(after_commit), choice.on_passing});
}

Store::Store(const std::filesystem::path& path,
             std::function<void()> after_commit,
             StoreChoice choice)
    : folder(path),
      choice_(std::move(choice)),
      engine_(open_engine(std::move(after_commit))),
      blobs(path / "blobs", choice_.others),
      jobs(engine_->jobs()),
      cuts(engine_->cuts()),
      devices(engine_->devices()),
      stock(engine_->stock()),
      materials(engine_->materials()),
      presets(engine_->presets()),
      settings(engine_->settings()),
      events(engine_->events()),
      accounts(engine_->accounts()),
      fleet(engine_->fleet()) {
    if (trouble().empty()) {
        take_up();
    }
}

void Store::take_up() {
    if (choice_.adopts) {
        fleet.adopt_machines();
    }
    if (choice_.computes) {
        jobs.recover();
    }
    if (choice_.has_machines) {
        interrupted_devices = cuts.recover();
    }
    if (restored_) {
        // What the backup calls waiting may be cut by now: somebody has to look first.
        jobs.pause_queue("restored from a backup: see what was done since, then resume");
    }
}

std::unique_ptr<Engine> Store::open_engine(std::function<void()> after_commit) {
    OpenedEngine opened = server::open_engine(folder.path(), std::move(after_commit), choice_);
    notice_ = std::move(opened.notice);
    restored_ = opened.restored;
    return std::move(opened.engine);
}

std::string Store::back_up(std::size_t kept) const {
    const std::string name = fmt::format("{}.db", rfc3339(wall_clock_ms()));
    engine_->back_up_to(backups() / name);
    const std::vector<std::filesystem::path> all = backups_in(backups());
    for (std::size_t i = kept; i < all.size(); ++i) {
        remove_backup(all[i]);
    }
    return name;
}

std::vector<std::pair<std::string, std::int64_t>> Store::list_backups() const {
    std::vector<std::pair<std::string, std::int64_t>> list;
    for (const std::filesystem::path& file : backups_in(backups())) {
        std::error_code error;
        const std::uintmax_t bytes = std::filesystem::file_size(file, error);
        list.emplace_back(file.filename().string(), error ? 0 : static_cast<std::int64_t>(bytes));
    }
    return list;
}

std::size_t Store::collect_garbage() const {
    return blobs.sweep([this](const std::string& sha256) { return jobs.refers_to_blob(sha256); });
}

}  // namespace leafcutter::server
