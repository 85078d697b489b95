#include "server/package_reader.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "server/material_json.h"
#include "server/params.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr const char* kReportFile = "report.json";
constexpr const char* kStripsFile = "strips.json";
constexpr const char* kStripsFormat = "leafcutter-strips/1";

[[noreturn]] void refuse_package(const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::BadFile, "bad-package", message);
}

// Parses `bytes` and hands them to `read`; whatever is wrong is the file's fault.
template <typename Read>
auto read_file(std::string_view bytes, const char* name, const char* format, const Read& read) {
    try {
        const json file = json::parse(bytes);
        const std::string found = file.at("format").get<std::string>();
        if (found != format) {
            refuse_package(fmt::format("{}: format is {}, not {}", name, found, format));
        }
        return read(file);
    } catch (const json::exception& error) {
        refuse_package(fmt::format("{}: {}", name, error.what()));
    }
}

Eigen::Vector2d read_point(const json& value) {
    return {value.at(0).get<double>(), value.at(1).get<double>()};
}

fab::Polyline read_points(const json& values) {
    fab::Polyline points;
    for (const json& value : values) {
        points.push_back(read_point(value));
    }
    return points;
}

fab::Mark read_mark(const json& value) {
    fab::Mark mark;
    mark.operation = value.at("kind").get<std::string>() == "score" ? fab::Operation::Score
                                                                    : fab::Operation::Engrave;
    if (value.contains("path")) {
        mark.path = read_points(value.at("path"));
    }
    if (value.contains("text")) {
        mark.text = value.at("text").get<std::string>();
        mark.at = read_point(value.at("at"));
        mark.angle_deg = value.at("angle_deg").get<double>();
        mark.height_mm = value.at("height_mm").get<double>();
    }
    return mark;
}

fab::Family read_family(const json& strip) {
    return strip.at("family").get<std::string>() == "warp" ? fab::Family::Warp : fab::Family::Weft;
}

fab::Piece read_piece(const json& value) {
    fab::Piece piece;
    piece.id = value.at("id").get<std::string>();
    piece.strip = value.at("strip").get<std::string>();
    piece.outline = read_points(value.at("outline"));
    if (piece.outline.size() < 3) {
        refuse_package(fmt::format("{}: piece {} has no outline", kStripsFile, piece.id));
    }
    for (const json& mark : value.at("marks")) {
        piece.marks.push_back(read_mark(mark));
    }
    for (const json& cut : value.value("cuts", json::array())) {
        piece.cuts.push_back(read_points(cut));
    }
    return piece;
}

fab::Sheet read_sheet(const json& value) {
    fab::Sheet sheet;
    sheet.id = value.at("id").get<int>();
    sheet.material = value.at("material").get<std::string>();
    sheet.family = value.value("family", "both");
    sheet.size = {value.at("width_mm").get<double>(), value.at("height_mm").get<double>()};
    if (value.contains("outline")) {
        sheet.outline = read_points(value.at("outline"));
    }
    for (const json& placement : value.at("placements")) {
        sheet.placements.push_back(
            {placement.at("piece").get<std::string>(), placement.at("x_mm").get<double>(),
             placement.at("y_mm").get<double>(), placement.at("rotation_deg").get<double>(),
             placement.value("mirrored", false)});
    }
    return sheet;
}

}  // namespace

std::vector<fab::Piece> read_pieces(std::string_view strips_json) {
    return read_file(strips_json, kStripsFile, kStripsFormat, [](const json& file) {
        std::map<std::string, fab::Family> families;
        for (const json& strip : file.at("strips")) {
            families[strip.at("id").get<std::string>()] = read_family(strip);
        }
        std::vector<fab::Piece> pieces;
        for (const json& value : file.at("pieces")) {
            pieces.push_back(read_piece(value));
            const auto family = families.find(pieces.back().strip);
            if (family == families.end()) {
                refuse_package(fmt::format("{}: piece {} is of a strip that is not there",
                                           kStripsFile, pieces.back().id));
            }
            pieces.back().family = family->second;
        }
        return pieces;
    });
}

std::vector<fab::Strip> read_strips(std::string_view strips_json) {
    return read_file(strips_json, kStripsFile, kStripsFormat, [](const json& file) {
        std::vector<fab::Strip> strips;
        for (const json& value : file.at("strips")) {
            fab::Strip strip;
            strip.id = value.at("id").get<std::string>();
            strip.family = read_family(value);
            strip.pieces = value.at("pieces").get<std::vector<std::string>>();
            strips.push_back(std::move(strip));
        }
        return strips;
    });
}

std::string pick_pieces(std::string_view strips_json, const std::set<std::string>& ids) {
    return read_file(strips_json, kStripsFile, kStripsFormat, [&ids](const json& file) {
        const auto wanted = [&ids](const json& id) { return ids.contains(id.get<std::string>()); };
        json picked = file;
        picked["pieces"] = json::array();
        for (const json& piece : file.at("pieces")) {
            if (wanted(piece.at("id"))) {
                picked["pieces"].push_back(piece);
            }
        }
        picked["strips"] = json::array();
        for (json strip : file.at("strips")) {
            json left = json::array();
            std::copy_if(strip.at("pieces").begin(), strip.at("pieces").end(),
                         std::back_inserter(left), wanted);
            strip["pieces"] = std::move(left);
            if (!strip["pieces"].empty()) {
                picked["strips"].push_back(std::move(strip));
            }
        }
        return picked.dump() + "\n";
    });
}

std::vector<fab::Sheet> read_sheets(std::string_view layout_json) {
    return read_file(layout_json, "layout.json", "leafcutter-layout/1", [](const json& file) {
        std::vector<fab::Sheet> sheets;
        for (const json& value : file.at("sheets")) {
            sheets.push_back(read_sheet(value));
        }
        return sheets;
    });
}

PackageFacts read_facts(std::string_view report_json) {
    return read_file(report_json, kReportFile, "leafcutter-report/1", [](const json& file) {
        if (!file.contains("params") || !file.contains("materials")) {
            refuse_package(fmt::format(
                "{}: doesn't say how the sheets were made (params, materials); it is of an older "
                "Leafcutter: weave the model again",
                kReportFile));
        }
        PackageFacts facts;
        facts.input.file = file.at("input").at("file").get<std::string>();
        facts.input.vertices = file.at("input").at("vertices").get<std::size_t>();
        facts.input.faces = file.at("input").at("faces").get<std::size_t>();
        facts.input.scale = file.at("input").at("scale").get<double>();
        facts.params_json = file.at("params").dump();
        const json& machine = file.at("machine");
        facts.machine.rapid_mm_per_min = machine.at("rapid_mm_per_min").get<double>();
        facts.machine.acceleration_mm_per_s2 = machine.at("acceleration_mm_per_s2").get<double>();
        facts.machine.s_max = machine.at("s_max").get<double>();
        try {
            facts.params = params_from_json(file.at("params"));
            facts.materials = materials_from_text(file.at("materials").dump(), {});
        } catch (const geometry::Error& error) {
            refuse_package(fmt::format("{}: {}", kReportFile, error.what()));
        }
        return facts;
    });
}

}  // namespace leafcutter::server
