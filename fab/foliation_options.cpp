#include "fab/foliation_options.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

[[noreturn]] void refuse(const char* code, const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::BadOption, code, message);
}

class Translator {
public:
    Translator(const FoliationParams& params, const NamedMesh& mesh)
        : params_(params), mesh_(mesh) {}

    geometry::FoliationOptions translate() const {
        geometry::FoliationOptions options;
        options.mode = params_.mode;
        options.torus_rings = params_.torus_rings;
        options.corners = vertices(params_.corners, "corners");
        options.pants = params_.pants;
        options.loops = loops(params_.loops, "loops");
        options.forbidden_loops = loops(params_.forbid, "forbid");
        options.function = params_.function;
        options.weights = params_.weights;
        options.poles = vertices(params_.poles, "poles");
        options.near = places();
        options.sources = boundaries(params_.sources, "sources");
        options.sinks = boundaries(params_.sinks, "sinks");
        options.puncture = params_.puncture;
        for (std::size_t i = 0; i < params_.punctures.size(); ++i) {
            const PunctureParams& puncture = params_.punctures[i];
            options.punctures.push_back(
                {vertex(puncture.vertex, fmt::format("foliation.punctures[{}].vertex", i)),
                 puncture.radius_mm});
        }
        options.components = params_.components;
        return options;
    }

private:
    int vertex(int of_input, const std::string& path) const {
        const auto at = static_cast<std::size_t>(of_input);
        if (of_input < 0 || at >= mesh_.vertex_of_input.size()) {
            refuse("no-such-vertex", fmt::format("{}: the model has no vertex {}; it has {}", path,
                                                 of_input, mesh_.vertex_of_input.size()));
        }
        if (mesh_.vertex_of_input[at] < 0) {
            refuse("no-such-vertex",
                   fmt::format("{}: vertex {} belongs to no face that was kept", path, of_input));
        }
        return mesh_.vertex_of_input[at];
    }

    template <std::size_t kCount>
    std::optional<std::array<int, kCount>> vertices(
        const std::optional<std::array<int, kCount>>& of_input, const char* key) const {
        if (!of_input) {
            return {};
        }
        std::array<int, kCount> result{};
        for (std::size_t i = 0; i < kCount; ++i) {
            result[i] = vertex((*of_input)[i], fmt::format("foliation.{}[{}]", key, i));
        }
        return result;
    }

    std::vector<std::vector<int>> loops(const std::vector<std::vector<int>>& of_input,
                                        const char* key) const {
        std::vector<std::vector<int>> result;
        for (std::size_t i = 0; i < of_input.size(); ++i) {
            std::vector<int>& loop = result.emplace_back();
            for (std::size_t j = 0; j < of_input[i].size(); ++j) {
                loop.push_back(
                    vertex(of_input[i][j], fmt::format("foliation.{}[{}][{}]", key, i, j)));
            }
        }
        return result;
    }

    std::vector<int> places() const {
        std::vector<int> result;
        for (std::size_t i = 0; i < params_.near.size(); ++i) {
            const std::string path = fmt::format("foliation.singularities[{}].near", i);
            const PlaceParams& place = params_.near[i];
            const int found =
                place.vertex ? vertex(*place.vertex, path) : nearest_to(place.position);
            const auto same = std::find(result.begin(), result.end(), found);
            if (same != result.end()) {
                refuse("same-place", fmt::format("{}: the same vertex of the model as singularities"
                                                 "[{}]",
                                                 path, same - result.begin()));
            }
            result.push_back(found);
        }
        return result;
    }

    int nearest_to(const std::array<double, 3>& position) const {
        const Eigen::Vector3d place =
            mesh_.scale * Eigen::Vector3d(position[0], position[1], position[2]);
        int nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (int v = 0; v < static_cast<int>(mesh_.mesh->n_vertices()); ++v) {
            const double distance =
                (mesh_.mesh->point(geometry::Mesh::VertexHandle(v)) - place).squaredNorm();
            if (distance < least) {
                least = distance;
                nearest = v;
            }
        }
        return nearest;
    }

    std::vector<geometry::LoopName> boundaries(const std::vector<LoopParams>& named,
                                               const char* key) const {
        std::vector<geometry::LoopName> result;
        for (std::size_t i = 0; i < named.size(); ++i) {
            const std::string path = fmt::format("foliation.{}[{}]", key, i);
            result.push_back(named[i].number ? by_number(*named[i].number, path)
                                             : by_vertices(named[i].vertices, path));
        }
        return result;
    }

    // Holes that are opened as told have the numbers after those of the model.
    geometry::LoopName by_number(int number, const std::string& path) const {
        const std::size_t all = mesh_.topology.boundary_loops.size() + params_.punctures.size();
        if (number < 0 || static_cast<std::size_t>(number) >= all) {
            refuse("no-such-loop",
                   fmt::format("{}: there is no boundary loop {}; there are {}, numbered from 0 as "
                               "\"leafcutter inspect\" lists them",
                               path, number, all));
        }
        return {.number = number, .vertex = {}};
    }

    geometry::LoopName by_vertices(const std::vector<int>& of_input,
                                   const std::string& path) const {
        int first = -1;
        int first_loop = -1;
        for (std::size_t i = 0; i < of_input.size(); ++i) {
            const std::string vertex_path = fmt::format("{}[{}]", path, i);
            const int at = vertex(of_input[i], vertex_path);
            const int loop = loop_through(at);
            if (loop < 0 || (i > 0 && loop != first_loop)) {
                refuse("no-such-loop",
                       fmt::format("{}: vertex {} lies on {}", vertex_path, of_input[i],
                                   loop < 0 ? "no boundary loop of the model"
                                            : "another boundary loop than the one before it"));
            }
            if (i == 0) {
                first = at;
                first_loop = loop;
            }
        }
        return {.number = {}, .vertex = first};
    }

    int loop_through(int vertex) const {
        const auto& loops = mesh_.topology.boundary_loops;
        for (std::size_t i = 0; i < loops.size(); ++i) {
            if (std::find(loops[i].begin(), loops[i].end(), vertex) != loops[i].end()) {
                return static_cast<int>(i);
            }
        }
        return -1;
    }

    const FoliationParams& params_;
    const NamedMesh& mesh_;
};

}  // namespace

geometry::FoliationOptions foliation_options(const FoliationParams& params, const NamedMesh& mesh) {
    return Translator(params, mesh).translate();
}

std::vector<int> input_of_vertices(std::span<const int> vertex_of_input, std::size_t vertices) {
    std::vector<int> result(vertices, -1);
    for (std::size_t i = vertex_of_input.size(); i-- > 0;) {
        if (vertex_of_input[i] >= 0) {
            result[static_cast<std::size_t>(vertex_of_input[i])] = static_cast<int>(i);
        }
    }
    return result;
}

}  // namespace leafcutter::fab
