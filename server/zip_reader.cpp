#include "server/zip_reader.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <zlib.h>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::server {

namespace {

// Raw deflate, of a known size.
bool inflate_into(std::string_view packed, std::string& out) {
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) {
        return false;
    }
    // zlib reads only, whatever its types say.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int verdict = inflate(&stream, Z_FINISH);
    const bool whole = verdict == Z_STREAM_END && stream.total_out == out.size();
    inflateEnd(&stream);
    return whole;
}

}  // namespace

// PKWARE's APPNOTE, sections 4.3.7, 4.3.12 and 4.3.16: all numbers little-endian.
ZipReader::ZipReader(std::string bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)) {
    constexpr std::uint32_t kCentralHeader = 0x02014b50;
    const std::uint64_t end = find_end();
    const std::uint32_t count = number(end + 10, 2);
    std::uint64_t at = number(end + 16, 4);
    for (std::uint32_t i = 0; i < count; ++i) {
        if (number(at, 4) != kCentralHeader) {
            refuse("its list of files is damaged");
        }
        const std::uint32_t name_size = number(at + 28, 2);
        const std::string path(part(at + 46, name_size));
        entries_[path] = {number(at + 10, 2), number(at + 16, 4), number(at + 20, 4),
                          number(at + 24, 4), number(at + 42, 4)};
        at += 46 + std::uint64_t{name_size} + number(at + 30, 2) + number(at + 32, 2);
    }
    if (!entries_.empty()) {
        const std::string& first = entries_.begin()->first;
        const std::string folder = first.substr(0, first.find('/') + 1);
        const bool all = std::all_of(entries_.begin(), entries_.end(), [&folder](const auto& each) {
            return each.first.starts_with(folder);
        });
        folder_ = all ? folder : "";
    }
}

std::string ZipReader::read(const std::string& path) const {
    constexpr std::uint32_t kLocalHeader = 0x04034b50;
    constexpr std::uint32_t kStored = 0;
    constexpr std::uint32_t kDeflated = 8;
    auto found = entries_.find(path);
    found = found == entries_.end() ? entries_.find(folder_ + path) : found;
    if (found == entries_.end()) {
        refuse(fmt::format("holds no {}", path));
    }
    const Entry& entry = found->second;
    if (number(entry.header, 4) != kLocalHeader) {
        refuse(fmt::format("{} is damaged", path));
    }
    const std::uint64_t begin =
        entry.header + 30 + number(entry.header + 26, 2) + number(entry.header + 28, 2);
    const std::string_view packed = part(begin, entry.packed);
    // Deflate makes nothing more than a thousand times smaller.
    constexpr std::uint64_t kLargestFactor = 1100;
    if (entry.size > std::numeric_limits<std::uint32_t>::max() - 1 ||
        entry.size > kLargestFactor * (entry.packed + 1)) {
        refuse(fmt::format("{} is damaged or too large", path));
    }
    std::string content(entry.size, '\0');
    bool fine = false;
    if (entry.method == kStored && packed.size() == entry.size) {
        content = packed;
        fine = true;
    } else if (entry.method == kDeflated) {
        fine = inflate_into(packed, content);
    }
    const auto* data = reinterpret_cast<const Bytef*>(content.data());
    if (!fine || crc32_z(0, data, content.size()) != entry.check) {
        refuse(fmt::format("{} is damaged or packed in another way than deflate", path));
    }
    return content;
}

std::uint32_t ZipReader::number(std::uint64_t at, int width) const {
    std::uint32_t value = 0;
    const std::string_view digits = part(at, static_cast<std::uint64_t>(width));
    for (std::size_t i = digits.size(); i-- > 0;) {
        value = (value << 8U) | static_cast<unsigned char>(digits[i]);
    }
    return value;
}

std::string_view ZipReader::part(std::uint64_t at, std::uint64_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) {
        refuse("is cut short");
    }
    return std::string_view(bytes_).substr(at, size);
}

// The record that a comment of up to 64 kB may follow.
std::uint64_t ZipReader::find_end() const {
    constexpr std::uint64_t kSize = 22;
    constexpr std::uint64_t kLongestComment = 65535;
    const std::string_view signature("PK\x05\x06", 4);
    const std::size_t at = bytes_.rfind(signature);
    if (at == std::string::npos || bytes_.size() - at < kSize ||
        bytes_.size() - at > kSize + kLongestComment) {
        refuse("is no ZIP archive");
    }
    return at;
}

void ZipReader::refuse(const std::string& what) const {
    throw geometry::Error(geometry::ErrorKind::BadFile, "bad-archive",
                          fmt::format("{}: {}", name_, what));
}

}  // namespace leafcutter::server
