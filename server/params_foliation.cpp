#include "server/params_foliation.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/params_names.h"

namespace leafcutter::server {

namespace {

using fab::FoliationParams;
using geometry::FoliationMode;
using geometry::PantsSource;
using geometry::PunctureChoice;
using nlohmann::json;

bool all_different(const std::vector<int>& numbers) {
    return std::set<int>(numbers.begin(), numbers.end()).size() == numbers.size();
}

const json& list_at(const json& value, const std::string& path, const std::string& wanted) {
    if (!value.is_array()) {
        refuse_param(path, "must be " + wanted);
    }
    return value;
}

// As many different vertices as an array of kCount holds; absent if the key is.
template <std::size_t kCount>
void read_vertices(ObjectReader& reader,
                   std::string_view key,
                   std::optional<std::array<int, kCount>>& target,
                   const char* count_word) {
    const json* value = reader.get(key);
    if (value == nullptr) {
        return;
    }
    const std::vector<int> vertices = read_integers(*value, reader.path_of(key));
    if (vertices.size() != kCount || !all_different(vertices)) {
        refuse_param(reader.path_of(key), fmt::format("must be {} different vertices", count_word));
    }
    target.emplace();
    std::copy(vertices.begin(), vertices.end(), target->begin());
}

void read_loops(ObjectReader& reader, std::string_view key, std::vector<std::vector<int>>& loops) {
    constexpr std::size_t kFewest = 3;
    const json* value = reader.get(key);
    if (value == nullptr) {
        return;
    }
    const std::string path = reader.path_of(key);
    const json& list = list_at(*value, path, "a list of loops, each a list of vertices");
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string loop_path = fmt::format("{}[{}]", path, i);
        std::vector<int> loop = read_integers(list[i], loop_path);
        if (loop.size() < kFewest || !all_different(loop)) {
            refuse_param(loop_path, "must be three or more different vertices, in their order");
        }
        loops.push_back(std::move(loop));
    }
}

void read_weights(ObjectReader& reader, FoliationParams& foliation) {
    constexpr Range kWeight{0.0, 1e6, true};
    const json* value = reader.get("weights");
    if (value == nullptr || (value->is_string() && value->get<std::string>() == "auto")) {
        return;
    }
    const std::string path = reader.path_of("weights");
    const json& list = list_at(*value, path, "auto or a list of numbers, one per graph edge");
    if (list.empty()) {
        refuse_param(path, "must name at least one number");
    }
    foliation.weights.emplace();
    for (std::size_t i = 0; i < list.size(); ++i) {
        foliation.weights->push_back(read_number(list[i], fmt::format("{}[{}]", path, i), kWeight));
    }
}

fab::LoopParams read_loop(const json& value, const std::string& path) {
    fab::LoopParams loop;
    if (!value.is_array()) {
        if (!value.is_number_integer()) {
            refuse_param(path, "must be the number of a boundary loop or a list of its vertices");
        }
        loop.number = read_integer(value, path, {});
        return loop;
    }
    loop.vertices = read_integers(value, path);
    if (loop.vertices.empty()) {
        refuse_param(path, "must name at least one vertex");
    }
    return loop;
}

void read_boundaries(ObjectReader& reader,
                     std::string_view key,
                     std::vector<fab::LoopParams>& target) {
    const json* value = reader.get(key);
    if (value == nullptr) {
        return;
    }
    const std::string path = reader.path_of(key);
    const json& list = list_at(*value, path, "a list of boundary loops");
    for (std::size_t i = 0; i < list.size(); ++i) {
        target.push_back(read_loop(list[i], fmt::format("{}[{}]", path, i)));
    }
}

fab::PunctureParams read_puncture(const json& value, const std::string& path) {
    ObjectReader reader(value, path);
    fab::PunctureParams puncture;
    for (const char* key : {"vertex", "radius_mm"}) {
        if (reader.get(key) == nullptr) {
            refuse_param(reader.path_of(key), "must be given");
        }
    }
    reader.integer("vertex", puncture.vertex, {});
    reader.number("radius_mm", puncture.radius_mm, kPositiveLength);
    reader.finish();
    return puncture;
}

void read_punctures(ObjectReader& reader, FoliationParams& foliation) {
    const json* value = reader.get("punctures");
    if (value == nullptr) {
        return;
    }
    if (value->is_string()) {
        read_choice(reader, "punctures", foliation.puncture, kPunctureChoices);
        return;
    }
    const std::string path = reader.path_of("punctures");
    const json& list = list_at(*value, path, "auto, none or a list of punctures");
    std::set<int> vertices;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string puncture_path = fmt::format("{}[{}]", path, i);
        foliation.punctures.push_back(read_puncture(list[i], puncture_path));
        if (!vertices.insert(foliation.punctures.back().vertex).second) {
            refuse_param(puncture_path + ".vertex", "has a puncture already");
        }
    }
    foliation.puncture = list.empty() ? PunctureChoice::None : PunctureChoice::Given;
}

fab::PlaceParams read_place(const json& value, const std::string& path) {
    fab::PlaceParams place;
    if (!value.is_array()) {
        if (!value.is_number_integer()) {
            refuse_param(path, "must be a vertex, or a position [x, y, z] in units of the file");
        }
        place.vertex = read_integer(value, path, {});
        return place;
    }
    constexpr Range kAnywhere{-1e12, 1e12};
    if (value.size() != place.position.size()) {
        refuse_param(path, "must be a vertex, or a position [x, y, z] in units of the file");
    }
    for (std::size_t i = 0; i < place.position.size(); ++i) {
        place.position[i] = read_number(value[i], fmt::format("{}[{}]", path, i), kAnywhere);
    }
    return place;
}

void read_singularities(ObjectReader& reader, FoliationParams& foliation) {
    const json* value = reader.get("singularities");
    if (value == nullptr) {
        return;
    }
    const std::string path = reader.path_of("singularities");
    const json& list = list_at(*value, path, "a list of {\"near\": vertex}");
    std::set<int> vertices;
    for (std::size_t i = 0; i < list.size(); ++i) {
        ObjectReader singularity(list[i], fmt::format("{}[{}]", path, i));
        const json* near = singularity.get("near");
        if (near == nullptr) {
            refuse_param(singularity.path_of("near"), "must be given");
        }
        const fab::PlaceParams place = read_place(*near, singularity.path_of("near"));
        if (place.vertex && !vertices.insert(*place.vertex).second) {
            refuse_param(singularity.path_of("near"), "is wanted twice");
        }
        foliation.near.push_back(place);
        singularity.finish();
    }
}

// Refuses what was given if the mode is none of those that use it.
void check_mode(const ObjectReader& reader,
                std::string_view key,
                FoliationMode mode,
                std::initializer_list<FoliationMode> users) {
    if (std::find(users.begin(), users.end(), mode) != users.end()) {
        return;
    }
    std::string names;
    for (const FoliationMode user : users) {
        names += fmt::format("{}\"{}\"", names.empty() ? "" : " or ", name_of(kModes, user));
    }
    refuse_param(reader.path_of(key),
                 fmt::format("foliation.mode \"{}\" doesn't use it; set foliation.mode to {}",
                             name_of(kModes, mode), names));
}

void check_pants(const ObjectReader& reader, const FoliationParams& foliation) {
    const bool user = foliation.pants == PantsSource::User;
    if (user && foliation.loops.empty()) {
        refuse_param(reader.path_of("loops"), "must be given with foliation.pants \"user\"");
    }
    if (!user && !foliation.loops.empty()) {
        refuse_param(reader.path_of("loops"),
                     "foliation.pants \"" + name_of(kPantsSources, foliation.pants) +
                         "\" doesn't use them; set foliation.pants to \"user\"");
    }
    const std::initializer_list<FoliationMode> users = {FoliationMode::Auto, FoliationMode::Pants};
    if (foliation.pants != PantsSource::Reeb) {
        check_mode(reader, "pants", foliation.mode, users);
    }
    if (foliation.function != geometry::SweepFunction::Auto) {
        check_mode(reader, "function", foliation.mode, users);
    }
    if (foliation.weights) {
        check_mode(reader, "weights", foliation.mode, users);
    }
    if (!foliation.forbid.empty()) {
        check_mode(reader, "forbid", foliation.mode, users);
    }
}

void check_sources_and_sinks(const ObjectReader& reader, const FoliationParams& foliation) {
    const std::pair<const char*, const std::vector<fab::LoopParams>&> both[] = {
        {"sources", foliation.sources}, {"sinks", foliation.sinks}};
    std::set<int> numbers;
    for (const auto& [key, loops] : both) {
        if (!loops.empty()) {
            check_mode(reader, key, foliation.mode, {FoliationMode::OneForm});
        }
        for (std::size_t i = 0; i < loops.size(); ++i) {
            if (loops[i].number && !numbers.insert(*loops[i].number).second) {
                refuse_param(fmt::format("{}[{}]", reader.path_of(key), i),
                             fmt::format("loop {} is named already", *loops[i].number));
            }
        }
    }
}

void check_holes(const ObjectReader& reader, const FoliationParams& foliation) {
    const FoliationMode mode = foliation.mode;
    const bool closed = mode == FoliationMode::Torus || mode == FoliationMode::SpherePolar ||
                        mode == FoliationMode::SpherePillowcase;
    if (closed && foliation.puncture == PunctureChoice::Given) {
        refuse_param(reader.path_of("punctures"),
                     fmt::format("foliation.mode \"{}\" needs a surface without holes; set "
                                 "foliation.mode to \"auto\"",
                                 name_of(kModes, mode)));
    }
}

void check_together(const ObjectReader& reader, const FoliationParams& foliation) {
    const FoliationMode mode = foliation.mode;
    if (foliation.corners) {
        check_mode(reader, "corners", mode, {FoliationMode::Auto, FoliationMode::Disk});
    }
    if (foliation.torus_rings != geometry::TorusRings::Short) {
        check_mode(reader, "torus_rings", mode, {FoliationMode::Auto, FoliationMode::Torus});
    }
    check_pants(reader, foliation);
    if (foliation.poles) {
        check_mode(reader, "poles", mode, {FoliationMode::SpherePolar});
    }
    if (!foliation.near.empty()) {
        check_mode(reader, "singularities", mode,
                   {FoliationMode::Auto, FoliationMode::Pants, FoliationMode::OneForm,
                    FoliationMode::SpherePolar, FoliationMode::SpherePillowcase});
        if (foliation.poles) {
            refuse_param(reader.path_of("singularities"),
                         "not together with foliation.poles, which places them");
        }
    }
    check_sources_and_sinks(reader, foliation);
    check_holes(reader, foliation);
}

}  // namespace

void read_foliation(ObjectReader& reader, FoliationParams& foliation) {
    read_choice(reader, "mode", foliation.mode, kModes);
    read_choice(reader, "torus_rings", foliation.torus_rings, kTorusRings);
    read_vertices(reader, "corners", foliation.corners, "four");
    read_choice(reader, "pants", foliation.pants, kPantsSources);
    read_loops(reader, "loops", foliation.loops);
    read_loops(reader, "forbid", foliation.forbid);
    read_choice(reader, "function", foliation.function, kSweepFunctions);
    read_weights(reader, foliation);
    read_vertices(reader, "poles", foliation.poles, "two");
    read_boundaries(reader, "sources", foliation.sources);
    read_boundaries(reader, "sinks", foliation.sinks);
    read_punctures(reader, foliation);
    read_singularities(reader, foliation);
    read_choice(reader, "components", foliation.components, kComponents);
    check_together(reader, foliation);
}

}  // namespace leafcutter::server
