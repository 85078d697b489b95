#include "fab/material/material.h"

#include <algorithm>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::fab {

const Material* find_material(std::span<const Material> materials, std::string_view id) {
    for (const Material& material : materials) {
        if (material.id == id) {
            return &material;
        }
    }
    return nullptr;
}

Material on_machine(Material material, std::string_view machine) {
    if (machine.empty() || material.settings.empty()) {
        return material;
    }
    const auto found =
        std::find_if(material.settings.begin(), material.settings.end(),
                     [machine](const MachineSettings& each) { return each.machine == machine; });
    if (found == material.settings.end()) {
        std::string known;
        for (const MachineSettings& each : material.settings) {
            known += fmt::format("{}{}", known.empty() ? "" : ", ", each.machine);
        }
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "no-such-machine",
            fmt::format("output.machine: material {} has no settings for {}; it has some for {}",
                        material.id, machine, known));
    }
    material.cut = found->cut;
    material.score = found->score;
    material.engrave = found->engrave;
    material.kerf_mm = found->kerf_mm.value_or(material.kerf_mm);
    return material;
}

}  // namespace leafcutter::fab
