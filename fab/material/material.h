// Sheet materials and how a laser treats them.

#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::fab {

struct LaserSettings {
    double power_percent = 0.0;
    double feed_mm_per_min = 0.0;
    int passes = 1;
};

struct SheetSize {
    double width_mm = 0.0;
    double height_mm = 0.0;
};

// A size that the material is to be had in.
struct StockSheet {
    SheetSize size;
    std::optional<double> price;  // Of one sheet.
};

// What one machine wants for a material, instead of the material's defaults.
struct MachineSettings {
    std::string machine;            // "diode-10w"
    std::optional<double> kerf_mm;  // Else the material's.
    LaserSettings cut;
    LaserSettings score;
    LaserSettings engrave;
};

struct Material {
    std::string id;    // "paper-160-blue"
    std::string name;  // "Paper 160 g/m², blue"
    std::string colour = "#888888";
    double thickness_mm = 0.2;
    double weight_g_per_m2 = 160.0;
    double kerf_mm = 0.1;
    double min_strip_width_mm = 1.0;
    double min_radius_mm = 0.0;  // Tightest bend along a strip that it takes unharmed.
    double min_length_mm = 0.0;  // Shortest piece that hands can weave.

    // Direction of the grain on a sheet, 0: along its width, 90: along its height. Pieces are then
    // laid with their ends' line along the grain, at most the tolerance off.
    std::optional<double> grain_deg;
    double grain_tolerance_deg = 0.0;

    std::vector<StockSheet> sheets;      // The size preferred comes first.
    std::optional<double> price_per_m2;  // Of sheets without a price of their own.
    std::string currency = "EUR";

    LaserSettings cut;
    LaserSettings score;
    LaserSettings engrave;
    std::vector<MachineSettings> settings;  // Each machine once.
};

// The materials that exist without any store: papers, card, veneer, plywood, felt, plastic.
std::span<const Material> built_in_materials();

// Null if there is none of that id.
const Material* find_material(std::span<const Material> materials, std::string_view id);

// `material` with the settings and the kerf of `machine` for its own; as it is for an empty name
// or if it has no settings for machines at all. Throws geometry::Error(BadOption) listing the
// machines known if `machine` is none of them.
Material on_machine(Material material, std::string_view machine);

}  // namespace leafcutter::fab
