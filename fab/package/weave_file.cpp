// weave.json: which thread lies on top, and how a robot or hands put the strips together. The
// fields are described in fab/weave/README.md.

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include "fab/package/package_files.h"
#include "fab/package/records.h"

namespace leafcutter::fab {

namespace {

using json = nlohmann::ordered_json;
using Eigen::Vector3d;

constexpr double kPerMm = 1e3;    // Positions are rounded to a thousandth,
constexpr double kPerUnit = 1e4;  // directions to a ten-thousandth.

json pattern_json(const WeaveParams& weave) {
    switch (weave.pattern) {
        case WeavePattern::Plain:
            return "plain";
        case WeavePattern::Twill2x2:
            return "twill-2x2";
        case WeavePattern::DoubleWarp:
            return "double-warp";
        case WeavePattern::DoubleWeft:
            return "double-weft";
        case WeavePattern::Satin5:
            return "satin-5";
        case WeavePattern::Basket2x2:
            return "basket-2x2";
        case WeavePattern::Matrix:
            break;
    }
    return weave.matrix;
}

void append(json& row, const Vector3d& value, double steps) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        row.push_back(std::round(value[axis] * steps) / steps);
    }
}

class WeaveWriter {
public:
    explicit WeaveWriter(const JobResult& job) : job_(job) {
        for (std::size_t i = 0; i < job.pieces.size(); ++i) {
            pieces_.emplace(job.pieces[i].id, i);
        }
    }

    json crossings() const {
        std::vector<std::array<int, 2>> strips(job_.quads.quads.size(), {-1, -1});
        for (std::size_t i = 0; i < job_.strips.size(); ++i) {
            for (const int quad : job_.strips[i].quads) {
                strips[static_cast<std::size_t>(quad)]
                      [job_.strips[i].family == Family::Weft ? 0 : 1] = static_cast<int>(i);
            }
        }
        json all = json::array();
        for (std::size_t quad = 0; quad < job_.quads.quads.size(); ++quad) {
            const auto& corners = job_.quads.quads[quad];
            const auto corner = [&](std::size_t i) -> const Vector3d& {
                return job_.quads.vertices[static_cast<std::size_t>(corners[i])];
            };
            const Vector3d weft = corner(1) + corner(2) - corner(0) - corner(3);
            const Vector3d warp = corner(2) + corner(3) - corner(0) - corner(1);
            json row = {strips[quad][0], strips[quad][1]};
            append(row, (corner(0) + corner(1) + corner(2) + corner(3)) / 4.0, kPerMm);
            append(row, weft.cross(warp).stableNormalized(), kPerUnit);
            append(row, weft.stableNormalized(), kPerUnit);
            append(row, warp.stableNormalized(), kPerUnit);
            all.push_back(std::move(row));
        }
        return all;
    }

    json moves() const {
        json all = json::array();
        for (const AssemblyMove& move : job_.assembly.moves) {
            const bool lays = move.kind == MoveKind::Lay || move.kind == MoveKind::Thread;
            all.push_back(lays ? lay_json(move) : joint_json(move));
        }
        return all;
    }

    json regions() const {
        json all = json::array();
        for (const AssemblyRegion& region : job_.assembly.regions) {
            all.push_back({{"cylinders", region.cylinders},
                           {"part", region.part},
                           {"base", region.base == Family::Weft ? "weft" : "warp"}});
        }
        return all;
    }

private:
    json lay_json(const AssemblyMove& move) const {
        const auto strip = static_cast<std::size_t>(move.strip);
        json crossings = json::array();
        for (const int cell : move.cells) {
            const Crossing& crossing = job_.crossings[strip][static_cast<std::size_t>(cell)];
            const bool held =
                std::find(move.held.begin(), move.held.end(), cell) != move.held.end();
            crossings.push_back({job_.strips[strip].quads[static_cast<std::size_t>(cell)],
                                 job_.strips[static_cast<std::size_t>(crossing.strip)].id,
                                 crossing.on_top ? "over"
                                 : held          ? "threaded"
                                                 : "under"});
        }
        return {{"kind", move.kind == MoveKind::Lay ? "lay" : "thread"},
                {"region", move.region},
                {"strip", job_.strips[strip].id},
                {"pieces", move.pieces},
                {"crossings", std::move(crossings)}};
    }

    json joint_json(const AssemblyMove& move) const {
        return {{"kind", move.kind == MoveKind::Close ? "close" : "join"},
                {"region", move.region},
                {"strip", job_.strips[static_cast<std::size_t>(move.strip)].id},
                {"piece", move.piece},
                {"onto", move.onto},
                {"end", move.at_start ? "start" : "end"},
                {"where", move.in_place ? "in-place" : "table"},
                {"crossing", quad_at(move)},
                {"tucked", move.tucked}};
    }

    // The last cell of the piece on the side where it is joined.
    int quad_at(const AssemblyMove& move) const {
        const Piece& piece = job_.pieces[pieces_.at(move.piece)];
        const std::vector<int>& quads = job_.strips[static_cast<std::size_t>(move.strip)].quads;
        const int cell = piece.first_cell + (move.at_start ? 0 : piece.cell_count - 1);
        return quads[static_cast<std::size_t>(cell) % quads.size()];
    }

    const JobResult& job_;
    std::unordered_map<std::string, std::size_t> pieces_;
};

json family_floats_json(const FamilyFloats& before, const FamilyFloats& after) {
    return {{"longest", after.longest},       {"mean", after.mean},
            {"over_limit", after.over_limit}, {"longest_before", before.longest},
            {"mean_before", before.mean},     {"over_limit_before", before.over_limit}};
}

json too_long_json(const Floats& floats) {
    json too_long = json::array();
    for (const Float& left : floats.too_long) {
        too_long.push_back({{"family", left.family == Family::Weft ? "weft" : "warp"},
                            {"on_top", left.on_top},
                            {"quads", left.quads}});
    }
    return too_long;
}

}  // namespace

nlohmann::ordered_json floats_record(const Floats& floats) {
    return {{"limit", floats.limit ? json(*floats.limit) : json()},
            {"weft", family_floats_json(floats.weft_before, floats.weft)},
            {"warp", family_floats_json(floats.warp_before, floats.warp)},
            {"flips", floats.flips.size()}};
}

nlohmann::ordered_json assembly_record(const Assembly& assembly) {
    return {{"moves", assembly.moves.size()},
            {"laid", assembly.laid},
            {"threaded", assembly.threaded},
            {"threaded_crossings", assembly.threaded_crossings},
            {"longest_thread", assembly.longest_thread},
            {"table_joints", assembly.table_joints},
            {"place_joints", assembly.place_joints},
            {"tucked_joints", assembly.tucked_joints}};
}

std::string weave_json(const JobResult& job) {
    const WeaveWriter writer(job);
    json floats = floats_record(job.weave.floats);
    floats["flips"] = job.weave.floats.flips;
    floats["too_long"] = too_long_json(job.weave.floats);
    json strips = json::array();
    for (const Strip& strip : job.strips) {
        strips.push_back(strip.id);
    }
    const json file = {{"format", "leafcutter-weave/1"},
                       {"pattern", pattern_json(job.params.weave)},
                       {"warp_on_top", job.weave.warp_on_top},
                       {"seams", job.weave.seams},
                       {"seam_mm", job.weave.seam_mm},
                       {"shortest_seam_proven", job.weave.shortest},
                       {"floats", std::move(floats)},
                       {"strips", std::move(strips)},
                       {"crossing_fields",
                        {"weft", "warp", "x_mm", "y_mm", "z_mm", "normal_x", "normal_y", "normal_z",
                         "weft_x", "weft_y", "weft_z", "warp_x", "warp_y", "warp_z"}},
                       {"crossings", writer.crossings()},
                       {"assembly", assembly_record(job.assembly)},
                       {"regions", writer.regions()},
                       {"moves", writer.moves()}};
    return file.dump() + "\n";
}

}  // namespace leafcutter::fab
