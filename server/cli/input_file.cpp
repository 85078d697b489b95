#include "server/cli/input_file.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "server/cli/command.h"

namespace leafcutter::server {

std::vector<std::byte> read_input_file(const std::string& path, std::size_t max_bytes) {
    std::error_code failure;
    if (std::filesystem::is_directory(path, failure)) {
        throw UsageError(fmt::format("{}: is a directory; name a file", path));
    }
    const auto size = std::filesystem::file_size(path, failure);
    if (failure) {
        throw UsageError(fmt::format("{}: {}", path, failure.message()));
    }
    if (size > max_bytes) {
        throw UsageError(
            fmt::format("{}: {} bytes, more than the {} that are read", path, size, max_bytes));
    }
    std::vector<std::byte> bytes(size);
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!file) {
        throw UsageError(fmt::format("{}: can't be read", path));
    }
    return bytes;
}

}  // namespace leafcutter::server
