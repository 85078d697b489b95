#include "server/store/sqlite/seal.h"

#include <cstdint>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/crash_point.h"
#include "server/store/blobs.h"
#include "server/store/durable_file.h"

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMostBytes = 256ULL << 20;  // A quarter of a second of reading.

fs::path seal_file(const fs::path& file) {
    return file.string() + ".seal";
}

// What whoever copies another file there changes, and what rot on the disk does not.
std::string stamp_of(const fs::path& file) {
    return fmt::format("{} {}", fs::file_size(file),
                       fs::last_write_time(file).time_since_epoch().count());
}

std::string digest_of(const fs::path& file) {
    const FileHandle handle(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (handle.fd() < 0) {
        throw std::runtime_error("it can't be read");
    }
    const MappedBlob bytes(handle, fs::file_size(file));
    const auto* text = reinterpret_cast<const char*>(bytes.bytes().data());
    return sha256_of({text, bytes.bytes().size()});
}

bool has_journal(const fs::path& file) {
    const fs::path journal = file.string() + "-wal";
    return fs::exists(journal) && fs::file_size(journal) > 0;
}

}  // namespace

void put_seal(const fs::path& file) noexcept {
    try {
        const std::uintmax_t size = fs::file_size(file);
        if (size == 0 || size > kMostBytes || has_journal(file)) {
            return;
        }
        const fs::path part = seal_file(file).string() + ".part";
        std::ofstream out(part);
        out << stamp_of(file) << '\n' << digest_of(file) << '\n';
        out.close();
        if (out) {
            sync_file(part);
            crash_point("seal.before-rename");
            rename_durably(part, seal_file(file));
            crash_point("seal.after-rename");
        }
    } catch (const std::exception& error) {  // The next start looks at the form alone.
        spdlog::warn("{} is not sealed: {}", file.string(), error.what());
    }
}

Seal seal_of(const fs::path& file) {
    std::ifstream in(seal_file(file));
    std::string stamp;
    std::string digest;
    if (!std::getline(in, stamp) || !std::getline(in, digest) || !is_sha256(digest)) {
        return Seal::None;
    }
    if (has_journal(file) || stamp_of(file) != stamp) {
        return Seal::None;
    }
    return digest_of(file) == digest ? Seal::Whole : Seal::Broken;
}

void take_seal_off(const fs::path& file) {
    if (fs::remove(seal_file(file))) {
        sync_folder(file.parent_path());
    }
}

}  // namespace leafcutter::server
