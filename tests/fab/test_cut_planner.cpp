// The cut planner's promises on random sheets, with every option on and off.

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fab/cut/audit.h"
#include "fab/cut/motion.h"
#include "fab/cut/path_walk.h"
#include "fab/cut/segment_grid.h"
#include "fab/cut/sheet_reader.h"
#include "fab/cut/toolpath.h"
#include "fab/export/formats.h"
#include "fab/nest/random.h"
#include "fab/nest/shape.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

using Eigen::Vector2d;

constexpr double kKerfMm = 0.2;

Material board() {
    Material material;
    material.id = "board";
    material.kerf_mm = kKerfMm;
    material.thickness_mm = 3.0;
    material.weight_g_per_m2 = 1800.0;
    material.cut = {40.0, 900.0, 1};
    material.score = {15.0, 1500.0, 1};
    material.engrave = {10.0, 2400.0, 1};
    return material;
}

struct Layout {
    Sheet sheet;
    std::vector<Piece> pieces;
};

// Parts a rectangle again and again; neighbours lie a kerf apart, or sometimes farther.
class Partition {
public:
    explicit Partition(std::uint64_t seed) : random_(seed) {}

    Layout layout() {
        layout_.sheet.size = {900.0, 900.0};
        turn_deg_ = random_.below(3) == 0 ? random_.between(0.0, 360.0)
                                          : 90.0 * static_cast<double>(random_.below(4));
        part({-random_.between(60.0, 180.0), -random_.between(40.0, 150.0)},
             {random_.between(60.0, 180.0), random_.between(40.0, 150.0)}, 0);
        return std::move(layout_);
    }

private:
    void part(const Vector2d& low, const Vector2d& high, int depth) {
        const Vector2d size = high - low;
        const int axis = size.x() > size.y() ? 0 : 1;
        if (size[axis] < 24.0 || depth > 5 || (depth > 1 && random_.below(6) == 0)) {
            add(low, high);
            return;
        }
        const double gap = random_.below(5) == 0 ? random_.between(1.0, 4.0) : kKerfMm;
        const double at = low[axis] + size[axis] * random_.between(0.3, 0.7);
        Vector2d middle = high;
        middle[axis] = at;
        part(low, middle, depth + 1);
        middle = low;
        middle[axis] = at + gap;
        part(middle, high, depth + 1);
    }

    // A rectangle, or one with a corner cut off; with corners in straight edges, marks and slits.
    void add(const Vector2d& low, const Vector2d& high) {
        const Vector2d size = high - low;
        Piece piece;
        piece.id = fmt::format("W{}.1", layout_.pieces.size() + 1);
        piece.outline = {{0.0, 0.0}};
        if (random_.below(2) == 0) {
            piece.outline.emplace_back(size.x() * random_.between(0.2, 0.8), 0.0);
        }
        piece.outline.emplace_back(size.x(), 0.0);
        if (random_.below(4) == 0) {
            piece.outline.emplace_back(size.x(), size.y() / 2.0);
            piece.outline.emplace_back(size.x() / 2.0, size.y());
        } else {
            piece.outline.emplace_back(size.x(), size.y());
        }
        piece.outline.emplace_back(0.0, size.y());
        if (random_.below(2) == 0) {
            Mark mark;
            mark.operation = random_.below(2) == 0 ? Operation::Score : Operation::Engrave;
            mark.path = {{size.x() * 0.3, 0.0}, {size.x() * 0.3, size.y()}};
            piece.marks.push_back(mark);
        }
        if (random_.below(3) == 0) {
            piece.cuts.push_back({{size.x() * 0.4, 2.0}, {size.x() * 0.4, size.y() * 0.4}});
        }
        const double angle = turn_deg_ / 180.0 * 3.14159265358979323846;
        const Vector2d corner = Eigen::Rotation2Dd(angle) * low + Vector2d(450.0, 450.0);
        layout_.sheet.placements.push_back({piece.id, corner.x(), corner.y(), turn_deg_, false});
        layout_.pieces.push_back(std::move(piece));
    }

    Random random_;
    Layout layout_;
    double turn_deg_ = 0.0;
};

CutParams random_wishes(std::uint64_t seed) {
    Random random(seed * 7919 + 3);
    CutParams wishes;
    wishes.common_edges = random.below(2) == 0;
    wishes.lead_in_mm = random.below(2) == 0 ? random.between(0.5, 3.0) : 0.0;
    wishes.tabs = static_cast<int>(random.below(4));
    wishes.tab_mm = random.between(0.3, 1.5);
    wishes.over_cut_mm = random.below(2) == 0 ? random.between(0.2, 2.0) : 0.0;
    wishes.heat = random.below(4) == 0 ? 0.5 : 0.0;
    return wishes;
}

std::vector<Ring> outlines_of(const Layout& layout) {
    std::vector<Ring> rings;
    for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
        rings.emplace_back();
        for (const Vector2d& point : layout.pieces[i].outline) {
            rings.back().push_back(layout.sheet.placements[i].apply(point));
        }
    }
    return rings;
}

// Convex rings, counter-clockwise: each edge moved outward by half the kerf.
Ring beam_ring(const Ring& outline) {
    Ring ring;
    const std::size_t count = outline.size();
    const auto moved = [&](std::size_t i) {
        const Vector2d along = (outline[(i + 1) % count] - outline[i % count]).normalized();
        return Vector2d(along.y(), -along.x());
    };
    for (std::size_t i = 0; i < count; ++i) {
        const Vector2d a = moved(i + count - 1);
        const Vector2d b = moved(i);
        ring.push_back(outline[i] + kKerfMm / 2.0 * (a + b) / (1.0 + a.dot(b)));
    }
    return ring;
}

struct Sampled {
    Vector2d point;
    double mm = 0.0;
};

std::vector<Sampled> samples_of(const std::vector<Segment>& segments, double step_mm) {
    std::vector<Sampled> out;
    for (const Segment& segment : segments) {
        const Vector2d way = segment.to - segment.from;
        const int parts = std::max(1, static_cast<int>(std::ceil(way.norm() / step_mm)));
        for (int i = 0; i < parts; ++i) {
            out.push_back({segment.from + (i + 0.5) / parts * way, way.norm() / parts});
        }
    }
    return out;
}

std::vector<Segment> edges_of(const Ring& ring) {
    std::vector<Segment> edges;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    return edges;
}

std::vector<Segment> lines_of(const Polyline& points) {
    std::vector<Segment> lines;
    for (std::size_t i = 1; i < points.size(); ++i) {
        lines.push_back({points[i - 1], points[i]});
    }
    return lines;
}

void append(std::vector<Segment>& all, const std::vector<Segment>& more) {
    all.insert(all.end(), more.begin(), more.end());
}

// Length of all contours, what two of them share counted once.
double length_to_cut(const std::vector<Ring>& contours) {
    double sum = 0.0;
    for (std::size_t i = 0; i < contours.size(); ++i) {
        std::vector<Segment> others;
        for (std::size_t k = 0; k < contours.size(); ++k) {
            if (k != i) {
                append(others, edges_of(contours[k]));
            }
        }
        for (const Sampled& sample : samples_of(edges_of(contours[i]), 0.1)) {
            const bool shared =
                !others.empty() && SegmentGrid(others).distance(sample.point) < 0.005;
            sum += sample.mm * (shared ? 0.5 : 1.0);
        }
    }
    return sum;
}

class RandomSheets : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        const auto seed = static_cast<std::uint64_t>(GetParam());
        layout_ = Partition(seed).layout();
        wishes_ = random_wishes(seed);
        program_ = plan_sheet(layout_.sheet, layout_.pieces, {board(), {}, wishes_});
        outlines_ = outlines_of(layout_);
        for (const Ring& outline : outlines_) {
            contours_.push_back(beam_ring(outline));
            append(contour_edges_, edges_of(contours_.back()));
        }
    }

    std::vector<const CutPath*> cuts() const {
        std::vector<const CutPath*> cuts;
        for (const CutPath& path : program_.paths) {
            if (path.operation == Operation::Cut) {
                cuts.push_back(&path);
            }
        }
        return cuts;
    }

    bool is_slit(const CutPath& path) const {
        const auto middle = (path.points[0] + path.points[1]) / 2.0;
        return SegmentGrid(contour_edges_).distance(middle) > 0.05;
    }

    Layout layout_;
    CutParams wishes_;
    CutProgram program_;
    std::vector<Ring> outlines_;
    std::vector<Ring> contours_;
    std::vector<Segment> contour_edges_;
};

TEST_P(RandomSheets, CutsEveryContourOnceAndNothingElse) {
    std::vector<Segment> cut;
    std::vector<Segment> tabs;
    double length = 0.0;
    for (const CutPath* path : cuts()) {
        if (is_slit(*path)) {
            continue;
        }
        for (const Polyline& run : burnt_runs(*path)) {
            append(cut, lines_of(run));
            length += length_mm(run);
        }
        for (const DarkStretch& tab : path->tabs) {
            append(tabs, lines_of(stretch(path->points, tab.from_mm, tab.to_mm)));
            length += tab.to_mm - tab.from_mm;
        }
    }
    ASSERT_FALSE(cut.empty());
    const SegmentGrid to_contours(contour_edges_);
    for (const Sampled& sample : samples_of(cut, 0.5)) {
        ASSERT_LT(to_contours.distance(sample.point), 0.02);
    }
    std::vector<Segment> all = cut;
    append(all, tabs);
    const SegmentGrid to_cuts(all);
    for (const Sampled& sample : samples_of(contour_edges_, 0.5)) {
        ASSERT_LT(to_cuts.distance(sample.point), 0.03);
    }
    if (wishes_.common_edges) {
        // Twice cut or left out, a stretch would show: nothing shorter than a kerf is told apart.
        EXPECT_NEAR(length, length_to_cut(contours_), 0.3 * static_cast<double>(contours_.size()));
        EXPECT_NEAR(
            program_.facts.common_edges_mm,
            [&] {
                double sum = 0.0;
                for (const Ring& ring : contours_) {
                    sum += length_mm(ring) + (ring.front() - ring.back()).norm();
                }
                return sum;
            }() -
                length_to_cut(contours_),
            0.3 * static_cast<double>(contours_.size()));
    } else {
        double sum = 0.0;
        for (const Ring& ring : contours_) {
            sum += length_mm(ring) + (ring.front() - ring.back()).norm();
        }
        EXPECT_NEAR(length, sum, 1e-3);
    }
}

TEST_P(RandomSheets, LeavesTabsUncutAndClearOfCornersAndMarks) {
    int found = 0;
    for (const CutPath* path : cuts()) {
        found += static_cast<int>(path->tabs.size());
        for (const DarkStretch& tab : path->tabs) {
            EXPECT_NEAR(tab.to_mm - tab.from_mm, wishes_.tab_mm, 1e-9);
            EXPECT_GE(tab.from_mm, 0.0);
            EXPECT_LE(tab.to_mm, length_mm(path->points) + 1e-9);
        }
    }
    EXPECT_EQ(found, program_.facts.tabs);
    EXPECT_EQ(found + program_.facts.tabs_dropped,
              wishes_.tabs * static_cast<int>(layout_.pieces.size()));
    // Nothing burns on the way of the beam across a tab.
    std::vector<Segment> burnt;
    Vector2d at = Vector2d::Zero();
    for (const Motion& motion : motions(program_, {})) {
        if (motion.burns) {
            burnt.push_back({at, motion.to});
        }
        at = motion.to;
    }
    for (const CutPath* path : cuts()) {
        for (const DarkStretch& tab : path->tabs) {
            const Vector2d middle =
                point_at(path->points, stations_mm(path->points), (tab.from_mm + tab.to_mm) / 2.0);
            EXPECT_GT(SegmentGrid(burnt).distance(middle),
                      std::min(wishes_.tab_mm / 2.0, 0.48) - 1e-3);
        }
    }
}

TEST_P(RandomSheets, LeadsInThroughTheWasteOnly) {
    int leads = 0;
    std::vector<Segment> edges;
    for (const Ring& outline : outlines_) {
        append(edges, edges_of(outline));
    }
    const SegmentGrid to_outlines(edges);
    for (const CutPath* path : cuts()) {
        if (!path->lead_in) {
            continue;
        }
        ++leads;
        EXPECT_TRUE(path->other_piece.empty());
        EXPECT_LE((*path->lead_in - path->points.front()).norm(), wishes_.lead_in_mm + 1e-9);
        for (const Sampled& sample : samples_of({{*path->lead_in, path->points.front()}}, 0.02)) {
            EXPECT_GE(to_outlines.distance(sample.point), kKerfMm / 2.0 - 0.03);
            for (const Ring& outline : outlines_) {
                EXPECT_FALSE(contains(outline, sample.point));
            }
        }
    }
    EXPECT_EQ(leads, program_.facts.lead_ins + program_.facts.lead_ins_shortened);
    if (wishes_.lead_in_mm == 0.0) {
        EXPECT_EQ(leads + program_.facts.lead_ins_dropped, 0);
    }
}

TEST_P(RandomSheets, CutsInnerThenCommonThenTheRest) {
    EXPECT_TRUE(std::is_sorted(
        program_.paths.begin(), program_.paths.end(),
        [](const CutPath& a, const CutPath& b) { return a.operation < b.operation; }));
    std::map<std::string, std::size_t> last_slit;
    std::map<std::string, std::size_t> last_common;
    std::map<std::string, std::size_t> first_outer;
    std::map<std::string, std::size_t> first_own;
    const std::vector<const CutPath*> order = cuts();
    for (std::size_t i = 0; i < order.size(); ++i) {
        const CutPath& path = *order[i];
        if (is_slit(path)) {
            last_slit[path.piece] = i;
            continue;
        }
        first_outer.try_emplace(path.piece, i);
        if (path.other_piece.empty()) {
            first_own.try_emplace(path.piece, i);
        } else {
            first_outer.try_emplace(path.other_piece, i);
            last_common[path.piece] = i;
            last_common[path.other_piece] = i;
        }
    }
    for (const auto& [piece, last] : last_slit) {
        EXPECT_LT(last, first_outer.at(piece)) << piece;
    }
    for (const auto& [piece, last] : last_common) {
        if (first_own.count(piece) > 0) {
            EXPECT_LT(last, first_own.at(piece)) << piece;
        }
    }
}

TEST_P(RandomSheets, ReadsBackFromGcodeAsPlanned) {
    for (const Dialect dialect : {Dialect::Grbl, Dialect::Smoothie}) {
        const BurnAudit audit =
            audit_burn(program_, burnt_segments(write_gcode(program_, {}, dialect)));
        EXPECT_LT(audit.largest_deviation_mm, 1.5e-3);
        EXPECT_LT(audit.largest_gap_mm, 1.5e-3);
        EXPECT_NEAR(audit.burnt_mm, audit.planned_mm, 0.05);
    }
}

TEST_P(RandomSheets, GiveEveryPieceBackFromGcodeAlone) {
    const BurntSheet sheet = read_sheet(write_gcode(program_, {}, Dialect::Grbl));
    SCOPED_TRACE(fmt::format("common {}, lead {}, tabs {} x {}, over {}", wishes_.common_edges,
                             wishes_.lead_in_mm, wishes_.tabs, wishes_.tab_mm,
                             wishes_.over_cut_mm.value_or(0.0)));
    EXPECT_EQ(sheet.stray_lines, 0);
    std::vector<int> found(contours_.size(), 0);
    for (const BurntPiece& burnt : sheet.pieces) {
        EXPECT_EQ(burnt.times, 1);
        const double area = std::abs(signed_area(burnt.contour));
        bool known = false;
        for (std::size_t i = 0; i < contours_.size(); ++i) {
            const Box box = bounds(burnt.contour);
            const Box other = bounds(contours_[i]);
            if (std::abs(area - signed_area(contours_[i])) < 0.01 * area + 3.0 &&
                (box.low - other.low).norm() + (box.high - other.high).norm() < 0.15) {
                ++found[i];
                known = true;
            }
        }
        EXPECT_TRUE(known || (burnt.in_net && burnt.marks.empty()));
    }
    EXPECT_EQ(std::count(found.begin(), found.end(), 1), std::ssize(found));
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomSheets, testing::Range(1, 61));

}  // namespace
}  // namespace leafcutter::fab
