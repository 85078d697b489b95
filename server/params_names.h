// The words of job parameters and what they mean.

#pragma once

#include <string>
#include <vector>

#include "fab/job_params.h"
#include "server/json_reader.h"

namespace leafcutter::server {

template <typename Value>
using Names = std::vector<ObjectReader::Choice<Value>>;

inline const Names<geometry::FoliationMode> kModes = {
    {"auto", geometry::FoliationMode::Auto},
    {"pants", geometry::FoliationMode::Pants},
    {"one-form", geometry::FoliationMode::OneForm},
    {"disk", geometry::FoliationMode::Disk},
    {"annulus", geometry::FoliationMode::Annulus},
    {"torus", geometry::FoliationMode::Torus},
    {"sphere-polar", geometry::FoliationMode::SpherePolar},
    {"sphere-pillowcase", geometry::FoliationMode::SpherePillowcase},
};
inline const Names<geometry::TorusRings> kTorusRings = {
    {"short", geometry::TorusRings::Short},
    {"long", geometry::TorusRings::Long},
};
inline const Names<geometry::Spacing> kSpacings = {
    {"uniform", geometry::Spacing::Uniform},
    {"curvature", geometry::Spacing::Curvature},
    {"curvature-area", geometry::Spacing::CurvatureArea},
};
inline const Names<geometry::Junctions> kJunctions = {
    {"conforming", geometry::Junctions::Conforming},
    {"independent", geometry::Junctions::Independent},
};
inline const Names<geometry::Parity> kParities = {
    {"even", geometry::Parity::Even},
    {"any", geometry::Parity::Any},
};
inline const Names<geometry::Planarity> kPlanarities = {
    {"off", geometry::Planarity::Off},
    {"gentle", geometry::Planarity::Gentle},
    {"full", geometry::Planarity::Full},
};
inline const Names<fab::WeavePattern> kPatterns = {
    {"plain", fab::WeavePattern::Plain},
    {"twill-2x2", fab::WeavePattern::Twill2x2},
    {"double-warp", fab::WeavePattern::DoubleWarp},
    {"double-weft", fab::WeavePattern::DoubleWeft},
    {"satin-5", fab::WeavePattern::Satin5},
    {"basket-2x2", fab::WeavePattern::Basket2x2},
};
inline const Names<fab::ColumnRuns> kColumnRuns = {
    {"per-cylinder", fab::ColumnRuns::PerCylinder},
    {"through", fab::ColumnRuns::Through},
};
inline const Names<fab::CellMarks> kCellMarks = {
    {"ticks", fab::CellMarks::Ticks},
    {"lines", fab::CellMarks::Lines},
    {"none", fab::CellMarks::None},
};
inline const Names<fab::Rotation> kRotations = {
    {"free", fab::Rotation::Free},
    {"0,180", fab::Rotation::Half},
    {"0,90,180,270", fab::Rotation::Quarter},
    {"0", fab::Rotation::Fixed},
};
inline const Names<fab::Dialect> kDialects = {
    {"grbl", fab::Dialect::Grbl},
    {"marlin", fab::Dialect::Marlin},
    {"smoothie", fab::Dialect::Smoothie},
};

template <typename Value>
std::string name_of(const Names<Value>& names, Value value) {
    for (const auto& choice : names) {
        if (choice.value == value) {
            return std::string(choice.name);
        }
    }
    return {};
}

}  // namespace leafcutter::server
