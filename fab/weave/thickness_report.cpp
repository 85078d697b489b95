#include "fab/weave/thickness_report.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fab/strips/unfold.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector3d;

// Radii that are less than the allowed one by this part of it are equal to it.
constexpr double kRounding = 1e-6;

// Curvature, 1/mm: a radius of ten kilometres is straight.
constexpr double kStraight = 1e-7;

// Strips give a little lengthwise: a hole may be narrower by this part of it.
constexpr double kGive = 0.05;

// What a strip is bent along its middle line where the surface bends, cell by cell. 1/mm.
struct SurfaceBend {
    std::vector<double> length;  // Of the middle line in each cell.
    std::vector<double> fold;    // In each cell, spread over its width across the fold.
    std::vector<double> behind;  // Between each cell and the next, 0 behind the last.
};

class BendGauge {
public:
    BendGauge(const geometry::QuadMesh& mesh, const Strip& strip)
        : mesh_(mesh), cells_(walk_cells(mesh, strip)), count_(strip.quads.size()) {
        closed_ = strip.closed;
    }

    SurfaceBend run() const {
        SurfaceBend bend;
        for (std::size_t i = 0; i < count_; ++i) {
            bend.length.push_back(along(i).norm());
            bend.fold.push_back(fold(i));
        }
        for (std::size_t i = 0; i < count_; ++i) {
            const std::size_t next = i + 1 < count_ ? i + 1 : 0;
            bend.behind.push_back(next != 0 || closed_ ? turn(i, next) : 0.0);
        }
        return bend;
    }

private:
    const Vector3d& at(int vertex) const {
        return mesh_.vertices[static_cast<std::size_t>(vertex)];
    }
    Vector3d along(std::size_t i) const {
        const WalkedCell& c = cells_[i];
        return (at(c.l1) + at(c.r1) - at(c.l0) - at(c.r0)) / 2.0;
    }
    Vector3d normal(std::size_t i) const {
        const WalkedCell& c = cells_[i];
        return (at(c.r1) - at(c.l0)).cross(at(c.l1) - at(c.r0)).stableNormalized();
    }

    // Curvature of the middle line across the edge of two cells, in the plane of their normals:
    // what it turns within the surface was cut so.
    double turn(std::size_t i, std::size_t next) const {
        const Vector3d one = along(i);
        const Vector3d two = along(next);
        const Vector3d up = (normal(i) + normal(next)).stableNormalized();
        const double length = (one.norm() + two.norm()) / 2.0;
        if (length <= 0.0) {
            return 0.0;
        }
        const auto slope = [&](const Vector3d& v) {
            return std::atan2(v.dot(up), (v - v.dot(up) * up).norm());
        };
        return std::abs(slope(two) - slope(one)) / length;
    }

    // A fold sharp on the drawing is rolled over the width of the cell across it.
    double fold(std::size_t i) const {
        const WalkedCell& c = cells_[i];
        const double rising = folded({at(c.r0), at(c.l1)}, at(c.l0), at(c.r1));
        const double falling = folded({at(c.l0), at(c.r1)}, at(c.l1), at(c.r0));
        return std::min(rising, falling);
    }
    static double folded(const std::array<Vector3d, 2>& hinge,
                         const Vector3d& a,
                         const Vector3d& b) {
        const Vector3d axis = hinge[1] - hinge[0];
        const Vector3d one = axis.cross(a - hinge[0]);
        const Vector3d two = (b - hinge[0]).cross(axis);
        const double across = (one.norm() + two.norm()) / std::max(axis.norm(), 1e-12);
        return across > 0.0 ? std::atan2(one.cross(two).norm(), one.dot(two)) / across : 0.0;
    }

    const geometry::QuadMesh& mesh_;
    std::vector<WalkedCell> cells_;
    std::size_t count_;
    bool closed_ = false;
};

CrimpRule rule_of(const ThicknessRules& rules, Family family) {
    const std::size_t own = family == Family::Weft ? 0 : 1;
    return {rules.feel[own].thickness_mm, rules.feel[1 - own].thickness_mm,
            2.0 * rules.clearance_mm, rules.feel[own].min_radius_mm};
}

double radius_of(double curvature) {
    return curvature > kStraight ? 1.0 / curvature : 0.0;
}

// The tightest bend so far, and where.
struct Tightest {
    double curvature = 0.0;
    std::size_t cell = 0;

    void look(double other, std::size_t at) {
        if (other > curvature) {
            curvature = other;
            cell = at;
        }
    }
};

class StripJudge {
public:
    StripJudge(const SurfaceBend& bend, std::span<const Crossing> crossings, const CrimpRule& rule)
        : bend_(bend), crossings_(crossings), rule_(rule) {}

    StripBend run(bool closed) {
        const std::size_t count = crossings_.size();
        for (std::size_t i = 0; i < count; ++i) {
            surface_.look(bend_.fold[i], i);
            surface_.look(bend_.behind[i], i);
            const std::size_t next = i + 1 < count ? i + 1 : 0;
            if ((next != 0 || closed) && crossings_[i].on_top != crossings_[next].on_top) {
                change_side(i, next);
            }
        }
        all_.look(surface_.curvature, surface_.cell);
        for (const double extra : crimp_extra_mm(crossings_, bend_.length, rule_, closed)) {
            result_.crimp_mm += extra;
        }
        result_.surface_radius_mm = radius_of(surface_.curvature);
        result_.surface_cell = static_cast<int>(surface_.cell);
        result_.radius_mm = radius_of(all_.curvature);
        result_.cell = static_cast<int>(all_.cell);
        const double least = rule_.min_radius_mm * (1.0 - kRounding);
        result_.too_tight = result_.radius_mm > 0.0 && result_.radius_mm < least;
        return result_;
    }

private:
    // The way down is bent one way and then the other, so one of its arcs adds to what the surface
    // bends: it has to be that much wider.
    void change_side(std::size_t i, std::size_t next) {
        ++result_.changes;
        const double surface = bend_.behind[i];
        const double spacing = (bend_.length[i] + bend_.length[next]) / 2.0;
        const double left = 1.0 - surface * rule_.min_radius_mm;
        CrimpRule rule = rule_;
        rule.min_radius_mm = left > 0.0 ? rule.min_radius_mm / left : rule.min_radius_mm;
        const CrimpPath path = crimp_path(rule, spacing);
        const double needed = std::max(flat_gap_mm(rule), 0.0);
        result_.too_short = result_.too_short || needed > spacing;
        all_.look(surface + (path.radius_mm > 0.0 ? 1.0 / path.radius_mm : 0.0), i);
    }

    const SurfaceBend& bend_;
    std::span<const Crossing> crossings_;
    CrimpRule rule_;
    Tightest surface_;
    Tightest all_;
    StripBend result_;
};

FamilyThickness family_of(const CrimpRule& rule) {
    FamilyThickness family;
    family.thickness_mm = rule.own_mm;
    family.crossed_mm = rule.crossed_mm;
    family.min_radius_mm = rule.min_radius_mm;
    family.gap_mm = rule.gap_mm;
    family.needed_gap_mm = rule.own_mm;
    family.flat_gap_mm = flat_gap_mm(rule);
    const double room = std::max(rule.gap_mm, family.flat_gap_mm);
    family.lift_mm = crimp_path(rule, room).lift_mm;
    return family;
}

// "W3, W5 and 7 more".
std::string named(std::span<const Strip> strips, const std::vector<std::size_t>& which) {
    constexpr std::size_t kNamed = 6;
    std::string text;
    for (std::size_t i = 0; i < std::min(kNamed, which.size()); ++i) {
        text += fmt::format("{}{}", i == 0 ? "" : ", ", strips[which[i]].id);
    }
    if (which.size() > kNamed) {
        text += fmt::format(" and {} more", which.size() - kNamed);
    }
    return text;
}

const char* name_of(std::size_t family) {
    return family == 0 ? "weft" : "warp";
}

void warn_of_gaps(const ThicknessReport& report,
                  std::size_t f,
                  std::vector<std::string>& warnings) {
    const FamilyThickness& family = report.families[f];
    if (family.changes == 0) {
        return;
    }
    if (family.gap_mm < family.needed_gap_mm) {
        warnings.push_back(fmt::format(
            "{} strips are {:.3g} mm thick and can't pass gaps of {:.3g} mm: fit.clearance_mm must "
            "be at least {:.2f}",
            name_of(f), family.thickness_mm, family.gap_mm, report.need.pass_mm + 0.005));
    } else if (family.gap_mm < family.joint_mm * (1.0 - kRounding)) {
        warnings.push_back(fmt::format(
            "joints of {} pieces are {:.3g} mm thick, the gaps that they pass {:.3g} mm: "
            "fit.clearance_mm of {:.2f} would let them through",
            name_of(f), family.joint_mm, family.gap_mm, family.joint_mm / 2.0 + 0.005));
    }
}

// The strips of a family of which this is so.
std::vector<std::size_t> those(const ThicknessReport& report,
                               std::span<const Strip> strips,
                               std::size_t f,
                               bool StripBend::*fault) {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        if ((strips[i].family == Family::Weft) == (f == 0) && report.strips[i].*fault) {
            result.push_back(i);
        }
    }
    return result;
}

void warn_of_bends(const ThicknessReport& report,
                   std::span<const Strip> strips,
                   std::size_t f,
                   std::vector<std::string>& warnings) {
    const FamilyThickness& family = report.families[f];
    const auto tight = those(report, strips, f, &StripBend::too_tight);
    if (!tight.empty()) {
        warnings.push_back(fmt::format(
            "{}: bent more tightly than the {}'s material takes ({:.3g} mm), in {} down to a "
            "radius of {:.2g} mm",
            named(strips, tight), name_of(f), family.min_radius_mm, family.tightest,
            family.least_radius_mm));
    }
    const auto too_short = those(report, strips, f, &StripBend::too_short);
    if (!too_short.empty()) {
        warnings.push_back(fmt::format(
            "{}: cells shorter than the {:.3g} mm that the way from over to under takes",
            named(strips, too_short), family.flat_gap_mm));
    }
}

}  // namespace

ThicknessReport judge_thickness(const geometry::QuadMesh& mesh,
                                std::span<const Strip> strips,
                                const Crossings& crossings,
                                const ThicknessRules& rules) {
    ThicknessReport report;
    report.clearance_mm = rules.clearance_mm;
    report.need = clearance_need(rules.feel[0], rules.feel[1]);
    report.families = {family_of(rule_of(rules, Family::Weft)),
                       family_of(rule_of(rules, Family::Warp))};
    for (std::size_t f = 0; f < 2; ++f) {
        report.families[f].joint_mm = rules.joined[f] ? 2.0 * rules.feel[f].thickness_mm : 0.0;
    }
    report.strips.reserve(strips.size());
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const SurfaceBend bend = BendGauge(mesh, strips[i]).run();
        const CrimpRule rule = rule_of(rules, strips[i].family);
        report.strips.push_back(StripJudge(bend, crossings[i], rule).run(strips[i].closed));
        const StripBend& judged = report.strips.back();
        FamilyThickness& family = report.families[strips[i].family == Family::Weft ? 0 : 1];
        family.changes += judged.changes;
        family.crimp_mm += judged.crimp_mm;
        if (judged.radius_mm > 0.0 &&
            (family.tightest.empty() || judged.radius_mm < family.least_radius_mm)) {
            family.least_radius_mm = judged.radius_mm;
            family.tightest = strips[i].id;
        }
    }
    return report;
}

std::vector<std::string> thickness_warnings(const ThicknessReport& report,
                                            std::span<const Strip> strips,
                                            const WovenModel& model) {
    std::vector<std::string> warnings;
    for (std::size_t f = 0; f < 2; ++f) {
        warn_of_gaps(report, f, warnings);
        warn_of_bends(report, strips, f, warnings);
    }
    const auto passes = [](const FamilyThickness& family) {
        return family.changes == 0 || family.gap_mm >= family.needed_gap_mm;
    };
    // Where nothing passes at all, single crossings need no words.
    if (std::all_of(report.families.begin(), report.families.end(), passes) &&
        model.tight_crossings > 0) {
        std::vector<std::size_t> tight;
        for (const Clash& clash : model.tight) {
            const auto strip = static_cast<std::size_t>(clash.strip);
            if (std::find(tight.begin(), tight.end(), strip) == tight.end()) {
                tight.push_back(strip);
            }
        }
        warnings.push_back(fmt::format(
            "{}: at {} crossings thickness has too little room, by up to {:.2g} mm: the strips "
            "push each other aside there",
            named(strips, tight), model.tight_crossings, model.lacking_mm));
    }
    return warnings;
}

std::vector<std::string> threading_warnings(const geometry::QuadMesh& mesh,
                                            std::span<const Strip> strips,
                                            const Assembly& assembly,
                                            double clearance_mm) {
    std::vector<std::string> warnings;
    for (const AssemblyMove& move : assembly.moves) {
        if (move.kind != MoveKind::Thread) {
            continue;
        }
        const Strip& strip = strips[static_cast<std::size_t>(move.strip)];
        const std::vector<WalkedCell> cells = walk_cells(mesh, strip);
        const auto width = [&](int cell) {
            const WalkedCell& c = cells[static_cast<std::size_t>(cell)];
            const auto at = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
            return ((at(c.l0) - at(c.r0)).norm() + (at(c.l1) - at(c.r1)).norm()) / 2.0;
        };
        // What comes behind a held cell is pulled through it.
        double widest = 0.0;
        double lacking = 0.0;
        double hole = 0.0;
        for (auto cell = move.cells.rbegin(); cell != move.cells.rend(); ++cell) {
            const bool is_held =
                std::find(move.held.begin(), move.held.end(), *cell) != move.held.end();
            const double room = width(*cell) + clearance_mm;
            if (is_held && widest - room > std::max(lacking, kGive * room)) {
                lacking = widest - room;
                hole = room;
            }
            widest = std::max(widest, width(*cell) - 2.0 * clearance_mm);
        }
        if (lacking > 0.0) {
            warnings.push_back(fmt::format(
                "{}: has to be threaded through a hole of {:.3g} mm, {:.2g} mm less than it is "
                "wide behind it: roll it lengthwise",
                strip.id, hole, lacking));
        }
    }
    return warnings;
}

}  // namespace leafcutter::fab
