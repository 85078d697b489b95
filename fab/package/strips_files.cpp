// The package's strips and layout: strips.json, layout.json.

#include <string>

#include <nlohmann/json.hpp>

#include "fab/package/package_files.h"

namespace leafcutter::fab {

namespace {

using nlohmann::json;

json point_json(const Eigen::Vector2d& point) {
    return {point.x(), point.y()};
}

json points_json(const Polyline& points) {
    json result = json::array();
    for (const Eigen::Vector2d& point : points) {
        result.push_back(point_json(point));
    }
    return result;
}

const char* name_of(Family family) {
    return family == Family::Weft ? "weft" : "warp";
}

const char* name_of(Bend bend) {
    switch (bend) {
        case Bend::Ac:
            return "ac";
        case Bend::Bd:
            return "bd";
        case Bend::None:
            break;
    }
    return "none";
}

json mark_json(const Mark& mark) {
    json result = {{"kind", mark.operation == Operation::Score ? "score" : "engrave"}};
    if (mark.text.empty()) {
        result["path"] = points_json(mark.path);
    } else {
        result["text"] = mark.text;
        result["at"] = point_json(mark.at);
        result["angle_deg"] = mark.angle_deg;
        result["height_mm"] = mark.height_mm;
    }
    return result;
}

json tab_json(const Tab& tab) {
    json result = {{"length_mm", tab.length_mm}, {"onto", tab.onto}};
    if (tab.slit_width_mm > 0.0) {
        result["slit_at_mm"] = tab.slit_at_mm;
        result["slit_width_mm"] = tab.slit_width_mm;
    }
    return result;
}

json piece_json(const Piece& piece) {
    json bend = json::array();
    for (const Bend cell : piece.bend) {
        bend.push_back(name_of(cell));
    }
    json marks = json::array();
    for (const Mark& mark : piece.marks) {
        marks.push_back(mark_json(mark));
    }
    json cuts = json::array();
    for (const Polyline& cut : piece.cuts) {
        cuts.push_back(points_json(cut));
    }
    return {{"id", piece.id},
            {"strip", piece.strip},
            {"family", name_of(piece.family)},
            {"first_cell", piece.first_cell},
            {"cell_count", piece.cell_count},
            {"left", points_json(piece.left)},
            {"right", points_json(piece.right)},
            {"bend", std::move(bend)},
            {"outline", points_json(piece.outline)},
            {"marks", std::move(marks)},
            {"cuts", std::move(cuts)},
            {"start_tab", tab_json(piece.start_tab)},
            {"end_tab", tab_json(piece.end_tab)}};
}

const char* zone_key(ZoneKind kind) {
    switch (kind) {
        case ZoneKind::Hole:
            return "holes";
        case ZoneKind::KeepOut:
            return "keep_out";
        case ZoneKind::Defect:
            break;
    }
    return "defects";
}

json offcut_json(const Offcut& offcut) {
    json holes = json::array();
    for (const Ring& hole : offcut.holes) {
        holes.push_back(points_json(hole));
    }
    return {{"id", offcut.id},
            {"outline", points_json(offcut.outline)},
            {"holes", std::move(holes)},
            {"area_mm2", offcut.area_mm2},
            {"rectangle",
             {{"x_mm", offcut.corner.x()},
              {"y_mm", offcut.corner.y()},
              {"width_mm", offcut.rectangle.width_mm},
              {"height_mm", offcut.rectangle.height_mm}}}};
}

json sheet_json(const Sheet& sheet) {
    json placements = json::array();
    for (const Placement& placement : sheet.placements) {
        placements.push_back({{"piece", placement.piece},
                              {"x_mm", placement.x_mm},
                              {"y_mm", placement.y_mm},
                              {"rotation_deg", placement.rotation_deg},
                              {"mirrored", placement.mirrored}});
    }
    json result = {{"id", sheet.id},
                   {"material", sheet.material},
                   {"family", sheet.family},
                   {"width_mm", sheet.size.width_mm},
                   {"height_mm", sheet.size.height_mm},
                   {"placements", std::move(placements)}};
    if (!sheet.outline.empty()) {
        result["outline"] = points_json(sheet.outline);
    }
    if (!sheet.stock.empty()) {
        result["stock"] = sheet.stock;
    }
    for (const SheetZone& zone : sheet.zones) {
        result[zone_key(zone.kind)].push_back(points_json(zone.outline));
    }
    if (sheet.offcut) {
        result["offcut"] = offcut_json(*sheet.offcut);
    }
    return result;
}

}  // namespace

std::string strips_json(const JobResult& job) {
    json strips = json::array();
    for (const Strip& strip : job.strips) {
        strips.push_back({{"id", strip.id},
                          {"family", name_of(strip.family)},
                          {"cylinders", strip.cylinders},
                          {"closed", strip.closed},
                          {"quads", strip.quads},
                          {"next", strip.next},
                          {"pieces", strip.pieces}});
    }
    json pieces = json::array();
    for (const Piece& piece : job.pieces) {
        pieces.push_back(piece_json(piece));
    }
    const json file = {{"format", "leafcutter-strips/1"},
                       {"strips", std::move(strips)},
                       {"pieces", std::move(pieces)}};
    return file.dump() + "\n";
}

std::string layout_json(const JobResult& job) {
    json sheets = json::array();
    for (const Sheet& sheet : job.layout.sheets) {
        sheets.push_back(sheet_json(sheet));
    }
    const json file = {{"format", "leafcutter-layout/1"},
                       {"sheets", std::move(sheets)},
                       {"density_percent", job.layout.density_percent},
                       {"smallest_gap_mm", job.layout.smallest_gap_mm},
                       {"unplaced", job.layout.unplaced}};
    return file.dump() + "\n";
}

}  // namespace leafcutter::fab
