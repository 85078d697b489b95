#include "fab/cut/cut_heat.h"

#include <algorithm>

namespace leafcutter::fab {

HeatOptions cooling_of(const Material& material, const MachineProfile& machine) {
    constexpr double kHeatCapacity = 1400.0;  // J/(kg K): paper, wood, felt.
    constexpr double kToAir = 15.0;           // W/(m² K), each face, still air.
    HeatOptions options;
    options.decay_s =
        std::max(1.0, material.weight_g_per_m2 / 1000.0 * kHeatCapacity / (2.0 * kToAir));
    options.burn_mm_per_s =
        std::max(1.0, material.cut.feed_mm_per_min / 60.0) / std::max(1, material.cut.passes);
    options.travel_mm_per_s = std::max(1.0, machine.rapid_mm_per_min / 60.0);
    return options;
}

}  // namespace leafcutter::fab
