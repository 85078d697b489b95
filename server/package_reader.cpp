#include "server/package_reader.h"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

// Parses `bytes` and hands them to `read`; whatever is wrong is the file's fault.
template <typename Read>
auto read_file(std::string_view bytes, const char* name, const char* format, const Read& read) {
    try {
        const json file = json::parse(bytes);
        const std::string found = file.at("format").get<std::string>();
        if (found != format) {
            throw geometry::Error(geometry::ErrorKind::BadFile, "bad-package",
                                  fmt::format("{}: format is {}, not {}", name, found, format));
        }
        return read(file);
    } catch (const json::exception& error) {
        throw geometry::Error(geometry::ErrorKind::BadFile, "bad-package",
                              fmt::format("{}: {}", name, error.what()));
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

fab::Piece read_piece(const json& value) {
    fab::Piece piece;
    piece.id = value.at("id").get<std::string>();
    piece.strip = value.at("strip").get<std::string>();
    piece.outline = read_points(value.at("outline"));
    if (piece.outline.size() < 3) {
        throw geometry::Error(geometry::ErrorKind::BadFile, "bad-package",
                              fmt::format("strips.json: piece {} has no outline", piece.id));
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
    return read_file(strips_json, "strips.json", "leafcutter-strips/1", [](const json& file) {
        std::vector<fab::Piece> pieces;
        for (const json& value : file.at("pieces")) {
            pieces.push_back(read_piece(value));
        }
        return pieces;
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

}  // namespace leafcutter::server
