#include "fab/cut/toolpath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "fab/clipper_paths.h"
#include "fab/cut/cut_contours.h"
#include "fab/cut/cut_order.h"
#include "fab/cut/estimate.h"
#include "fab/strips/labels.h"
#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

constexpr double kUnitsPerMm = 1e6;  // The offset is computed in whole nanometres.

// The paths of the beam's centre that leave `outline` whole. A gap narrower than the kerf closes
// and leaves a hole with a path of its own.
std::vector<Polyline> kerf_paths(Ring outline, double kerf_mm) {
    if (signed_area(outline) < 0.0) {
        std::reverse(outline.begin(), outline.end());  // A mirrored piece.
    }
    if (kerf_mm <= 0.0) {
        outline.push_back(outline.front());
        return {outline};
    }
    const ClipperLib::Paths grown =
        mitred_offset({clipper_path(outline, kUnitsPerMm)}, kerf_mm / 2.0 * kUnitsPerMm);
    std::vector<Polyline> paths;
    for (const ClipperLib::Path& path : grown) {
        paths.push_back(ring_of(path, kUnitsPerMm));
        paths.back().push_back(paths.back().front());
    }
    return paths;
}

using PathKey = std::vector<std::pair<std::int64_t, std::int64_t>>;

// The same for a path and its reverse, to a micrometre.
PathKey key_of(const Polyline& points) {
    PathKey key;
    for (const Eigen::Vector2d& point : points) {
        key.emplace_back(std::llround(point.x() * 1e3), std::llround(point.y() * 1e3));
    }
    PathKey reversed(key.rbegin(), key.rend());
    return std::min(key, reversed);
}

class PathCollector {
public:
    // Repeated points are dropped, and paths that were there before.
    void add(Operation operation, const Polyline& points, const std::string& piece) {
        constexpr double kSamePointMm = 5e-4;
        Polyline kept;
        for (const Eigen::Vector2d& point : points) {
            if (kept.empty() || (point - kept.back()).norm() > kSamePointMm) {
                kept.push_back(point);
            }
        }
        if (points.size() > 2 && points.front() == points.back() && !kept.empty()) {
            kept.back() = kept.front();
        }
        std::vector<CutPath>& paths = paths_[static_cast<std::size_t>(operation)];
        if (kept.size() > 1 && seen_.emplace(operation, key_of(kept)).second) {
            paths.push_back({operation, std::move(kept), piece});
        }
    }

    std::vector<CutPath> take(Operation operation) {
        return std::move(paths_[static_cast<std::size_t>(operation)]);
    }

private:
    std::array<std::vector<CutPath>, 3> paths_;
    std::set<std::pair<Operation, PathKey>> seen_;
};

Polyline placed(const Polyline& points, const Placement& placement) {
    Polyline out;
    out.reserve(points.size());
    for (const Eigen::Vector2d& point : points) {
        out.push_back(placement.apply(point));
    }
    return out;
}

std::map<std::string_view, const Piece*> by_id(std::span<const Piece> pieces) {
    std::map<std::string_view, const Piece*> index;
    for (const Piece& piece : pieces) {
        index.emplace(piece.id, &piece);
    }
    return index;
}

// Everything on a sheet, before there is any order in it.
class SheetContent {
public:
    SheetContent(const Sheet& sheet, std::span<const Piece> pieces, double kerf_mm) {
        const std::map<std::string_view, const Piece*> index = by_id(pieces);
        for (const Placement& placement : sheet.placements) {
            const auto piece = index.find(placement.piece);
            if (piece == index.end()) {
                throw geometry::Error(geometry::ErrorKind::BadOption, "unknown-piece",
                                      fmt::format("sheet {}: there is no piece {} to cut", sheet.id,
                                                  placement.piece));
            }
            add(*piece->second, placement, kerf_mm);
        }
    }

    std::vector<CutPath> take_marks(Operation operation) { return marks_.take(operation); }

    CutContours take_contours() {
        CutContours contours;
        contours.inner = inner_.take(Operation::Cut);
        contours.outer = outer_.take(Operation::Cut);
        contours.outlines = std::move(outlines_);
        contours.marks = std::move(lines_);
        return contours;
    }

private:
    void add(const Piece& piece, const Placement& placement, double kerf_mm) {
        for (const Mark& mark : piece.marks) {
            if (!mark.path.empty()) {
                add_mark(mark.operation, placed(mark.path, placement), piece.id);
            }
            if (!mark.text.empty()) {
                for (const Polyline& stroke : mark_strokes(mark)) {
                    add_mark(mark.operation, placed(stroke, placement), piece.id);
                }
            }
        }
        for (const Polyline& slit : piece.cuts) {
            add_lines(placed(slit, placement), piece.id);
            inner_.add(Operation::Cut, placed(slit, placement), piece.id);
        }
        outlines_.push_back(placed(piece.outline, placement));
        for (const Polyline& path : kerf_paths(outlines_.back(), kerf_mm)) {
            const bool hole = signed_area(path) < 0.0;
            (hole ? inner_ : outer_).add(Operation::Cut, path, piece.id);
        }
    }

    void add_mark(Operation operation, const Polyline& points, const std::string& piece) {
        add_lines(points, piece);
        marks_.add(operation, points, piece);
    }

    void add_lines(const Polyline& points, const std::string& piece) {
        std::vector<Segment>& lines = lines_[piece];
        for (std::size_t i = 1; i < points.size(); ++i) {
            lines.push_back({points[i - 1], points[i]});
        }
    }

    PathCollector marks_;
    PathCollector inner_;
    PathCollector outer_;
    std::vector<Ring> outlines_;
    std::map<std::string, std::vector<Segment>> lines_;
};

void add_paths(std::vector<CutPath> paths, CutProgram& program, Eigen::Vector2d& at) {
    for (CutPath& path : paths) {
        at = path.points.back();
        program.paths.push_back(std::move(path));
    }
}

}  // namespace

double usual_over_cut_mm(const Material& material) {
    return material.thickness_mm < 1.0 ? 0.0 : std::min(1.0, material.thickness_mm / 4.0);
}

CutProgram plan_sheet(const Sheet& sheet,
                      std::span<const Piece> pieces,
                      const CutSetup& setup,
                      const geometry::Context& context) {
    const Material& material = setup.material;
    CutProgram program;
    program.sheet = sheet.id;
    program.material = material.id;
    program.size = sheet.size;
    program.cut = material.cut;
    program.score = material.score;
    program.engrave = material.engrave;

    SheetContent content(sheet, pieces, material.kerf_mm);
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    for (const Operation operation : {Operation::Engrave, Operation::Score}) {
        add_paths(order_paths(content.take_marks(operation), at, {}, context), program, at);
    }
    CutWishes wishes;
    wishes.params = setup.wishes;
    wishes.over_cut_mm = setup.wishes.over_cut_mm.value_or(usual_over_cut_mm(material));
    wishes.kerf_mm = material.kerf_mm;
    wishes.cooling = cooling_of(material, setup.machine);
    wishes.from = at;
    PlannedCuts cuts = plan_cuts(sheet, content.take_contours(), wishes, context);
    program.facts = cuts.facts;
    add_paths(std::move(cuts.paths), program, at);
    const CutEstimate estimate = estimate_cut(program, setup.machine);
    program.burn_mm = estimate.burn_mm;
    program.travel_mm = estimate.travel_mm;
    program.estimated_s = estimate.seconds;
    return program;
}

}  // namespace leafcutter::fab
