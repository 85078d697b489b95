#include "server/http/zip.h"

#include <cerrno>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <zlib.h>

namespace leafcutter::server {

namespace {

// PKWARE's APPNOTE, sections 4.3.7, 4.3.12 and 4.3.16: all numbers little-endian.
void put(std::string& bytes, std::uint32_t value, int width) {
    for (int i = 0; i < width; ++i) {
        bytes += static_cast<char>((value >> (8 * i)) & 0xffU);
    }
}

class Archive {
public:
    explicit Archive(const FileHandle& out) : out_(out) {}

    void add(const std::string& path, std::span<const std::byte> content) {
        constexpr std::uint32_t kLocalHeader = 0x04034b50;
        constexpr std::uint32_t kCentralHeader = 0x02014b50;
        const auto* data = reinterpret_cast<const char*>(content.data());
        const std::string common = facts(path, content);
        std::string local;
        put(local, kLocalHeader, 4);
        local += common + path;
        put(central_, kCentralHeader, 4);
        put(central_, kVersion, 2);
        central_ += common;
        put(central_, 0, 2);  // Comment.
        put(central_, 0, 2);  // Disk.
        put(central_, 0, 2);  // Internal attributes.
        put(central_, 0, 4);  // External attributes.
        put(central_, size_, 4);
        central_ += path;
        ++entries_;
        write(local);
        write({data, content.size()});
    }

    std::int64_t finish() {
        constexpr std::uint32_t kEnd = 0x06054b50;
        const std::uint32_t begin = size_;
        const std::string central = central_;
        write(central);
        std::string end;
        put(end, kEnd, 4);
        put(end, 0, 4);  // Disks.
        put(end, entries_, 2);
        put(end, entries_, 2);
        put(end, static_cast<std::uint32_t>(central.size()), 4);
        put(end, begin, 4);
        put(end, 0, 2);  // Comment.
        write(end);
        return size_;
    }

private:
    static constexpr std::uint32_t kVersion = 20;

    // What the local and the central header have in common.
    static std::string facts(const std::string& path, std::span<const std::byte> content) {
        constexpr std::uint32_t kNamesAreUtf8 = 1U << 11;
        constexpr std::uint32_t kFirstDay = (1U << 5) | 1U;  // 1980-01-01: equal jobs, equal bytes.
        if (content.size() > std::numeric_limits<std::uint32_t>::max()) {
            throw BlobWriteFailed("the archive would be larger than 4 GB");
        }
        const auto size = static_cast<std::uint32_t>(content.size());
        const auto check =
            crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size());
        std::string bytes;
        put(bytes, kVersion, 2);
        put(bytes, kNamesAreUtf8, 2);
        put(bytes, 0, 2);  // Stored.
        put(bytes, 0, 2);  // Time.
        put(bytes, kFirstDay, 2);
        put(bytes, static_cast<std::uint32_t>(check), 4);
        put(bytes, size, 4);
        put(bytes, size, 4);
        put(bytes, static_cast<std::uint32_t>(path.size()), 2);
        put(bytes, 0, 2);  // Extra field.
        return bytes;
    }

    void write(std::string_view bytes) {
        if (bytes.size() > std::numeric_limits<std::uint32_t>::max() - size_) {
            throw BlobWriteFailed("the archive would be larger than 4 GB");
        }
        size_ += static_cast<std::uint32_t>(bytes.size());
        while (!bytes.empty()) {
            const ssize_t written = ::write(out_.fd(), bytes.data(), bytes.size());
            if (written < 0 && errno != EINTR) {
                throw BlobWriteFailed(std::string("cannot write an archive: ") +
                                      std::generic_category().message(errno));
            }
            bytes.remove_prefix(written < 0 ? 0 : static_cast<std::size_t>(written));
        }
    }

    const FileHandle& out_;
    std::string central_;
    std::uint32_t size_ = 0;
    std::uint32_t entries_ = 0;
};

}  // namespace

std::int64_t write_zip(const Blobs& blobs,
                       const std::vector<ArtifactRecord>& files,
                       const FileHandle& out) {
    Archive archive(out);
    for (const ArtifactRecord& file : files) {
        archive.add(file.path, blobs.map(file.sha256)->bytes());
    }
    return archive.finish();
}

}  // namespace leafcutter::server
