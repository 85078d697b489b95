#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "server/material_json.h"

namespace leafcutter::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kLaser = R"({"power_percent": 20, "feed_mm_per_min": 1000})";

// A record that is enough.
std::string record() {
    return fmt::format(R"({{"id": "mine", "thickness_mm": 0.3, "weight_g_per_m2": 200,
        "kerf_mm": 0.1, "sheets": [{{"width_mm": 500, "height_mm": 300}}],
        "cut": {0}, "score": {0}, "engrave": {0}}})",
                       kLaser);
}

std::string refusal(const std::string& text) {
    try {
        materials_from_text(text, fab::built_in_materials());
    } catch (const geometry::Error& error) {
        return error.what();
    }
    return "taken";
}

// What a list with one record, changed by a merge patch, is refused for.
std::string patched(const char* patch) {
    auto json = nlohmann::json::parse(record());
    json.merge_patch(nlohmann::json::parse(patch));
    return refusal(nlohmann::json::array({json}).dump());
}

TEST(MaterialJson, BuiltInsComeBackAsTheyAre) {
    for (const fab::Material& material : fab::built_in_materials()) {
        const auto json = material_to_json(material);
        EXPECT_EQ(material_to_json(material_from_json(json, "", {})), json) << material.id;
    }
}

TEST(MaterialJson, ListsComeBackAsTheyAre) {
    const auto built_in = fab::built_in_materials();
    const std::string text = materials_to_text(built_in);
    EXPECT_EQ(materials_to_text(materials_from_text(text, {})), text);
}

TEST(BuiltInMaterials, AreWovenThings) {
    std::set<std::string> ids;
    for (const fab::Material& material : fab::built_in_materials()) {
        EXPECT_TRUE(ids.insert(material.id).second) << material.id;
        // Lighter than wood is felt only; nothing is as heavy as glass.
        const double g_per_cm3 = material.weight_g_per_m2 / material.thickness_mm / 1000.0;
        EXPECT_GT(g_per_cm3, 0.15) << material.id;
        EXPECT_LT(g_per_cm3, 1.5) << material.id;
        EXPECT_GT(material.min_radius_mm, material.thickness_mm) << material.id;
        EXPECT_GT(material.min_length_mm, material.min_strip_width_mm) << material.id;
        EXPECT_LT(material.kerf_mm, material.min_strip_width_mm) << material.id;
        ASSERT_GE(material.settings.size(), 2U) << material.id;
        for (const fab::MachineSettings& settings : material.settings) {
            // Marks must not cut: less energy for each millimetre.
            const auto energy = [](const fab::LaserSettings& laser) {
                return laser.power_percent * laser.passes / laser.feed_mm_per_min;
            };
            EXPECT_LT(energy(settings.score), 0.8 * energy(settings.cut)) << material.id;
            EXPECT_LT(energy(settings.engrave), energy(settings.score)) << material.id;
        }
    }
}

TEST(MaterialJson, RefusesByPath) {
    EXPECT_EQ(patched(R"({"kerf_mm": -0.1})"), "materials[0].kerf_mm: must be >= 0");
    EXPECT_EQ(patched(R"({"thickness_mm": 0})"), "materials[0].thickness_mm: must be > 0");
    EXPECT_EQ(patched(R"({"thickness_mm": null})"), "materials[0].thickness_mm: is missing");
    EXPECT_EQ(patched(R"({"colr": "#123456"})"), "materials[0].colr: unknown key");
    EXPECT_THAT(patched(R"({"colour": "blue"})"), StartsWith("materials[0].colour: must be a col"));
    EXPECT_THAT(patched(R"({"id": "a b"})"), StartsWith("materials[0].id: must be 1 to 64"));
    EXPECT_THAT(patched(R"({"id": "../x"})"), StartsWith("materials[0].id: must be 1 to 64"));
    EXPECT_THAT(patched(R"({"name": "two\nlines"})"), StartsWith("materials[0].name: must be one"));
    EXPECT_THAT(patched(R"({"grain_deg": 30})"), StartsWith("materials[0].grain_deg: must be 0"));
    EXPECT_EQ(patched(R"({"sheets": []})"), "materials[0].sheets: must hold at least one size");
    EXPECT_EQ(patched(R"({"sheets": [{"width_mm": 5}]})"),
              "materials[0].sheets[0].height_mm: is missing");
    EXPECT_EQ(patched(R"({"sheets": [{"width_mm": 5, "height_mm": 5, "price": -1}]})"),
              "materials[0].sheets[0].price: must be >= 0");
    EXPECT_EQ(patched(R"({"cut": {"power_percent": 101}})"),
              "materials[0].cut.power_percent: must be <= 100");
    EXPECT_EQ(patched(R"({"cut": {"feed_mm_per_min": 0}})"),
              "materials[0].cut.feed_mm_per_min: must be > 0");
    EXPECT_THAT(patched(R"({"cut": null})"), StartsWith("materials[0].cut: is missing"));
    EXPECT_EQ(patched(R"({"like": "paper-7"})"),
              "materials[0].like: there is no material of that id");
    EXPECT_EQ(refusal(fmt::format("[{0}, {0}]", record())), "materials[1].id: mine is there twice");
    EXPECT_EQ(refusal(R"({"materials": []})"), "format: must be leafcutter-materials/1");
    EXPECT_EQ(refusal("[5]"), "materials[0]: must be an object");
    EXPECT_THAT(refusal("[{]"), StartsWith("materials: no JSON"));
    EXPECT_EQ(refusal(fmt::format("[{}]", record())), "taken");
}

TEST(MaterialJson, RefusesMachinesByPath) {
    const std::string settings =
        fmt::format(R"({{"machine": "a", "cut": {0}, "score": {0}, "engrave": {0}}})", kLaser);
    const std::string one = fmt::format(R"({{"settings": [{}]}})", settings);
    EXPECT_EQ(patched(one.c_str()), "taken");
    const std::string two = fmt::format(R"({{"settings": [{0}, {0}]}})", settings);
    EXPECT_EQ(patched(two.c_str()), "materials[0].settings[1].machine: is there twice");
    EXPECT_THAT(patched(R"({"settings": [{"machine": "a"}]})"),
                StartsWith("materials[0].settings[0].cut: is missing"));
}

TEST(MaterialJson, RecordsMayBeLikeOthers) {
    const auto materials = materials_from_text(
        R"([{"id": "a", "like": "veneer-0.6", "grain_deg": null, "kerf_mm": 0.3},
            {"id": "b", "like": "a", "sheets": [{"width_mm": 90, "height_mm": 80, "price": 2}],
             "price_per_m2": null}])",
        fab::built_in_materials());
    ASSERT_EQ(materials.size(), 2U);
    EXPECT_EQ(materials[1].thickness_mm, 0.6);
    EXPECT_EQ(materials[1].kerf_mm, 0.3);
    EXPECT_FALSE(materials[1].grain_deg.has_value());
    EXPECT_FALSE(materials[1].price_per_m2.has_value());
    EXPECT_TRUE(materials[0].price_per_m2.has_value());
    ASSERT_EQ(materials[1].sheets.size(), 1U);
    EXPECT_EQ(materials[1].sheets[0].price, 2.0);
}

TEST(MaterialJson, AddedOnesTakeThePlacesOfTheirIds) {
    const auto built_in = fab::built_in_materials();
    const auto added = materials_from_text(R"([{"id": "felt-1", "like": "felt-1", "kerf_mm": 0.4},
                                               {"id": "new", "like": "felt-1"}])",
                                           built_in);
    const auto all = with_materials(built_in, added);
    ASSERT_EQ(all.size(), built_in.size() + 1);
    EXPECT_EQ(fab::find_material(all, "felt-1")->kerf_mm, 0.4);
    // Like the one of the file, not like the one it replaced.
    EXPECT_EQ(fab::find_material(all, "new")->kerf_mm, 0.4);
    for (std::size_t i = 0; i < built_in.size(); ++i) {
        EXPECT_EQ(all[i].id, built_in[i].id);
    }
}

TEST(OnMachine, TakesTheMachinesSettingsAndKerf) {
    const fab::Material& card = *fab::find_material(fab::built_in_materials(), "card-300");
    const fab::Material tube = fab::on_machine(card, "co2-40w");
    EXPECT_EQ(tube.cut.power_percent, card.settings[1].cut.power_percent);
    EXPECT_EQ(tube.kerf_mm, card.settings[1].kerf_mm);
    EXPECT_NE(tube.cut.power_percent, card.cut.power_percent);
    EXPECT_EQ(fab::on_machine(card, "").cut.power_percent, card.cut.power_percent);
    // Again, for a package that is cut again.
    EXPECT_EQ(material_to_json(fab::on_machine(tube, "co2-40w")), material_to_json(tube));
}

TEST(OnMachine, RefusesAMachineItDoesntKnowAndListsThose) {
    fab::Material card = *fab::find_material(fab::built_in_materials(), "card-300");
    try {
        fab::on_machine(card, "knife");
        FAIL();
    } catch (const geometry::Error& error) {
        EXPECT_THAT(error.what(), StartsWith("output.machine: material card-300"));
        EXPECT_THAT(error.what(), HasSubstr("diode-10w, co2-40w"));
    }
    card.settings.clear();
    EXPECT_EQ(fab::on_machine(card, "knife").cut.power_percent, card.cut.power_percent);
}

}  // namespace
}  // namespace leafcutter::server
