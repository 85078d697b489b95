#include "server/presets.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace leafcutter::server {

namespace {

struct Choice {
    const char* id;
    const char* name;
    const char* description;
    const char* warp;
    const char* weft;
    double strip_width_mm;
    const char* pattern;
    double tab_mm;
};

constexpr Choice kChoices[] = {
    {"paper-light", "Light paper", "Small models and lampshades; strips of 8 mm", "paper-120-ivory",
     "paper-120-green", 8.0, "plain", 6.0},
    {"paper-two-colours", "Paper in two colours", "The usual choice; strips of 10 mm",
     "paper-160-blue", "paper-160-yellow", 10.0, "plain", 8.0},
    {"card", "Card", "Larger models that keep their form; strips of 15 mm", "card-300",
     "card-300-black", 15.0, "plain", 12.0},
    {"veneer", "Wood veneer", "Gentle curves; strips of 25 mm", "veneer-0.6", "veneer-0.6-walnut",
     25.0, "plain", 20.0},
    {"plywood", "Thin plywood", "Large and almost flat; strips of 40 mm", "plywood-0.8",
     "plywood-0.8", 40.0, "plain", 30.0},
    {"felt-twill", "Felt in twill", "Soft and dense; strips of 12 mm", "felt-1", "felt-1-red", 12.0,
     "twill-2x2", 10.0},
};

NamedRecord record_of(const Choice& choice) {
    const nlohmann::json record = {
        {"name", choice.name},
        {"description", choice.description},
        {"params",
         {{"grid", {{"strip_width_mm", choice.strip_width_mm}}},
          {"weave", {{"pattern", choice.pattern}}},
          {"fit", {{"tab_mm", choice.tab_mm}}},
          {"material", {{"warp", choice.warp}, {"weft", choice.weft}}}}}};
    return {choice.id, record.dump()};
}

}  // namespace

const std::vector<NamedRecord>& built_in_presets() {
    static const std::vector<NamedRecord> presets = [] {
        std::vector<NamedRecord> all;
        for (const Choice& choice : kChoices) {
            all.push_back(record_of(choice));
        }
        return all;
    }();
    return presets;
}

const NamedRecord* find_preset(const std::vector<NamedRecord>& presets, const std::string& id) {
    const auto found = std::find_if(presets.begin(), presets.end(),
                                    [&id](const NamedRecord& each) { return each.id == id; });
    return found == presets.end() ? nullptr : &*found;
}

}  // namespace leafcutter::server
