// The pieces of a package nested by libnest2d, for comparison: peer_libnest2d PACKAGE… prints a
// table row for each. It takes convex polygons only, so each piece is its convex hull there (with
// the true area in the density); rotations in steps of 45 degrees.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <libnest2d/libnest2d.hpp>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace {

using libnest2d::Item;
using libnest2d::NfpPlacer;
using nlohmann::json;

constexpr double kUnitsPerMm = 1e5;

json read_file(const std::string& path) {
    std::ifstream file(path);
    return json::parse(file);
}

struct Point {
    double x = 0.0;
    double y = 0.0;
};

double turn(const Point& o, const Point& a, const Point& b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

// Clockwise, as libnest2d wants it (Andrew's monotone chain).
std::vector<Point> hull_of(std::vector<Point> points) {
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    std::vector<Point> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t floor = hull.size() + 1;
        for (const Point& p : points) {
            while (hull.size() > floor && turn(hull[hull.size() - 2], hull.back(), p) >= 0.0) {
                hull.pop_back();
            }
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

double area_of(const json& ring) {
    double twice = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const json& a = ring[i];
        const json& b = ring[(i + 1) % ring.size()];
        twice += a[0].get<double>() * b[1].get<double>() - b[0].get<double>() * a[1].get<double>();
    }
    return std::abs(twice) / 2.0;
}

struct Batch {
    double width_mm = 0.0;
    double height_mm = 0.0;
    double area_mm2 = 0.0;
    std::vector<Item> items;
};

// By family, on the size of its first sheet.
std::map<std::string, Batch> batches_of(const json& strips, const json& layout) {
    std::map<std::string, const json*> outlines;
    for (const json& piece : strips.at("pieces")) {
        outlines[piece.at("id").get<std::string>()] = &piece.at("outline");
    }
    std::map<std::string, Batch> batches;
    for (const json& sheet : layout.at("sheets")) {
        Batch& batch = batches[sheet.at("family").get<std::string>()];
        if (batch.items.empty()) {
            batch.width_mm = sheet.at("width_mm").get<double>();
            batch.height_mm = sheet.at("height_mm").get<double>();
        }
        for (const json& placement : sheet.at("placements")) {
            const json& ring = *outlines.at(placement.at("piece").get<std::string>());
            batch.area_mm2 += area_of(ring);
            std::vector<Point> points;
            for (const json& p : ring) {
                points.push_back({p[0].get<double>(), p[1].get<double>()});
            }
            ClipperLib::Path path;
            for (const Point& p : hull_of(points)) {
                path.emplace_back(std::llround(p.x * kUnitsPerMm), std::llround(p.y * kUnitsPerMm));
            }
            path.push_back(path.front());
            batch.items.emplace_back(path);
        }
    }
    return batches;
}

void run(const std::string& package, double margin_mm, double gap_mm) {
    const json layout = read_file(package + "/layout.json");
    std::map<std::string, Batch> batches = batches_of(read_file(package + "/strips.json"), layout);
    const auto begun = std::chrono::steady_clock::now();
    std::size_t sheets = 0;
    std::size_t left_over = 0;
    double used_mm2 = 0.0;
    double whole_mm2 = 0.0;
    for (auto& [family, batch] : batches) {
        libnest2d::NestConfig<NfpPlacer, libnest2d::FirstFitSelection> config;
        config.placer_config.rotations.clear();
        for (int step = 0; step < 8; ++step) {
            config.placer_config.rotations.emplace_back(step * std::acos(-1.0) / 4.0);
        }
        const auto units = [](double mm) { return std::llround(mm * kUnitsPerMm); };
        // Distances are kept to the bin's edge, too.
        const double edge_mm = 2.0 * margin_mm - gap_mm;
        const libnest2d::Box bin(units(batch.width_mm - edge_mm), units(batch.height_mm - edge_mm));
        const std::size_t count = libnest2d::nest(batch.items, bin, units(gap_mm), config);
        left_over += static_cast<std::size_t>(
            std::count_if(batch.items.begin(), batch.items.end(),
                          [](const Item& item) { return item.binId() < 0; }));
        sheets += count;
        used_mm2 += batch.area_mm2;
        whole_mm2 += static_cast<double>(count) * batch.width_mm * batch.height_mm;
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    std::printf("| %s | %zu | %.2f | %zu | %.1f |\n", package.c_str(), sheets,
                whole_mm2 > 0.0 ? 100.0 * used_mm2 / whole_mm2 : 0.0, left_over, seconds);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        std::fprintf(stderr, "peer_libnest2d MARGIN_MM GAP_MM PACKAGE...\n");
        return 2;
    }
    std::printf("| package | sheets | density %% | left over | seconds |\n|---|---|---|---|---|\n");
    for (int i = 3; i < argc; ++i) {
        run(argv[i], std::atof(argv[1]), std::atof(argv[2]));
    }
    return 0;
}
