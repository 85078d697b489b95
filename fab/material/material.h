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

struct Material {
    std::string id;    // "paper-160-blue"
    std::string name;  // "Paper 160 g/m², blue"
    std::string colour = "#888888";
    double thickness_mm = 0.2;
    double weight_g_per_m2 = 160.0;
    double kerf_mm = 0.1;
    double min_strip_width_mm = 1.0;
    std::vector<SheetSize> sheets;
    LaserSettings cut;
    LaserSettings score;
    LaserSettings engrave;
};

// The materials that exist without any store: papers, card, veneer, felt.
std::span<const Material> built_in_materials();

// Null if there is none of that id.
const Material* find_material(std::span<const Material> materials, std::string_view id);

}  // namespace leafcutter::fab
