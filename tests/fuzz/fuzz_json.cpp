// Texts in JSON from outside, to the reader that FUZZ_READER names. Anything but the typed error is
// a finding.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <nlohmann/json.hpp>

#include "fab/nest/instance_io.h"
#include "geometry/error.h"
#include "server/package_reader.h"
#include "server/params.h"

namespace {

using namespace leafcutter;

[[maybe_unused]] void read_instance(std::string_view text) {
    fab::read_instance(text);
}

// What was read is written as it can be read again.
[[maybe_unused]] void read_params(std::string_view text) {
    const fab::JobParams params = server::params_from_json(server::parse_params_text(text));
    server::params_from_json(server::params_to_json(params));
}

template <typename Read>
void try_to(const Read& read) {
    try {
        read();
    } catch (const geometry::Error& error) {
        if (error.kind() == geometry::ErrorKind::SelfCheck) {
            std::abort();
        }
    }
}

[[maybe_unused]] void read_package(std::string_view text) {
    try_to([text] { server::read_pieces(text); });
    try_to([text] { server::read_strips(text); });
    try_to([text] { server::read_sheets(text); });
    try_to([text] { server::read_facts(text); });
    try_to([text] { server::pick_pieces(text, {"W1.1"}); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try_to([text] { FUZZ_READER(text); });
    return 0;
}
