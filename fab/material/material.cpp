#include "fab/material/material.h"

#include <array>
#include <vector>

namespace leafcutter::fab {

namespace {

// Starting values for a 40 W CO2 or a 10 W diode machine; a store of materials may hold better ones
// for the machine at hand.
struct Recipe {
    double thickness_mm;
    double weight_g_per_m2;
    double kerf_mm;
    double min_strip_width_mm;
    LaserSettings cut;
    LaserSettings score;
    LaserSettings engrave;
};

constexpr Recipe kPaper{
    0.2, 160.0, 0.1, 1.0, {20.0, 2400.0, 1}, {8.0, 3000.0, 1}, {6.0, 4000.0, 1}};
constexpr Recipe kCard{
    0.4, 300.0, 0.12, 1.5, {30.0, 1800.0, 1}, {12.0, 2400.0, 1}, {8.0, 3600.0, 1}};
constexpr Recipe kVeneer{
    0.6, 390.0, 0.15, 2.0, {45.0, 1200.0, 1}, {15.0, 2000.0, 1}, {10.0, 3000.0, 1}};
constexpr Recipe kFelt{
    1.0, 200.0, 0.2, 3.0, {35.0, 1500.0, 1}, {10.0, 2400.0, 1}, {7.0, 3000.0, 1}};

constexpr SheetSize kBed{600.0, 400.0};
constexpr SheetSize kA3{420.0, 297.0};

struct Naming {
    const char* id;
    const char* name;
    const char* colour;
};

Material material(const Naming& naming, const Recipe& recipe) {
    Material result;
    result.id = naming.id;
    result.name = naming.name;
    result.colour = naming.colour;
    result.thickness_mm = recipe.thickness_mm;
    result.weight_g_per_m2 = recipe.weight_g_per_m2;
    result.kerf_mm = recipe.kerf_mm;
    result.min_strip_width_mm = recipe.min_strip_width_mm;
    result.sheets = {kBed, kA3};
    result.cut = recipe.cut;
    result.score = recipe.score;
    result.engrave = recipe.engrave;
    return result;
}

}  // namespace

std::span<const Material> built_in_materials() {
    static const std::vector<Material> materials = {
        material({"paper-160-blue", "Paper 160 g/m², blue", "#2f5d9b"}, kPaper),
        material({"paper-160-yellow", "Paper 160 g/m², yellow", "#f2c53d"}, kPaper),
        material({"paper-160-white", "Paper 160 g/m², white", "#f5f3ee"}, kPaper),
        material({"paper-160-red", "Paper 160 g/m², red", "#c23b33"}, kPaper),
        material({"card-300", "Card 300 g/m², grey", "#9a968e"}, kCard),
        material({"card-300-black", "Card 300 g/m², black", "#2b2a29"}, kCard),
        material({"veneer-0.6", "Veneer 0.6 mm, maple", "#d9b98a"}, kVeneer),
        material({"veneer-0.6-walnut", "Veneer 0.6 mm, walnut", "#6f4c34"}, kVeneer),
        material({"felt-1", "Felt 1 mm, grey", "#8a8f94"}, kFelt),
        material({"felt-1-red", "Felt 1 mm, red", "#b4453f"}, kFelt),
    };
    return materials;
}

const Material* find_material(std::span<const Material> materials, std::string_view id) {
    for (const Material& material : materials) {
        if (material.id == id) {
            return &material;
        }
    }
    return nullptr;
}

}  // namespace leafcutter::fab
