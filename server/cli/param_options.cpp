#include "server/cli/param_options.h"

#include <cstddef>

#include <nlohmann/json.hpp>

#include "server/cli/input_file.h"
#include "server/params.h"

namespace leafcutter::server {

nlohmann::json wanted_params(const std::string& params_file,
                             const std::vector<std::string>& assignments) {
    nlohmann::json params = nlohmann::json::object();
    if (!params_file.empty()) {
        constexpr std::size_t kMostBytes = 262144;
        const std::vector<std::byte> bytes = read_input_file(params_file, kMostBytes);
        params = parse_params_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    for (const std::string& assignment : assignments) {
        set_param(params, assignment);
    }
    params_from_json(params);
    return params;
}

}  // namespace leafcutter::server
