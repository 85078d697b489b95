// The words of job parameters and what they mean.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "fab/job_params.h"
#include "server/json_reader.h"

namespace leafcutter::server {

inline constexpr ObjectReader::Choice<geometry::FoliationMode> kModes[] = {
    {"auto", geometry::FoliationMode::Auto},
    {"pants", geometry::FoliationMode::Pants},
    {"one-form", geometry::FoliationMode::OneForm},
    {"disk", geometry::FoliationMode::Disk},
    {"annulus", geometry::FoliationMode::Annulus},
    {"torus", geometry::FoliationMode::Torus},
    {"sphere-polar", geometry::FoliationMode::SpherePolar},
    {"sphere-pillowcase", geometry::FoliationMode::SpherePillowcase},
};
inline constexpr ObjectReader::Choice<geometry::TorusRings> kTorusRings[] = {
    {"short", geometry::TorusRings::Short},
    {"long", geometry::TorusRings::Long},
};
inline constexpr ObjectReader::Choice<geometry::PantsSource> kPantsSources[] = {
    {"reeb", geometry::PantsSource::Reeb},
    {"handle-loops", geometry::PantsSource::HandleLoops},
    {"tunnel-loops", geometry::PantsSource::TunnelLoops},
    {"user", geometry::PantsSource::User},
};
inline constexpr ObjectReader::Choice<geometry::SweepFunction> kSweepFunctions[] = {
    {"auto", geometry::SweepFunction::Auto}, {"harmonic", geometry::SweepFunction::Harmonic},
    {"x", geometry::SweepFunction::X},       {"y", geometry::SweepFunction::Y},
    {"z", geometry::SweepFunction::Z},       {"fiedler", geometry::SweepFunction::Fiedler},
};
inline constexpr ObjectReader::Choice<geometry::PunctureChoice> kPunctureChoices[] = {
    {"auto", geometry::PunctureChoice::Auto},
    {"none", geometry::PunctureChoice::None},
};
inline constexpr ObjectReader::Choice<geometry::Components> kComponents[] = {
    {"each", geometry::Components::Each},
    {"largest", geometry::Components::Largest},
};
inline constexpr ObjectReader::Choice<geometry::Spacing> kSpacings[] = {
    {"uniform", geometry::Spacing::Uniform},
    {"curvature", geometry::Spacing::Curvature},
    {"curvature-area", geometry::Spacing::CurvatureArea},
};
inline constexpr ObjectReader::Choice<geometry::Junctions> kJunctions[] = {
    {"conforming", geometry::Junctions::Conforming},
    {"independent", geometry::Junctions::Independent},
};
inline constexpr ObjectReader::Choice<geometry::Parity> kParities[] = {
    {"even", geometry::Parity::Even},
    {"any", geometry::Parity::Any},
};
inline constexpr ObjectReader::Choice<geometry::Planarity> kPlanarities[] = {
    {"off", geometry::Planarity::Off},
    {"gentle", geometry::Planarity::Gentle},
    {"full", geometry::Planarity::Full},
};
inline constexpr ObjectReader::Choice<fab::WeavePattern> kPatterns[] = {
    {"plain", fab::WeavePattern::Plain},
    {"twill-2x2", fab::WeavePattern::Twill2x2},
    {"double-warp", fab::WeavePattern::DoubleWarp},
    {"double-weft", fab::WeavePattern::DoubleWeft},
    {"satin-5", fab::WeavePattern::Satin5},
    {"basket-2x2", fab::WeavePattern::Basket2x2},
};
inline constexpr ObjectReader::Choice<fab::ColumnRuns> kColumnRuns[] = {
    {"per-cylinder", fab::ColumnRuns::PerCylinder},
    {"through", fab::ColumnRuns::Through},
};
inline constexpr ObjectReader::Choice<fab::Joint> kJoint[] = {
    {"glue", fab::Joint::Glue},
    {"cell", fab::Joint::Cell},
    {"slot", fab::Joint::Slot},
};
inline constexpr ObjectReader::Choice<fab::CellMarks> kCellMarks[] = {
    {"ticks", fab::CellMarks::Ticks},
    {"lines", fab::CellMarks::Lines},
    {"none", fab::CellMarks::None},
};
inline constexpr ObjectReader::Choice<fab::Rotation> kRotations[] = {
    {"free", fab::Rotation::Free},
    {"0,180", fab::Rotation::Half},
    {"0,90,180,270", fab::Rotation::Quarter},
    {"0", fab::Rotation::Fixed},
};
inline constexpr ObjectReader::Choice<fab::Dialect> kDialects[] = {
    {"grbl", fab::Dialect::Grbl},
    {"marlin", fab::Dialect::Marlin},
    {"smoothie", fab::Dialect::Smoothie},
};

inline constexpr ObjectReader::Choice<fab::Paper> kPapers[] = {
    {"a4", fab::Paper::A4},
    {"a3", fab::Paper::A3},
    {"letter", fab::Paper::Letter},
};

template <typename Value, std::size_t kNames>
void read_choice(ObjectReader& reader,
                 std::string_view key,
                 Value& target,
                 const ObjectReader::Choice<Value> (&names)[kNames]) {
    reader.choice<Value>(key, target, names);
}

template <typename Value, std::size_t kNames>
std::string name_of(const ObjectReader::Choice<Value> (&names)[kNames], Value value) {
    for (const auto& choice : names) {
        if (choice.value == value) {
            return std::string(choice.name);
        }
    }
    return {};
}

}  // namespace leafcutter::server
