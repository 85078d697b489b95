#include "server/store/sqlite/rescue.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <system_error>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/store/durable_file.h"
#include "server/store/ids.h"
#include "server/store/sqlite/database.h"
#include "server/store/sqlite/errors.h"
#include "server/store/sqlite/schema.h"
#include "server/store/sqlite/seal.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

// About a third of a second of reading.
constexpr std::uintmax_t kCheckedAtOnce = 64ULL << 20;

constexpr const char* kOtherBytes = "its bytes are not those that were written";

fs::path suspicion_of(const fs::path& file) {
    return file.string() + ".suspect";
}

// What is wrong with it; empty: nothing.
std::string damage_of(const fs::path& file, bool all) {
    try {
        SQLite::Database database(file.string(), SQLite::OPEN_READWRITE, 5000);
        prepare_connection(database);
        if (schema_version(database) > newest_schema()) {
            return {};  // No damage: whoever migrates it says no.
        }
        return all ? quick_check(database) : std::string();
    } catch (const SQLite::Exception& error) {
        const StoreError why = store_error_of(error);
        if (why.trouble() != StoreTrouble::Damaged) {
            throw DatabaseUnusable(
                fmt::format("{} can't be opened: {}", file.string(), why.what()));
        }
        return error.what();
    }
}

bool is_good_backup(const fs::path& file) {
    try {
        if (seal_of(file) == Seal::Broken) {
            spdlog::warn("backup {}: {}", file.string(), kOtherBytes);
            return false;
        }
        SQLite::Database database(file.string(), SQLite::OPEN_READONLY, 5000);
        const int version = schema_version(database);
        return version > 0 && version <= newest_schema() && quick_check(database).empty();
    } catch (const SQLite::Exception& error) {
        spdlog::warn("backup {}: {}", file.string(), error.what());
        return false;
    }
}

std::optional<fs::path> newest_good(const fs::path& backups) {
    const std::vector<fs::path> all = backups_in(backups);
    const auto good = std::find_if(all.begin(), all.end(), is_good_backup);
    return good == all.end() ? std::nullopt : std::optional(*good);
}

// The file and its journals under another name. Returns that of the file.
fs::path put_aside(const fs::path& file) {
    const std::string suffix = fmt::format(".corrupt-{}", wall_clock_ms());
    for (const char* part : {"-wal", "-shm", ""}) {
        const fs::path from = file.string() + part;
        if (fs::exists(from)) {
            rename_durably(from, file.string() + suffix + part);
        }
    }
    return file.string() + suffix;
}

void restore(const fs::path& backup, const fs::path& file) {
    const fs::path copy = file.string() + ".part";
    fs::copy_file(backup, copy, fs::copy_options::overwrite_existing);
    sync_file(copy);
    rename_durably(copy, file);
}

Rescue rescue(const fs::path& file, const fs::path& backups, const std::string& damage) {
    Rescue done;
    const std::optional<fs::path> backup = newest_good(backups);
    if (!backup) {
        done.trouble = fmt::format(
            "the database is damaged ({}) and there is no good backup in {}: what can be read is "
            "shown, nothing is changed. Put a good copy in the place of {}, or move it away to "
            "begin anew",
            damage, backups.string(), file.string());
        done.notice = done.trouble;
        return done;
    }
    const fs::path aside = put_aside(file);
    restore(*backup, file);
    done.restored = true;
    done.notice = fmt::format(
        "the database was damaged ({}) and is again what the backup {} holds: what happened after "
        "it is not known here. The damaged one is kept as {}",
        damage, backup->filename().string(), aside.filename().string());
    return done;
}

}  // namespace

std::vector<fs::path> backups_in(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (entry.path().extension() == ".db") {
            found.push_back(entry.path());
        }
    }
    // Their names begin with the time.
    std::sort(found.rbegin(), found.rend());
    return found;
}

void remove_backup(const fs::path& file) {
    take_seal_off(file);
    fs::remove(file);
}

void mark_suspect(const fs::path& file) noexcept {
    try {
        std::ofstream(suspicion_of(file)) << "look at all of it\n";
    } catch (...) {  // The disk fails: then the next start will see.
    }
}

Rescue make_usable(const fs::path& file, const fs::path& backups) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (error || size == 0) {
        return {};  // A new one.
    }
    const bool is_suspect = fs::exists(suspicion_of(file));
    const Seal seal = seal_of(file);
    if (seal == Seal::Whole && !is_suspect) {
        take_seal_off(file);
        return {};
    }
    const std::string damage =
        seal == Seal::Broken ? kOtherBytes : damage_of(file, is_suspect || size <= kCheckedAtOnce);
    Rescue done;
    if (!damage.empty()) {
        done = rescue(file, backups, damage);
        spdlog::error("{}", done.notice);
    }
    if (done.trouble.empty()) {
        take_seal_off(file);  // One that only reads stays broken for the next start.
        fs::remove(suspicion_of(file), error);
    }
    return done;
}

}  // namespace leafcutter::server
