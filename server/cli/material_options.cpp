#include "server/cli/material_options.h"

#include <cstddef>

#include "server/cli/input_file.h"
#include "server/material_json.h"

namespace leafcutter::server {

std::vector<fab::Material> wanted_materials(const std::string& file) {
    const auto built_in = fab::built_in_materials();
    if (file.empty()) {
        return {built_in.begin(), built_in.end()};
    }
    constexpr std::size_t kMostBytes = std::size_t{4} << 20;
    const std::vector<std::byte> bytes = read_input_file(file, kMostBytes);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return with_materials(built_in, materials_from_text(text, built_in));
}

}  // namespace leafcutter::server
