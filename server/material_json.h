// Materials as JSON, in and out (docs: materials). The same for files and the API.

#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fab/material/material.h"

namespace leafcutter::server {

// One record. With "like": ID, what it doesn't say is that one's of `known`. `path` is what
// messages call it: "materials[2]", empty for a record of its own.
//
// Throws geometry::Error(BadOption): "materials[2].kerf_mm: must be >= 0".
fab::Material material_from_json(const nlohmann::json& record,
                                 const std::string& path,
                                 std::span<const fab::Material> known);

// A file: a list of records, or {"format": "leafcutter-materials/1", "materials": [...]}. Records
// may be like earlier ones. Throws as above, also for an id that is there twice.
std::vector<fab::Material> materials_from_text(std::string_view text,
                                               std::span<const fab::Material> known);

// As material_to_json wrote them, one by one.
std::vector<fab::Material> materials_from_records(const std::vector<std::string>& records);

// `base` with `added` in the places of those of the same id, the others behind it.
std::vector<fab::Material> with_materials(std::span<const fab::Material> base,
                                          std::span<const fab::Material> added);

// All of it, such that material_from_json gives it back.
nlohmann::json material_to_json(const fab::Material& material);

// What materials_from_text reads.
std::string materials_to_text(std::span<const fab::Material> materials);

}  // namespace leafcutter::server
