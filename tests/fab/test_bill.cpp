#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fab/cut/toolpath.h"
#include "fab/job_result.h"
#include "fab/package/package_files.h"
#include "fab/pipeline.h"

namespace leafcutter::fab {
namespace {

using ::testing::HasSubstr;

Piece square(const std::string& id, Family family, double side) {
    Piece piece;
    piece.id = id;
    piece.strip = id.substr(0, id.find('.'));
    piece.family = family;
    piece.outline = {{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}};
    return piece;
}

Sheet sheet(int id, const Material& material, const SheetSize& size, const std::string& piece) {
    Sheet result;
    result.id = id;
    result.material = material.id;
    result.size = size;
    result.placements.push_back({piece, 10.0, 10.0, 0.0, false});
    return result;
}

// Two weft sheets of 100 x 100, one warp sheet of 200 x 50, a square on each.
JobResult small_job() {
    JobResult job;
    job.weft.id = "weft";
    job.weft.name = "Weft, \"fine\"";
    job.weft.weight_g_per_m2 = 100.0;
    job.weft.kerf_mm = 0.0;
    job.weft.sheets = {{{100.0, 100.0}, 3.0}, {{50.0, 50.0}, {}}};
    job.weft.cut = {50.0, 600.0, 2};
    job.weft.score = job.weft.engrave = {10.0, 600.0, 1};
    job.warp = job.weft;
    job.warp.id = "warp";
    job.warp.weight_g_per_m2 = 300.0;
    job.warp.sheets = {{{200.0, 50.0}, {}}};
    job.warp.price_per_m2 = 40.0;
    job.warp.currency = "CHF";
    job.pieces = {square("W1.1", Family::Weft, 20.0), square("W2.1", Family::Weft, 10.0),
                  square("P1.1", Family::Warp, 30.0), square("P2.1", Family::Warp, 40.0)};
    Mark line;
    line.operation = Operation::Score;
    line.path = {{5.0, 5.0}, {5.0, 15.0}};
    job.pieces[0].marks.push_back(line);
    job.layout.sheets = {sheet(1, job.weft, {100.0, 100.0}, "W1.1"),
                         sheet(2, job.weft, {100.0, 100.0}, "W2.1"),
                         sheet(3, job.warp, {200.0, 50.0}, "P1.1")};
    job.layout.unplaced = {"P2.1"};
    for (const Sheet& each : job.layout.sheets) {
        const Material& material = each.material == "weft" ? job.weft : job.warp;
        job.programs.push_back(plan_sheet(each, job.pieces, {material}));
    }
    return job;
}

TEST(Bill, CountsEachMaterialsSheetsPiecesAndLengths) {
    const Bill bill = make_bill(small_job());
    ASSERT_EQ(bill.lines.size(), 2U);
    const BillLine& weft = bill.lines[0];
    EXPECT_EQ(weft.material, "weft");
    EXPECT_EQ(weft.sheets, 2);
    EXPECT_EQ(weft.pieces, 2);
    EXPECT_NEAR(weft.strips_area_mm2, 500.0, 1e-9);
    EXPECT_NEAR(weft.sheets_area_mm2, 20'000.0, 1e-9);
    EXPECT_NEAR(weft.weight_g, 0.05, 1e-12);
    EXPECT_NEAR(weft.cut_mm, 2 * (80.0 + 40.0), 1e-6);  // Two passes.
    EXPECT_NEAR(weft.score_mm, 10.0, 1e-6);
    EXPECT_EQ(weft.engrave_mm, 0.0);
    EXPECT_EQ(weft.cost, 6.0);
    EXPECT_EQ(weft.currency, "EUR");
    const BillLine& warp = bill.lines[1];
    EXPECT_EQ(warp.sheets, 1);
    EXPECT_EQ(warp.pieces, 1);  // The other one fits on no sheet.
    EXPECT_NEAR(warp.weight_g, 900.0 * 300e-6, 1e-12);
    EXPECT_NEAR(warp.cost, 0.4, 1e-12);
    EXPECT_EQ(warp.currency, "CHF");
}

TEST(Bill, LengthsAndTimesAreThoseOfThePrograms) {
    const JobResult job = small_job();
    const Bill bill = make_bill(job);
    double burn = 0.0;
    double seconds = 0.0;
    for (const CutProgram& program : job.programs) {
        burn += program.burn_mm;
        seconds += program.estimated_s;
    }
    double billed = 0.0;
    double billed_s = 0.0;
    for (const BillLine& line : bill.lines) {
        billed += line.cut_mm + line.score_mm + line.engrave_mm;
        billed_s += line.machine_s;
    }
    EXPECT_NEAR(billed, burn, 1e-6 * burn);
    EXPECT_NEAR(billed_s, seconds, 1e-9 * seconds);
}

TEST(Bill, HasOneLineForASharedMaterial) {
    JobResult job = small_job();
    job.warp = job.weft;
    const Bill bill = make_bill(job);
    ASSERT_EQ(bill.lines.size(), 1U);
    EXPECT_EQ(bill.lines[0].sheets, 2);
}

TEST(Bill, HasNoCostWithoutAPrice) {
    JobResult job = small_job();
    job.weft.sheets.front().price.reset();
    const Bill bill = make_bill(job);
    EXPECT_EQ(bill.lines[0].cost, 0.0);
    EXPECT_EQ(bill.lines[0].currency, "");
    EXPECT_EQ(bill.lines[1].currency, "CHF");
}

TEST(BillCsv, HasALineForEachMaterialAndQuotesNames) {
    JobResult job = small_job();
    job.bill = make_bill(job);
    const std::string table = bill_csv(job);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
    EXPECT_THAT(table, HasSubstr("\r\nweft,\"Weft, \"\"fine\"\"\",2,2,5.0,200.0,0.05,0,10,240,"));
    EXPECT_THAT(table, HasSubstr(",6.00,EUR\r\n"));
}

struct PaperModel {
    const char* name;
    double longest_side_mm;
    double cell_mm;
    double paper_g_per_m2;
    double weight_g;
};

// Table 1 of the paper; cells as in its Table 2, papers as its weights and sizes imply.
TEST(Weight, IsThatOfThePapersTableOne) {
    const std::filesystem::path mesh =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data/meshes/eight-7k.off";
    if (!std::filesystem::exists(mesh)) {
        GTEST_SKIP() << "no shared meshes";
    }
    std::ifstream file(mesh, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    for (const PaperModel& model : {PaperModel{"Eight (L)", 653.0, 6.5, 115.0, 99.2},
                                    PaperModel{"Eight (S)", 254.0, 9.7, 130.0, 17.0}}) {
        Material paper = *find_material(built_in_materials(), "paper-120-ivory");
        paper.weight_g_per_m2 = model.paper_g_per_m2;
        JobParams params;
        params.scale.longest_side_mm = model.longest_side_mm;
        params.grid.strip_width_mm = model.cell_mm;
        params.material = {.warp = paper.id, .weft = paper.id};
        params.nesting.time_s = 0.01;
        const std::span<const char> letters(bytes);
        const PackageSummary woven =
            weave({"eight-7k.off", std::as_bytes(letters)}, params, {{&paper, 1}, {}}, {});
        const auto report = nlohmann::json::parse(woven.package.find("report.json")->bytes);
        const double weight = report.at("bill").at(0).at("weight_g").get<double>();
        EXPECT_NEAR(weight, model.weight_g, 0.15 * model.weight_g) << model.name;
    }
}

}  // namespace
}  // namespace leafcutter::fab
