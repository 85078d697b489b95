#include "server/cli/material_options.h"

#include <cstddef>

#include "server/cli/input_file.h"
#include "server/material_json.h"

namespace leafcutter::server {

std::vector<fab::Material> materials_of_file(const std::string& file) {
    if (file.empty()) {
        return {};
    }
    constexpr std::size_t kMostBytes = std::size_t{4} << 20;
    const std::vector<std::byte> bytes = read_input_file(file, kMostBytes);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return materials_from_text(text, fab::built_in_materials());
}

std::vector<fab::Material> wanted_materials(const std::string& file) {
    return with_materials(fab::built_in_materials(), materials_of_file(file));
}

}  // namespace leafcutter::server
