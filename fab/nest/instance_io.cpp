// An item: {"id", "demand", "allowed_orientations": [degrees]?, "min_quality"?, "shape"}, a shape
// {"type": "simple_polygon", "data": [[x, y]…]} (first point repeated or not, either orientation),
// {"type": "polygon", "data": {"outer", "inner": […]}} or {"type": "rectangle", "data": {"x_min",
// "y_min", "width", "height"}}. Either "strip_height" or "bins": [{"id", "stock", "cost", "shape",
// "zones": [{"quality", "shape"}]}]. In a layout an item is rotated first, then translated.

#include "fab/nest/instance_io.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/nest/shape.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& what) {
    throw geometry::Error(geometry::ErrorKind::BadFile, "bad-instance", what);
}

const json& member(const json& object, const char* key, const std::string& where) {
    if (!object.is_object() || !object.contains(key)) {
        refuse(fmt::format("{}: \"{}\" is missing", where, key));
    }
    return object.at(key);
}

double number(const json& value, const std::string& where) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
        refuse(fmt::format("{}: must be a finite number", where));
    }
    return value.get<double>();
}

int whole(const json& value, const std::string& where, int least, int most) {
    const double found = number(value, where);
    if (found != std::floor(found) || found < least || found > most) {
        refuse(fmt::format("{}: must be a whole number from {} to {}", where, least, most));
    }
    return static_cast<int>(found);
}

Ring ring_of(const json& points, const std::string& where) {
    if (!points.is_array()) {
        refuse(fmt::format("{}: must be a list of points", where));
    }
    Ring ring;
    for (const json& point : points) {
        if (!point.is_array() || point.size() != 2) {
            refuse(fmt::format("{}: a point must be [x, y]", where));
        }
        const Eigen::Vector2d at(number(point[0], where), number(point[1], where));
        if (ring.empty() || at != ring.back()) {
            ring.push_back(at);
        }
    }
    if (ring.size() > 1 && ring.front() == ring.back()) {
        ring.pop_back();
    }
    return ring;
}

// The corners of a closed ring; its first point comes again at its end.
Ring closed_ring_of(const json& points, const std::string& where) {
    Ring ring = ring_of(points, where);
    const bool closed = points.size() > 1 && points.front() == points.back();
    if (!closed) {
        refuse(fmt::format("{}: the outline is open: its last point must be its first one again",
                           where));
    }
    return ring;
}

// The outline of a shape; inner rings go to `holes`.
Ring shape_of(const json& shape, const std::string& where, std::vector<Ring>* holes) {
    const json& type = member(shape, "type", where);
    const json& content = member(shape, "data", where);
    if (type == "simple_polygon") {
        return closed_ring_of(content, where);
    }
    if (type == "rectangle") {
        const double x = number(member(content, "x_min", where), where);
        const double y = number(member(content, "y_min", where), where);
        const double w = number(member(content, "width", where), where);
        const double h = number(member(content, "height", where), where);
        if (!(w > 0.0) || !(h > 0.0)) {
            refuse(fmt::format("{}: width and height must be above 0", where));
        }
        return {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
    }
    if (type == "polygon") {
        Ring outer = closed_ring_of(member(content, "outer", where), where);
        if (content.contains("inner")) {
            const json& inner = content.at("inner");
            if (!inner.is_array()) {
                refuse(fmt::format("{}: \"inner\" must be a list of rings", where));
            }
            for (std::size_t i = 0; i < inner.size() && holes != nullptr; ++i) {
                holes->push_back(
                    closed_ring_of(inner[i], fmt::format("{}: hole {}", where, i + 1)));
            }
        }
        return outer;
    }
    refuse(fmt::format("{}: the type must be simple_polygon, polygon or rectangle", where));
}

// Angles and intervals [from, to]; none: as drawn.
Rotations rotations_of(const json& list, const std::string& where) {
    if (!list.is_array()) {
        refuse(fmt::format("{}: must be a list of angles or of intervals [from, to]", where));
    }
    std::vector<AngleInterval> intervals;
    for (const json& entry : list) {
        const bool pair = entry.is_array() && entry.size() == 2;
        const double from = number(pair ? entry[0] : entry, where);
        const double to = pair ? number(entry[1], where) : from;
        if (from > to || std::abs(from) > 1e6 || std::abs(to) > 1e6) {
            refuse(
                fmt::format("{}: an interval must go from a smaller angle to a larger one", where));
        }
        intervals.push_back({from, to});
    }
    return intervals.empty() ? Rotations{0.0} : Rotations(std::move(intervals));
}

InstanceItem item_of(const json& entry, std::size_t index) {
    std::string where = fmt::format("items[{}]", index);
    InstanceItem item;
    item.id = whole(member(entry, "id", where), where + ".id", 0, 1 << 30);
    where = fmt::format("item {}", item.id);
    item.demand = whole(member(entry, "demand", where), where + ".demand", 0, 1'000'000);
    item.outline = shape_of(member(entry, "shape", where), where + ".shape", nullptr);
    if (entry.contains("allowed_orientations") && !entry.at("allowed_orientations").is_null()) {
        item.allowed_deg =
            rotations_of(entry.at("allowed_orientations"), where + ".allowed_orientations");
    }
    if (entry.contains("min_quality") && !entry.at("min_quality").is_null()) {
        item.min_quality = whole(entry.at("min_quality"), where + ".min_quality", 0, 1000);
    }
    return item;
}

InstanceBin bin_of(const json& entry, std::size_t index) {
    std::string where = fmt::format("bins[{}]", index);
    InstanceBin bin;
    bin.id = whole(member(entry, "id", where), where + ".id", 0, 1 << 30);
    where = fmt::format("bin {}", bin.id);
    bin.stock =
        entry.contains("stock") ? whole(entry.at("stock"), where + ".stock", 0, 100'000) : 1;
    bin.cost = entry.contains("cost") ? number(entry.at("cost"), where + ".cost") : 1.0;
    std::vector<Ring> holes;
    bin.outline = shape_of(member(entry, "shape", where), where + ".shape", &holes);
    for (Ring& hole : holes) {
        bin.zones.push_back({0, std::move(hole)});
    }
    if (entry.contains("zones")) {
        const json& zones = entry.at("zones");
        if (!zones.is_array()) {
            refuse(fmt::format("{}.zones: must be a list", where));
        }
        for (std::size_t i = 0; i < zones.size(); ++i) {
            const std::string zone = fmt::format("{}.zones[{}]", where, i);
            bin.zones.push_back({whole(member(zones[i], "quality", zone), zone, 0, 1000),
                                 shape_of(member(zones[i], "shape", zone), zone, nullptr)});
        }
    }
    return bin;
}

json placed_items(const NestInstance& instance, const InstanceLayout& layout) {
    json items = json::array();
    for (const InstancePlacement& placed : layout.placed) {
        items.push_back({{"item_id", instance.items[placed.item].id},
                         {"transformation",
                          {{"rotation", placed.rotation_deg},
                           {"translation", {placed.offset.x(), placed.offset.y()}}}}});
    }
    return items;
}

std::string svg_path(const Ring& ring) {
    std::string path = "M";
    for (const Eigen::Vector2d& point : ring) {
        path += fmt::format(" {:.6g},{:.6g}", point.x(), -point.y());
    }
    return path + " Z";
}

}  // namespace

NestInstance read_instance(std::string_view text) {
    json root;
    try {
        root = json::parse(text);
    } catch (const json::exception& error) {
        refuse(fmt::format("no JSON: {}", error.what()));
    }
    NestInstance instance;
    if (root.is_object() && root.contains("name") && root.at("name").is_string()) {
        instance.name = root.at("name").get<std::string>();
    }
    const json& items = member(root, "items", "instance");
    if (!items.is_array()) {
        refuse("items: must be a list");
    }
    for (const json& entry : items) {
        instance.items.push_back(item_of(entry, instance.items.size()));
    }
    if (root.contains("strip_height")) {
        instance.strip_height = number(root.at("strip_height"), "strip_height");
        if (!(instance.strip_height > 0.0)) {
            refuse("strip_height: must be above 0");
        }
        return instance;
    }
    const json& bins = member(root, "bins", "instance without strip_height");
    if (!bins.is_array() || bins.empty()) {
        refuse("bins: must be a list of at least one");
    }
    for (const json& entry : bins) {
        instance.bins.push_back(bin_of(entry, instance.bins.size()));
    }
    return instance;
}

std::string write_solution(const NestInstance& instance, const InstanceSolution& solution) {
    json out;
    out["name"] = instance.name;
    out["density"] = solution.density;
    out["smallest_gap"] = solution.smallest_gap;
    json unplaced = json::array();
    for (const std::size_t item : solution.unplaced) {
        unplaced.push_back(instance.items[item].id);
    }
    out["unplaced_items"] = std::move(unplaced);
    if (instance.strip_height > 0.0) {
        out["strip_width"] = solution.strip_width;
        out["strip_height"] = instance.strip_height;
        out["layout"] = {{"placed_items", solution.layouts.empty()
                                              ? json::array()
                                              : placed_items(instance, solution.layouts.front())},
                         {"density", solution.density}};
        return out.dump(1) + "\n";
    }
    json layouts = json::array();
    for (const InstanceLayout& layout : solution.layouts) {
        layouts.push_back({{"bin_id", instance.bins[*layout.bin].id},
                           {"density", layout.density},
                           {"placed_items", placed_items(instance, layout)}});
    }
    out["layouts"] = std::move(layouts);
    return out.dump(1) + "\n";
}

std::string draw_solution(const NestInstance& instance, const InstanceSolution& solution) {
    std::string body;
    double y = 0.0;
    double width = 0.0;
    double thin = 0.0;
    for (const InstanceLayout& layout : solution.layouts) {
        Ring frame{{0.0, 0.0},
                   {solution.strip_width, 0.0},
                   {solution.strip_width, instance.strip_height},
                   {0.0, instance.strip_height}};
        if (layout.bin) {
            frame = instance.bins[*layout.bin].outline;
        }
        const Box box = bounds(frame);
        thin = 0.001 * box.size().maxCoeff();
        y += box.size().y();
        body += fmt::format("<g transform=\"translate({:.6g} {:.6g})\">\n", -box.low.x(),
                            y + box.low.y());
        body += fmt::format("<path d=\"{}\" fill=\"#eee\" stroke=\"#000\"/>\n", svg_path(frame));
        if (layout.bin) {
            for (const InstanceZone& zone : instance.bins[*layout.bin].zones) {
                body += fmt::format("<path d=\"{}\" fill=\"{}\"/>\n", svg_path(zone.outline),
                                    zone.quality <= 0 ? "#fff" : "#fcc");
            }
        }
        for (const InstancePlacement& placed : layout.placed) {
            const Ring ring =
                moved(instance.items[placed.item].outline, {placed.rotation_deg, placed.offset});
            body += fmt::format("<path d=\"{}\" fill=\"hsl({} 60% 70%)\" stroke=\"#333\"/>\n",
                                svg_path(ring), placed.item * 47 % 360);
        }
        body += "</g>\n";
        y += 0.05 * box.size().y();
        width = std::max(width, box.size().x());
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.6g} {:.6g}\" "
        "stroke-width=\"{:.6g}\">\n{}</svg>\n",
        width, y, thin, body);
}

}  // namespace leafcutter::fab
