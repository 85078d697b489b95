#include "server/burn_log.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"

namespace leafcutter::server {

std::vector<drivers::BurntPiece> read_burnt_pieces(std::string_view text) {
    std::vector<drivers::BurntPiece> pieces;
    int number = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        ++number;
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) {
            continue;
        }
        try {
            const auto record = nlohmann::json::parse(line);
            drivers::BurntPiece piece;
            piece.s = record.at("s").get<double>();
            if (piece.s > 0.0) {
                piece.x0_mm = record.at("x0").get<double>();
                piece.y0_mm = record.at("y0").get<double>();
                piece.x1_mm = record.at("x1").get<double>();
                piece.y1_mm = record.at("y1").get<double>();
                pieces.push_back(piece);
            }
        } catch (const nlohmann::json::exception& error) {
            throw geometry::Error(geometry::ErrorKind::BadFile, "bad-burn-log",
                                  fmt::format("burn log, line {}: {}", number, error.what()));
        }
    }
    return pieces;
}

std::vector<fab::BurntSegment> read_burn_log(std::string_view text) {
    std::vector<fab::BurntSegment> burnt;
    for (const drivers::BurntPiece& piece : read_burnt_pieces(text)) {
        burnt.push_back({{piece.x0_mm, piece.y0_mm}, {piece.x1_mm, piece.y1_mm}});
    }
    return burnt;
}

std::vector<std::vector<fab::BurntSegment>> part_by_sheet(std::span<const fab::BurntSegment> burnt,
                                                          std::span<const fab::CutProgram> plans) {
    std::vector<std::vector<fab::BurntSegment>> parts(plans.size());
    std::size_t part = 0;
    double done_mm = 0.0;
    for (const fab::BurntSegment& segment : burnt) {
        const double length_mm = (segment.to - segment.from).norm();
        while (part + 1 < plans.size() && done_mm + length_mm / 2.0 > plans[part].burn_mm) {
            done_mm = std::max(0.0, done_mm - plans[part].burn_mm);
            ++part;
        }
        parts[part].push_back(segment);
        done_mm += length_mm;
    }
    return parts;
}

}  // namespace leafcutter::server
