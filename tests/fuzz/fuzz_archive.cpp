// A package as an archive, and an upload in several parts. Anything but the typed error is a
// finding.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "geometry/error.h"
#include "server/http/multipart.h"
#include "server/http/problem.h"
#include "server/zip_reader.h"

namespace {

using namespace leafcutter::server;

void read_archive(std::string_view bytes) {
    try {
        const ZipReader zip(std::string(bytes), "fuzz.zip");
        for (const char* name : {"report.json", "strips.json", "sheets/sheet-001.gcode"}) {
            try {
                zip.read(name);
            } catch (const leafcutter::geometry::Error&) {
                continue;
            }
        }
    } catch (const leafcutter::geometry::Error&) {
        return;
    }
}

// The first byte says how much comes at once.
void read_upload(std::string_view bytes) {
    const std::size_t most =
        bytes.empty() ? 1 : static_cast<unsigned char>(bytes[0]) + std::size_t{1};
    std::string_view left = bytes.substr(std::min<std::size_t>(1, bytes.size()));
    RequestBody body;
    body.bytes = static_cast<std::int64_t>(left.size());
    body.read = [&left, most](std::span<char> room) {
        const std::size_t count = std::min({most, room.size(), left.size()});
        std::copy_n(left.begin(), count, room.begin());
        left.remove_prefix(count);
        return count;
    };
    try {
        MultipartReader reader("multipart/form-data; boundary=cut", body);
        while (reader.next()) {
            reader.read_all(4096);
        }
    } catch (const HttpProblem&) {
        return;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    read_archive(bytes);
    read_upload(bytes);
    return 0;
}
