// Reads files out of a ZIP archive, as the API hands packages out or any other program packed them.

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace leafcutter::server {

class ZipReader {
public:
    // Keeps `bytes`. Throws geometry::Error(BadFile) if they are no archive; `name` is what
    // messages call it.
    ZipReader(std::string bytes, std::string name);

    // The content of a file; one folder that holds everything may be left out of `path`. Stored and
    // deflated files. Throws geometry::Error(BadFile) if there is none, or it is damaged or of more
    // than 4 GB.
    std::string read(const std::string& path) const;

private:
    struct Entry {
        std::uint32_t method = 0;
        std::uint32_t check = 0;
        std::uint64_t packed = 0;
        std::uint64_t size = 0;
        std::uint64_t header = 0;  // Where its local header begins.
    };

    std::uint32_t number(std::uint64_t at, int width) const;
    std::string_view part(std::uint64_t at, std::uint64_t size) const;
    std::uint64_t find_end() const;
    [[noreturn]] void refuse(const std::string& what) const;

    std::string bytes_;
    std::string name_;
    std::map<std::string, Entry> entries_;
    std::string folder_;  // "eight/" if everything is in it.
};

}  // namespace leafcutter::server
