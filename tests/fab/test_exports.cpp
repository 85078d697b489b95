#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fab/cut/audit.h"
#include "fab/export/formats.h"
#include "geometry/error.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::fab {
namespace {

CutProgram sample_program() {
    CutProgram program;
    program.job = "Héllo (my) job! ~?\nM3 S1000";
    program.sheet = 2;
    program.material = "paper-160-blue";
    program.size = {600.0, 400.0};
    program.cut = {40.0, 900.0, 2};
    program.score = {12.5, 1500.0, 1};
    program.engrave = {10.0, 2400.0, 1};
    program.estimated_s = 754.2;
    program.paths = {
        {Operation::Engrave, {{10.0, 10.0}, {10.0, 14.0}, {12.0, 14.00049}}, "W1.1"},
        {Operation::Score, {{20.0, 5.0}, {20.0, 15.0}}, "W1.1"},
        {Operation::Cut, {{5.0, 5.0}, {60.12345, 5.0}, {60.0, 15.0}, {5.0, 5.0}}, "W1.1"},
        {Operation::Cut, {{100.0, 5.0}, {160.0, 5.0}, {160.0, 15.0}, {100.0, 5.0}}, "P2.1"}};
    return program;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        lines.push_back(line);
    }
    return lines;
}

std::string gcode(Dialect dialect = Dialect::Grbl) {
    return write_gcode(sample_program(), {}, dialect);
}

TEST(Gcode, HeaderNamesTheJobInHarmlessLettersOnly) {
    const std::vector<std::string> lines = lines_of(gcode());
    EXPECT_EQ(lines[1], "; job: H_llo _my_ job_ _M3 S1000");
    EXPECT_EQ(lines[2], "; sheet: 2, 600 x 400 mm");
    EXPECT_EQ(lines[3], "; material: paper-160-blue");
    EXPECT_EQ(lines[4], "; estimated time: 0:12:34, 754 s");
}

TEST(Gcode, HoldsNoLineOverEightyCharactersAndNothingButAscii) {
    CutProgram program = sample_program();
    program.job = std::string(500, 'x');
    for (const std::string& line : lines_of(write_gcode(program, {}, Dialect::Grbl))) {
        EXPECT_LE(line.size(), 80U);
        EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](char c) {
            return c >= ' ' && c <= '}' && c != '!' && c != '?';
        })) << line;
    }
}

TEST(Gcode, StartsInMillimetresAndEndsDarkAndParked) {
    const std::vector<std::string> lines = lines_of(gcode());
    ASSERT_GT(lines.size(), 12U);
    EXPECT_EQ(lines[5], "G21");
    EXPECT_EQ(lines[6], "G90");
    EXPECT_EQ(lines[8], "M4 S0");
    EXPECT_EQ(lines[lines.size() - 2], "M5 S0");
    EXPECT_EQ(lines.back(), "G0 X0 Y0");
}

class GcodeDialects : public testing::TestWithParam<Dialect> {};

TEST_P(GcodeDialects, ArePlainMotionLinesWithTheLaserOnInG1Only) {
    const std::regex rapid(R"(G0 X-?\d+(\.\d{1,3})? Y-?\d+(\.\d{1,3})?( S0)?)");
    const std::regex burn(
        R"(G1 X-?\d+(\.\d{1,3})? Y-?\d+(\.\d{1,3})?( S\d+(\.\d{1,3})?)?( F\d+)?)");
    bool powered = false;
    for (const std::string& line : lines_of(gcode(GetParam()))) {
        if (line.rfind("G0", 0) == 0) {
            EXPECT_TRUE(std::regex_match(line, rapid)) << line;
            powered = false;
        } else if (line.rfind("G1", 0) == 0) {
            EXPECT_TRUE(std::regex_match(line, burn)) << line;
            powered |= line.find('S') != std::string::npos;
            EXPECT_TRUE(powered) << "power after a rapid must be named anew: " << line;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All,
                         GcodeDialects,
                         testing::Values(Dialect::Grbl, Dialect::Marlin, Dialect::Smoothie));

TEST(Gcode, ScalesPowerToWhatTheFirmwareTakesForFull) {
    const auto cut = [](Dialect dialect) {
        return write_gcode(sample_program(), MachineProfile(), dialect);
    };
    EXPECT_NE(cut(Dialect::Grbl).find(" S400 F900\n"), std::string::npos);
    EXPECT_NE(cut(Dialect::Marlin).find(" S102 F900\n"), std::string::npos);
    EXPECT_NE(cut(Dialect::Smoothie).find(" S0.4 F900\n"), std::string::npos);
}

TEST(Gcode, ScalesPowerToTheMachine) {
    MachineProfile machine;
    machine.s_max = 255.0;
    const std::string text = write_gcode(sample_program(), machine, Dialect::Marlin);
    EXPECT_NE(text.find(" S102 F900\n"), std::string::npos) << "cut: 40 % of 255";
    EXPECT_NE(text.find(" S31.875 F1500\n"), std::string::npos) << "score: 12.5 %";
    EXPECT_NE(text.find("M4 I1 S0\n"), std::string::npos);
}

TEST(Gcode, RepeatsACutForEveryPass) {
    const std::string text = gcode();
    const std::string corner = "G1 X60 Y15\n";
    const std::size_t first = text.find(corner);
    ASSERT_NE(first, std::string::npos);
    EXPECT_NE(text.find(corner, first + 1), std::string::npos);
    EXPECT_EQ(text.find("G0", first), text.rfind("G0", text.find("X100 Y5", first)))
        << "no rapid between the passes of a closed contour";
}

TEST(Gcode, RefusesToBurnWithoutAFeed) {
    CutProgram program = sample_program();
    program.score.feed_mm_per_min = 0.0;
    EXPECT_THROW(write_gcode(program, {}, Dialect::Grbl), geometry::Error);
}

TEST(Gcode, ReadsBackAsWhatWasPlanned) {
    const BurnAudit audit = audit_burn(sample_program(), burnt_segments(gcode()));
    EXPECT_LT(audit.largest_deviation_mm, 1e-3);
    EXPECT_LT(audit.largest_gap_mm, 1e-3);
    EXPECT_NEAR(audit.burnt_mm, audit.planned_mm, 0.01);
}

TEST(Svg, IsTrueToSizeWithOneGroupPerOperationAndPiecesNamed) {
    CutProgram program = sample_program();
    program.job = "<job> & \"co\"";
    const std::string svg = write_svg(program);
    EXPECT_NE(svg.find("width=\"600mm\" height=\"400mm\" viewBox=\"0 0 600 400\""),
              std::string::npos);
    EXPECT_NE(svg.find("<title>&lt;job&gt; &amp; &quot;co&quot;, sheet 2"), std::string::npos);
    EXPECT_LT(svg.find("id=\"engrave\""), svg.find("id=\"score\""));
    EXPECT_LT(svg.find("id=\"score\""), svg.find("id=\"cut\""));
    EXPECT_NE(svg.find("id=\"cut-P2.1\" data-piece=\"P2.1\" "
                       "d=\"M100,395 160,395 160,385Z\"><title>P2.1, cut</title>"),
              std::string::npos);
    EXPECT_NE(svg.find("data-piece=\"W1.1\" d=\"M20,395 20,385\">"), std::string::npos);
}

TEST(Svg, HasALayerOfInkscapePerOperationInTheColoursOfLaserPrograms) {
    const std::string svg = write_svg(sample_program());
    for (const auto& [name, colour] :
         {std::pair("engrave", "#000000"), std::pair("score", "#0000ff"),
          std::pair("cut", "#ff0000")}) {
        EXPECT_NE(svg.find(fmt::format("<g id=\"{0}\" inkscape:groupmode=\"layer\" "
                                       "inkscape:label=\"{0}\" fill=\"none\" stroke=\"{1}\"",
                                       name, colour)),
                  std::string::npos)
            << name;
    }
}

TEST(Svg, MakesOneElementOfAllThatAPieceHasInALayer) {
    CutProgram program = sample_program();
    program.paths.push_back({Operation::Engrave, {{1.0, 1.0}, {2.0, 1.0}}, "P2.1"});
    program.paths.push_back({Operation::Engrave, {{3.0, 1.0}, {4.0, 1.0}}, "W1.1"});
    const std::string svg = write_svg(program);
    const std::regex element("id=\"engrave-[^\"]*\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(svg.begin(), svg.end(), element), {}), 2);
    EXPECT_NE(svg.find("d=\"M10,390 10,386 12,386M3,399 4,399\""), std::string::npos);
}

TEST(Dxf, HasALayerPerOperationAndClosedPolylines) {
    const std::string dxf = write_dxf(sample_program());
    const std::vector<std::string> lines = lines_of(dxf);
    EXPECT_EQ(lines.size() % 2, 0U) << "codes and values alternate";
    EXPECT_EQ(lines.back(), "EOF");
    int closed = 0;
    int open = 0;
    int vertices = 0;
    for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
        if (lines[i] == "0" && lines[i + 1] == "VERTEX") {
            ++vertices;
        }
        if (lines[i] == "0" && lines[i + 1] == "POLYLINE") {
            // 0 POLYLINE, 8 layer, 66, 10, 20, 30, 70 flag.
            EXPECT_EQ(lines[i + 12], "70");
            (lines[i + 13] == "1" ? closed : open) += 1;
            EXPECT_EQ(lines[i + 3] == "CUT", lines[i + 13] == "1");
        }
    }
    EXPECT_EQ(closed, 2);
    EXPECT_EQ(open, 2);
    EXPECT_EQ(vertices, 3 + 2 + 3 + 3);
}

// A contour with two tabs and a lead-in, a closed one with an over-cut, a common edge.
CutProgram program_with_options() {
    CutProgram program;
    program.size = {200.0, 100.0};
    program.cut = {40.0, 900.0, 1};
    CutPath tabbed{Operation::Cut,
                   {{10.0, 10.0}, {60.0, 10.0}, {60.0, 30.0}, {10.0, 30.0}, {10.0, 10.0}},
                   "W1.1"};
    tabbed.tabs = {{20.0, 21.0}, {90.0, 91.0}};
    tabbed.lead_in = Eigen::Vector2d(8.0, 8.0);
    CutPath common{Operation::Cut, {{100.0, 10.0}, {100.0, 40.0}}, "W2.1"};
    common.other_piece = "W3.1";
    CutPath closed{
        Operation::Cut, {{120.0, 10.0}, {160.0, 10.0}, {160.0, 30.0}, {120.0, 10.0}}, "W4.1"};
    closed.over_cut_mm = 2.0;
    program.paths = {tabbed, common, closed};
    return program;
}

TEST(Gcode, LeadsInLeavesTabsDarkAndRunsPastTheStart) {
    const std::string text = write_gcode(program_with_options(), {}, Dialect::Grbl);
    EXPECT_NE(text.find("G0 X8 Y8 S0\nG1 X10 Y10 S400 F900\nG1 X30 Y10\nG0 X31 Y10 S0\n"
                        "G1 X60 Y10 S400\nG1 X60 Y30\nG1 X40 Y30\nG0 X39 Y30 S0\n"
                        "G1 X10 Y30 S400\nG1 X10 Y10\n"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("G1 X120 Y10\nG1 X122 Y10\n"), std::string::npos) << text;
    const BurnAudit audit = audit_burn(program_with_options(), burnt_segments(text));
    EXPECT_LT(audit.largest_gap_mm, 1e-3);
    EXPECT_NEAR(audit.burnt_mm, audit.planned_mm, 1e-2);
}

TEST(Svg, DrawsTabsAsGapsAndLeadInsOnALayerOfTheirOwn) {
    const std::string svg = write_svg(program_with_options());
    EXPECT_NE(svg.find("d=\"M31,90 60,90 60,70 40,70M39,70 10,70 10,90 30,90\""), std::string::npos)
        << svg;
    EXPECT_NE(svg.find("<path id=\"lead-in-W1.1\" data-piece=\"W1.1\" d=\"M8,92 10,90\""),
              std::string::npos);
    EXPECT_NE(svg.find("d=\"M120,90 160,90 160,70Z\""), std::string::npos) << "no over-cut";
    EXPECT_EQ(write_svg(sample_program()).find("lead-in"), std::string::npos);
}

// Other programs' eyes: 77 means that one is not there.
int status_of(const std::string& command) {
    return WEXITSTATUS(std::system(command.c_str()));
}

TEST(Svg, HasItsTrueSizeInInkscape) {
    const test::TempDir dir;
    const std::string file = (dir.path() / "sheet.svg").string();
    std::ofstream(file, std::ios::binary) << write_svg(program_with_options());
    const std::string out = (dir.path() / "sizes.txt").string();
    if (status_of(fmt::format("command -v inkscape >/dev/null || exit 77; "
                              "inkscape --query-all '{}' > '{}' 2>/dev/null",
                              file, out)) == 77) {
        GTEST_SKIP() << "no inkscape";
    }
    // Sizes in CSS pixels, 96 to an inch, with the stroke's 0.1 mm.
    constexpr double kPixelsPerMm = 96.0 / 25.4;
    std::ifstream lines(out);
    bool found = false;
    for (std::string line; std::getline(lines, line);) {
        double x = 0.0;
        double y = 0.0;
        double width = 0.0;
        double height = 0.0;
        if (std::sscanf(line.c_str(), "cut-W1.1,%lf,%lf,%lf,%lf", &x, &y, &width, &height) == 4) {
            found = true;
            EXPECT_NEAR(width / kPixelsPerMm, 50.1, 0.02);
            EXPECT_NEAR(height / kPixelsPerMm, 20.1, 0.02);
            EXPECT_NEAR(x / kPixelsPerMm, 9.95, 0.02);
            EXPECT_NEAR(y / kPixelsPerMm, 69.95, 0.02);
        }
    }
    EXPECT_TRUE(found);
}

TEST(Dxf, OpensContoursAtTabsAndKeepsTheOthersClosed) {
    const test::TempDir dir;
    const std::string file = (dir.path() / "sheet.dxf").string();
    std::ofstream(file, std::ios::binary) << write_dxf(program_with_options());
    const std::string script = (dir.path() / "read.py").string();
    std::ofstream(script)
        << "import sys\n"
           "import ezdxf\n"
           "drawing = ezdxf.readfile(sys.argv[1])\n"
           "audit = drawing.audit()\n"
           "lines = list(drawing.modelspace())\n"
           "kinds = sorted((line.dxf.layer, line.is_closed, len(line)) for line in lines)\n"
           "ok = not audit.errors and not audit.fixes and kinds == [\n"
           "    ('CUT', False, 2), ('CUT', False, 4), ('CUT', False, 4), ('CUT', True, 3),\n"
           "    ('LEAD_IN', False, 2)]\n"
           "print(kinds)\n"
           "sys.exit(0 if ok else 1)\n";
    const int status = status_of(
        fmt::format("for p in python3 /usr/bin/python3; do $p -c 'import ezdxf' 2>/dev/null && "
                    "exec $p '{}' '{}'; done; exit 77",
                    script, file));
    if (status == 77) {
        GTEST_SKIP() << "no python3 with ezdxf";
    }
    EXPECT_EQ(status, 0);
}

// Another program's eyes: 77 means that it is not there.
TEST(Dxf, IsReadWithoutComplaintByAnIndependentReader) {
    const test::TempDir dir;
    const std::string file = (dir.path() / "sheet.dxf").string();
    std::ofstream(file, std::ios::binary) << write_dxf(sample_program());
    const std::string script = (dir.path() / "read.py").string();
    std::ofstream(script) << "import sys\n"
                             "import ezdxf\n"
                             "drawing = ezdxf.readfile(sys.argv[1])\n"
                             "audit = drawing.audit()\n"
                             "lines = list(drawing.modelspace())\n"
                             "cuts = [line for line in lines if line.dxf.layer == 'CUT']\n"
                             "ok = (not audit.errors and not audit.fixes and len(lines) == 4 and\n"
                             "      len(cuts) == 2 and all(cut.is_closed for cut in cuts) and\n"
                             "      drawing.header['$INSUNITS'] == 4)\n"
                             "sys.exit(0 if ok else 1)\n";
    const int status = std::system(
        fmt::format("for p in python3 /usr/bin/python3; do $p -c 'import ezdxf' 2>/dev/null && "
                    "exec $p '{}' '{}'; done; exit 77",
                    script, file)
            .c_str());
    if (WEXITSTATUS(status) == 77) {
        GTEST_SKIP() << "no python3 with ezdxf";
    }
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace leafcutter::fab
