// The engine on whole instances: strips, irregular bins, random small jobs.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <polyclipping/clipper.hpp>

#include "fab/nest/instance.h"
#include "fab/nest/instance_io.h"
#include "fab/nest/random.h"
#include "fab/nest/shape.h"
#include "geometry/error.h"

namespace leafcutter::fab {
namespace {

// Any star-shaped polygon is simple.
Ring random_star(Random& random, double size) {
    const std::size_t corners = 3 + random.below(8);
    Ring ring;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::acos(-1.0) *
                             (static_cast<double>(i) + 0.8 * random.unit()) /
                             static_cast<double>(corners);
        const double radius = size * random.between(0.2, 1.0);
        ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return ring;
}

NestInstance random_job(std::uint64_t seed) {
    Random random(seed);
    NestInstance instance;
    instance.name = "random";
    instance.strip_height = random.between(20.0, 60.0);
    const std::size_t items = 1 + random.below(4);
    for (std::size_t i = 0; i < items; ++i) {
        InstanceItem item;
        item.id = static_cast<int>(i);
        item.demand = 1 + static_cast<int>(random.below(3));
        item.outline = random_star(random, random.between(2.0, 9.5));
        const std::size_t turns = random.below(4);
        if (turns == 1) {
            item.allowed_deg = {0.0};
        } else if (turns == 2) {
            item.allowed_deg = {0.0, 180.0};
        } else if (turns == 3) {
            item.allowed_deg = {0.0, 90.0, 180.0, 270.0};
        }
        instance.items.push_back(std::move(item));
    }
    return instance;
}

ClipperLib::Path units(const Ring& ring) {
    ClipperLib::Path path;
    for (const Eigen::Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() * 1e6), std::llround(point.y() * 1e6));
    }
    if (!ClipperLib::Orientation(path)) {
        std::reverse(path.begin(), path.end());
    }
    return path;
}

double area_of(const ClipperLib::Paths& paths) {
    double area = 0.0;
    for (const ClipperLib::Path& path : paths) {
        area += ClipperLib::Area(path);
    }
    return area / 1e12;
}

// Area of `rings` in common with each other or outside of `frame`: by Clipper, which proves nothing
// in the engine.
double fault_area(const std::vector<Ring>& rings, const ClipperLib::Paths& frame) {
    double sum = 0.0;
    ClipperLib::Clipper clipper;
    for (const Ring& ring : rings) {
        clipper.AddPath(units(ring), ClipperLib::ptSubject, true);
        sum += ClipperLib::Area(units(ring)) / 1e12;
    }
    clipper.AddPaths(frame, ClipperLib::ptClip, true);
    ClipperLib::Paths covered;
    clipper.Execute(ClipperLib::ctIntersection, covered, ClipperLib::pftNonZero,
                    ClipperLib::pftEvenOdd);
    return sum - area_of(covered);
}

std::vector<Ring> placed_rings(const NestInstance& instance, const InstanceLayout& layout) {
    std::vector<Ring> rings;
    for (const InstancePlacement& placed : layout.placed) {
        rings.push_back(
            moved(instance.items[placed.item].outline, {placed.rotation_deg, placed.offset}));
    }
    return rings;
}

CompactionOptions short_search(std::uint64_t seed) {
    CompactionOptions options;
    options.seed = seed;
    options.max_evaluations = 3'000;
    return options;
}

void expect_sound(const NestInstance& instance, const InstanceSolution& solution) {
    ASSERT_EQ(solution.layouts.size(), 1U);
    const InstanceLayout& layout = solution.layouts.front();
    std::vector<int> left(instance.items.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] = instance.items[i].demand;
    }
    for (const InstancePlacement& placed : layout.placed) {
        --left[placed.item];
        EXPECT_TRUE(instance.items[placed.item].allowed_deg.allows(placed.rotation_deg, 0.0))
            << placed.rotation_deg;
    }
    for (const std::size_t item : solution.unplaced) {
        --left[item];
    }
    EXPECT_EQ(left, std::vector<int>(left.size(), 0));
    const Ring strip{{0.0, 0.0},
                     {solution.strip_width, 0.0},
                     {solution.strip_width, instance.strip_height},
                     {0.0, instance.strip_height}};
    EXPECT_NEAR(fault_area(placed_rings(instance, layout), {units(strip)}), 0.0, 1e-4);
}

TEST(NestInstance, SmallRandomJobsAreSound) {
    constexpr std::uint64_t kJobs = 1500;
    for (std::uint64_t seed = 1; seed <= kJobs; ++seed) {
        SCOPED_TRACE(seed);
        const NestInstance instance = random_job(seed);
        expect_sound(instance, solve(instance, short_search(seed), {}));
    }
}

TEST(NestInstance, IsTheSameOnOneThreadAndTwo) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const NestInstance instance = random_job(seed + 40);
        CompactionOptions options;
        options.seed = seed;
        options.max_evaluations = 100'000;
        geometry::Context two;
        two.threads = 2;
        EXPECT_EQ(write_solution(instance, solve(instance, options, {})),
                  write_solution(instance, solve(instance, options, two)));
    }
}

TEST(NestInstance, EveryImprovementIsShorterThanTheLast) {
    const NestInstance instance = random_job(77);
    CompactionOptions options;
    options.max_evaluations = 100'000;
    double width = std::numeric_limits<double>::infinity();
    int heard = 0;
    solve(instance, options, {}, [&](const InstanceSolution& solution) {
        EXPECT_LT(solution.strip_width, width);
        expect_sound(instance, solution);
        width = solution.strip_width;
        ++heard;
    });
    EXPECT_GT(heard, 1);
}

TEST(NestInstance, FillsAStripWithSquaresThatFitExactly) {
    NestInstance instance;
    instance.strip_height = 40.004;  // By a hair more than four squares.
    InstanceItem item;
    item.demand = 16;
    item.allowed_deg = {0.0};
    item.outline = {{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}, {0.0, 10.0}};
    instance.items.push_back(item);
    CompactionOptions options;
    options.max_evaluations = 1'000'000;
    // Four columns of four; five columns would be 80 %.
    EXPECT_GT(solve(instance, options, {}).density, 0.85);
}

// Eight of each of three tetrominoes: they lie in rows that leave nothing between them.
NestInstance tetrominoes() {
    NestInstance instance;
    instance.strip_height = 60.004;
    const std::vector<Ring> outlines{
        {{0, 0}, {30, 0}, {30, 10}, {10, 10}, {10, 20}, {0, 20}},
        {{0, 0}, {30, 0}, {30, 10}, {20, 10}, {20, 20}, {10, 20}, {10, 10}, {0, 10}},
        {{0, 0}, {20, 0}, {20, 10}, {30, 10}, {30, 20}, {10, 20}, {10, 10}, {0, 10}}};
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        InstanceItem item;
        item.id = static_cast<int>(i);
        item.demand = 8;
        item.allowed_deg = {0.0, 180.0};
        item.outline = outlines[i];
        instance.items.push_back(item);
    }
    return instance;
}

// Long enough for hops, of which each search makes its own.
TEST(NestInstance, CopiesInRowsAreTheSameOnOneThreadAndTwo) {
    const NestInstance instance = tetrominoes();
    CompactionOptions options;
    options.max_evaluations = 4'000'000;
    geometry::Context two;
    two.threads = 2;
    const InstanceSolution solution = solve(instance, options, two);
    expect_sound(instance, solution);
    EXPECT_GT(solution.density, 0.8);
    EXPECT_EQ(write_solution(instance, solution),
              write_solution(instance, solve(instance, options, {})));
}

NestInstance hide_with_hole_and_zone() {
    NestInstance instance;
    InstanceItem plain;
    plain.id = 0;
    plain.demand = 6;
    plain.outline = {{0.0, 0.0}, {20.0, 0.0}, {20.0, 10.0}, {0.0, 10.0}};
    plain.min_quality = 1;
    InstanceItem fine = plain;
    fine.id = 1;
    fine.demand = 3;
    fine.min_quality = 2;
    instance.items = {plain, fine};
    InstanceBin bin;
    bin.outline = {{0.0, 0.0}, {90.0, 0.0}, {80.0, 40.0}, {45.0, 30.0}, {5.0, 50.0}};
    bin.zones.push_back({0, {{30.0, 10.0}, {36.0, 10.0}, {36.0, 16.0}, {30.0, 16.0}}});
    bin.zones.push_back({1, {{50.0, 2.0}, {70.0, 2.0}, {70.0, 12.0}, {50.0, 12.0}}});
    instance.bins = {bin, bin};
    instance.bins[1].id = 1;
    return instance;
}

TEST(NestInstance, KeepsToIrregularBinsHolesAndQualities) {
    const NestInstance instance = hide_with_hole_and_zone();
    CompactionOptions options;
    options.max_evaluations = 400'000;
    const InstanceSolution solution = solve(instance, options, {});
    EXPECT_TRUE(solution.unplaced.empty());
    std::size_t placed = 0;
    for (const InstanceLayout& layout : solution.layouts) {
        placed += layout.placed.size();
        const InstanceBin& bin = instance.bins[*layout.bin];
        EXPECT_NEAR(fault_area(placed_rings(instance, layout),
                               {units(bin.outline), units(bin.zones[0].outline)}),
                    0.0, 1e-4);
        InstanceLayout fine;
        std::copy_if(layout.placed.begin(), layout.placed.end(), std::back_inserter(fine.placed),
                     [](const InstancePlacement& p) { return p.item == 1; });
        EXPECT_NEAR(fault_area(placed_rings(instance, fine),
                               {units(bin.outline), units(bin.zones[1].outline)}),
                    0.0, 1e-4);
    }
    EXPECT_EQ(placed, 9U);
}

// A square with two long thin arms: of a thousand random places in its bounds hardly one suits a
// square that is but little smaller.
TEST(NestInstance, FindsRoomThatRandomPlacesHardlyHit) {
    NestInstance instance;
    InstanceItem square;
    square.demand = 2;
    square.outline = {{0.0, 0.0}, {60.0, 0.0}, {60.0, 60.0}, {0.0, 60.0}};
    square.allowed_deg = {0.0};
    instance.items = {square};
    InstanceBin bin;
    bin.outline = {{0.0, 0.0},   {100.0, 0.0}, {100.0, 5.0}, {60.2, 5.0},
                   {60.2, 60.2}, {5.0, 60.2},  {5.0, 100.0}, {0.0, 100.0}};
    instance.bins = {bin, bin, bin};
    for (std::size_t i = 0; i < instance.bins.size(); ++i) {
        instance.bins[i].id = static_cast<int>(i);
    }
    const InstanceSolution solution = solve(instance, short_search(1), {});
    EXPECT_TRUE(solution.unplaced.empty());
    EXPECT_EQ(solution.layouts.size(), 2U);
}

TEST(NestInstance, ReportsWhatFitsNowhere) {
    NestInstance instance = hide_with_hole_and_zone();
    instance.items[1].outline = {{0.0, 0.0}, {200.0, 0.0}, {200.0, 1.0}};
    const InstanceSolution solution = solve(instance, short_search(1), {});
    EXPECT_EQ(solution.unplaced, std::vector<std::size_t>(3, 1));
}

TEST(NestInstance, NamesTheItemThatIsNoPolygon) {
    NestInstance instance = random_job(5);
    instance.items[0].id = 4711;
    instance.items[0].outline = {{0.0, 0.0}, {4.0, 0.0}, {1.0, 3.0}, {2.0, -1.0}};
    try {
        solve(instance, short_search(1), {});
        FAIL();
    } catch (const geometry::Error& error) {
        EXPECT_NE(std::string(error.what()).find("4711"), std::string::npos) << error.what();
    }
}

TEST(NestInstanceJson, ReadsBothKindsOfProblems) {
    const NestInstance strip = read_instance(
        R"({"name": "s", "strip_height": 10, "items": [{"id": 3, "demand": 2,
            "allowed_orientations": [0, 180],
            "shape": {"type": "simple_polygon", "data": [[0,0],[1,0],[1,1],[0,0]]}}]})");
    EXPECT_EQ(strip.strip_height, 10.0);
    EXPECT_EQ(strip.items[0].outline.size(), 3U);
    EXPECT_EQ(strip.items[0].allowed_deg.size(), 2U);
    const NestInstance bins = read_instance(
        R"({"items": [{"id": 0, "demand": 1, "shape": {"type": "rectangle",
            "data": {"x_min": 0, "y_min": 0, "width": 2, "height": 1}}}],
            "bins": [{"id": 1, "stock": 2, "cost": 5, "shape": {"type": "polygon", "data":
            {"outer": [[0,0],[9,0],[9,9],[0,0]], "inner": [[[5,1],[6,1],[6,2],[5,1]]]}}, "zones": []}]})");
    EXPECT_EQ(bins.bins[0].stock, 2);
    EXPECT_EQ(bins.bins[0].zones.size(), 1U);
    EXPECT_TRUE(bins.items[0].allowed_deg.empty());
}

TEST(NestInstanceJson, RefusesWhatIsNoInstance) {
    for (const char* text :
         {"", "[]", "{}", R"({"items": 3, "strip_height": 1})", R"({"items": []})",
          R"({"items": [{"id": 0}], "strip_height": 1})",
          R"({"items": [{"id": 0, "demand": 1.5, "shape": {}}], "strip_height": 1})",
          R"({"items": [{"id": 0, "demand": 1, "shape": {"type": "multi_polygon", "data": []}}],
              "strip_height": 1})"}) {
        EXPECT_THROW(read_instance(text), geometry::Error) << text;
    }
}

std::string refusal(const std::string& text) {
    try {
        const NestInstance instance = read_instance(text);
        solve(instance, short_search(1), {});
    } catch (const geometry::Error& error) {
        return error.what();
    }
    return {};
}

std::string strip_with(const std::string& item) {
    return R"({"strip_height": 10, "items": [)" + item + "]}";
}

std::string item_with(const std::string& fields) {
    return strip_with(R"({"id": 42, "demand": 1, )" + fields + "}");
}

std::string shape(const std::string& points) {
    return item_with(R"("shape": {"type": "simple_polygon", "data": )" + points + "}");
}

TEST(NestInstanceJson, NamesTheItemAndTheFault) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {shape("[[0,0],[4,0],[4,4]]"), "open"},
        {shape("[[0,0],[4,0],[0,0]]"), "three"},
        {shape("[[0,0],[4,0],[8,0],[0,0]]"), "no area"},
        {shape("[[0,0],[4,4],[4,0],[0,4],[0,0]]"), "crosses itself"},
        {shape("[[0,0],[1e308,0],[4,4],[0,0]]"), "within"},
        {shape("[[0,0],[4,0],[\"x\",4],[0,0]]"), "number"},
        {shape("[[0,0],[4,0,1],[4,4],[0,0]]"), "[x, y]"},
        {shape("[[0,0],[400,0],[400,400],[0,400],[0,0]]"), "too large"},
        {item_with(R"("shape": {"type": "disc", "data": []})"), "type"},
        {item_with(R"("shape": {"type": "rectangle", "data":
            {"x_min": 0, "y_min": 0, "width": -3, "height": 1}})"),
         "above 0"},
        {strip_with(R"({"id": 42, "demand": -1, "shape": {}})"), "demand"},
        {item_with(R"("allowed_orientations": [[5, -5]], "shape": {"type": "simple_polygon",
            "data": [[0,0],[1,0],[1,1],[0,0]]})"),
         "interval"},
    };
    for (const auto& [text, fault] : cases) {
        const std::string said = refusal(text);
        EXPECT_NE(said.find("item 42"), std::string::npos) << text << ": " << said;
        EXPECT_NE(said.find(fault), std::string::npos) << text << ": " << said;
    }
}

TEST(NestInstanceJson, NamesWhatIsThereTwiceOrNotAtAll) {
    const std::string triangle =
        R"("shape": {"type": "simple_polygon", "data": [[0,0],[1,0],[1,1],[0,0]]}})";
    const std::string item = R"({"id": 7, "demand": 1, )" + triangle;
    EXPECT_NE(refusal(strip_with(item + ", " + item)).find("item 7"), std::string::npos);
    EXPECT_NE(refusal(strip_with(R"({"id": 7, "demand": 0, )" + triangle)).find("demand"),
              std::string::npos);
    EXPECT_NE(refusal(R"({"strip_height": 0, "items": [)" + item + "]}").find("strip_height"),
              std::string::npos);
    EXPECT_NE(refusal(R"({"strip_height": 1e308, "items": [)" + item + "]}").find("strip_height"),
              std::string::npos);
    const std::string bin = R"({"id": 3, "stock": 1, "shape": {"type": "polygon", "data":
        {"outer": [[0,0],[4,4],[4,0],[0,4],[0,0]], "inner": []}}})";
    EXPECT_NE(refusal(R"({"bins": [)" + bin + R"(], "items": [)" + item + "]}").find("bin 3"),
              std::string::npos);
}

}  // namespace
}  // namespace leafcutter::fab
