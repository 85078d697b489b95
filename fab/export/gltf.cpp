// Binary glTF 2.0 (Khronos, "glTF 2.0 Specification", section 4): a header, a chunk of JSON, a
// chunk of bytes that it points into. No normals are written: viewers then shade every triangle
// flat, as cut strips with folds are.

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "fab/export/bytes.h"
#include "fab/export/colour.h"
#include "fab/export/solids.h"

namespace leafcutter::fab {

namespace {

using nlohmann::json;

constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kByteChunk = 0x004E4942;  // "BIN"
constexpr int kFloat = 5126;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kIndexBuffer = 34963;
constexpr double kMetre = 1000.0;

class GlbWriter {
public:
    explicit GlbWriter(const FamilyColours& colours) {
        for (const auto& [name, colour] :
             {std::pair{"weft", colours.weft}, std::pair{"warp", colours.warp}}) {
            const Rgb rgb = linear_of(rgb_of(colour));
            materials_.push_back({{"name", name},
                                  {"pbrMetallicRoughness",
                                   {{"baseColorFactor", {rgb[0], rgb[1], rgb[2], 1.0}},
                                    {"metallicFactor", 0.0},
                                    {"roughnessFactor", 0.9}}}});
        }
    }

    void add(const Solid& solid) {
        const std::size_t positions = add_positions(solid);
        const std::size_t indices = add_indices(solid);
        const bool weft = solid.family == Family::Weft;
        meshes_.push_back({{"name", solid.name},
                           {"primitives",
                            {{{"attributes", {{"POSITION", positions}}},
                              {"indices", indices},
                              {"material", weft ? 0 : 1}}}}});
        children_.push_back(nodes_.size() + 1);  // Behind the root.
        nodes_.push_back({{"name", solid.name},
                          {"mesh", meshes_.size() - 1},
                          {"extras", {{"family", weft ? "weft" : "warp"}}}});
    }

    std::string finish() {
        // A quarter turn about x: our z becomes glTF's y.
        const double half = std::sqrt(0.5);
        json root = {{"name", "woven"}, {"rotation", {-half, 0.0, 0.0, half}}};
        if (!children_.empty()) {
            root["children"] = children_;
        }
        json nodes = json::array({std::move(root)});
        nodes.insert(nodes.end(), nodes_.begin(), nodes_.end());
        json file = {{"asset", {{"version", "2.0"}, {"generator", "Leafcutter"}}},
                     {"scene", 0},
                     {"scenes", {{{"nodes", {0}}}}},
                     {"nodes", std::move(nodes)},
                     {"materials", materials_}};
        if (!meshes_.empty()) {
            file["meshes"] = meshes_;
            file["accessors"] = accessors_;
            file["bufferViews"] = views_;
            file["buffers"] = {{{"byteLength", bytes_.size()}}};
        }
        return chunks(file.dump());
    }

private:
    std::size_t add_positions(const Solid& solid) {
        Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
        Eigen::Vector3f high = -low;
        const std::size_t begin = bytes_.size();
        for (const Eigen::Vector3d& vertex : solid.vertices) {
            const Eigen::Vector3f point = (vertex / kMetre).cast<float>();
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
            for (const float value : {point.x(), point.y(), point.z()}) {
                append_bytes(bytes_, value);
            }
        }
        return add_accessor(begin,
                            {{"componentType", kFloat},
                             {"count", solid.vertices.size()},
                             {"type", "VEC3"},
                             {"min", {low.x(), low.y(), low.z()}},
                             {"max", {high.x(), high.y(), high.z()}}},
                            kArrayBuffer);
    }

    std::size_t add_indices(const Solid& solid) {
        // 65535 itself is kept for breaks.
        const bool small = solid.vertices.size() <= 65535;
        const std::size_t begin = bytes_.size();
        for (const std::array<int, 3>& triangle : solid.triangles) {
            for (const int index : triangle) {
                if (small) {
                    append_bytes(bytes_, static_cast<std::uint16_t>(index));
                } else {
                    append_bytes(bytes_, static_cast<std::uint32_t>(index));
                }
            }
        }
        return add_accessor(begin,
                            {{"componentType", small ? kUnsignedShort : kUnsignedInt},
                             {"count", 3 * solid.triangles.size()},
                             {"type", "SCALAR"}},
                            kIndexBuffer);
    }

    // What stands in the bytes from `begin` on; the next begins on a multiple of 4.
    std::size_t add_accessor(std::size_t begin, json accessor, int target) {
        views_.push_back({{"buffer", 0},
                          {"byteOffset", begin},
                          {"byteLength", bytes_.size() - begin},
                          {"target", target}});
        accessor["bufferView"] = views_.size() - 1;
        accessors_.push_back(std::move(accessor));
        bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
        return accessors_.size() - 1;
    }

    std::string chunks(std::string text) const {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string out;
        const std::size_t bytes = bytes_.empty() ? 0 : 8 + bytes_.size();
        const std::size_t total = 12 + 8 + text.size() + bytes;
        out.reserve(total);
        append_bytes(out, kMagic);
        append_bytes(out, std::uint32_t{2});
        append_bytes(out, static_cast<std::uint32_t>(total));
        append_bytes(out, static_cast<std::uint32_t>(text.size()));
        append_bytes(out, kJsonChunk);
        out += text;
        if (!bytes_.empty()) {
            append_bytes(out, static_cast<std::uint32_t>(bytes_.size()));
            append_bytes(out, kByteChunk);
            out += bytes_;
        }
        return out;
    }

    std::string bytes_;
    json materials_ = json::array();
    json meshes_ = json::array();
    json nodes_ = json::array();
    json accessors_ = json::array();
    json views_ = json::array();
    std::vector<std::size_t> children_;
};

}  // namespace

std::string write_glb(std::span<const Solid> solids, const FamilyColours& colours) {
    GlbWriter writer(colours);
    for (const Solid& solid : solids) {
        writer.add(solid);
    }
    return writer.finish();
}

}  // namespace leafcutter::fab
