#include "fab/nest/construct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "fab/nest/collision.h"
#include "fab/nest/raster.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr double kRadian = 180.0 / std::numbers::pi;

// Points nearer than the gap plus this share of a raster cell count as taken. Less proposes tighter
// places and fails the exact test more often.
constexpr double kRasterSlack = 0.35;

// Kept above the wanted gap: numbers are rounded on their way into files.
constexpr double kGapGuardMm = 2e-4;

// What making a stencil costs, in rows of positions tried.
constexpr std::int64_t kStencilRows = 30;
constexpr std::int64_t kExactRows = 30;  // And an exact test.

struct OpenSheet {
    SheetRaster raster;
    PlacedOutlines outlines;
    double top_mm = 0.0;
    int failures_in_a_row = 0;
    double hopeless_diameter_mm = 0.0;  // Not asked again for anything as long as this.
    std::size_t laid = 0;
};

struct Spot {
    double angle_deg = 0.0;
    Ring ring;  // Rotated; lower left corner of its bounds at the origin.
    Eigen::Vector2d corner = Eigen::Vector2d::Zero();
    double score = 0.0;
};

// A shape at one rotation, ready to be tried.
struct Turned {
    double angle_deg = 0.0;
    Ring ring;
    Eigen::Vector2d size;
    double centre_y = 0.0;
    Stencil stencil;
};

class HeapBuilder {
public:
    HeapBuilder(const HeapOptions& options, const geometry::Context& context)
        : options_(options), context_(context), gap_(options.gap_mm + kGapGuardMm) {}

    Heap build(std::span<const NestShape> shapes, std::span<const std::size_t> order) {
        for (const std::size_t index : order) {
            context_.check();
            lay(shapes[index], index);
        }
        heap_.sheets = sheets_.size();
        heap_.last_top_mm = sheets_.empty() ? 0.0 : sheets_.back().top_mm;
        return std::move(heap_);
    }

private:
    void lay(const NestShape& shape, std::size_t index) {
        const std::vector<double> angles = first_angles(shape);
        for (std::size_t sheet = 0; sheet <= sheets_.size(); ++sheet) {
            if (sheet == sheets_.size()) {
                open_sheet();
            } else if (shape.diameter_mm >= sheets_[sheet].hopeless_diameter_mm) {
                continue;
            }
            const std::optional<Spot> spot = best_spot(sheets_[sheet], shape, angles);
            note_outcome(sheets_[sheet], shape, spot.has_value());
            if (spot) {
                settle_down(sheets_[sheet], *spot, {index, sheet, {}}, shape);
                return;
            }
            if (sheet + 1 < sheets_.size() || sheets_[sheet].laid > 0) {
                continue;
            }
            sheets_.pop_back();
            heap_.left_over.push_back(index);
            return;
        }
    }

    void open_sheet() {
        sheets_.push_back({SheetRaster(options_.extent, options_.cell_mm),
                           PlacedOutlines(options_.extent), 0.0, 0, 2.0 * options_.extent.norm(),
                           0});
        OpenSheet& sheet = sheets_.back();
        for (const Ring& ring : options_.taken) {
            sheet.raster.block(ring, kRasterSlack * options_.cell_mm);
            sheet.outlines.add(ring);
        }
    }

    static void note_outcome(OpenSheet& sheet, const NestShape& shape, bool found) {
        constexpr int kPatience = 4;
        constexpr double kShorter = 0.92;
        sheet.failures_in_a_row = found ? 0 : sheet.failures_in_a_row + 1;
        if (sheet.failures_in_a_row >= kPatience) {
            sheet.failures_in_a_row = 0;
            sheet.hopeless_diameter_mm = kShorter * shape.diameter_mm;
        }
    }

    std::vector<double> first_angles(const NestShape& shape) const {
        if (!shape.allowed_deg.empty()) {
            return shape.allowed_deg.samples();
        }
        std::vector<double> angles;
        constexpr double kSameDeg = 0.3;
        for (const double lying_deg : shape.lying_deg) {
            for (const double turn_deg : {0.0, 180.0, 90.0, 270.0}) {
                const double angle = lying_deg + turn_deg;
                const bool known = std::any_of(angles.begin(), angles.end(), [&](double other) {
                    return std::abs(std::remainder(angle - other, 360.0)) < kSameDeg;
                });
                if (!known) {
                    angles.push_back(angle);
                }
            }
        }
        return angles;
    }

    std::optional<Spot> best_spot(const OpenSheet& sheet,
                                  const NestShape& shape,
                                  const std::vector<double>& angles) {
        std::optional<Spot> best;
        for (const double angle : angles) {
            try_angle(sheet, shape, angle, best);
        }
        if (!shape.allowed_deg.empty()) {
            return best;
        }
        if (!best && sheet.laid == 0) {
            // A long piece may fit slanted only.
            if (const auto angle = fitting_angle(shape, options_.extent, {})) {
                try_angle(sheet, shape, *angle, best);
            }
        }
        if (best) {
            refine(sheet, shape, best);
        }
        return best;
    }

    // Turns the shape about its best rotation by ever smaller steps.
    void refine(const OpenSheet& sheet, const NestShape& shape, std::optional<Spot>& best) {
        const double finest = 0.5 * options_.cell_mm / shape.diameter_mm * kRadian;
        double step = std::min(12.0, 6.0 * shape.width_mm / shape.diameter_mm * kRadian);
        for (; step > finest; step *= 0.5) {
            const double from = best->angle_deg;
            try_angle(sheet, shape, from + step, best);
            try_angle(sheet, shape, from - step, best);
        }
    }

    std::optional<Turned> turn(const NestShape& shape, double angle_deg) const {
        Turned turned;
        turned.angle_deg = angle_deg;
        turned.ring = moved(shape.outline, {angle_deg, {0.0, 0.0}});
        const Box box = bounds(turned.ring);
        turned.size = box.size();
        if ((turned.size.array() > options_.extent.array()).any()) {
            return std::nullopt;
        }
        for (Eigen::Vector2d& point : turned.ring) {
            point -= box.low;
        }
        turned.centre_y =
            moved({shape.centroid}, {angle_deg, {0.0, 0.0}}).front().y() - box.low.y();
        return turned;
    }

    double base_score(const Turned& turned) const {
        return (1.0 - options_.top_weight) * turned.centre_y +
               options_.top_weight * turned.size.y();
    }

    // Replaces `best` if this rotation finds a lower place.
    void try_angle(const OpenSheet& sheet,
                   const NestShape& shape,
                   double angle_deg,
                   std::optional<Spot>& best) {
        std::optional<Turned> turned = turn(shape, angle_deg);
        if (!turned) {
            return;
        }
        const double h = options_.cell_mm;
        const double base = base_score(*turned);
        if (best && base >= best->score) {
            return;
        }
        turned->stencil = make_stencil(turned->ring, h);
        heap_.evaluations += kStencilRows;
        const Eigen::Vector2d play = (options_.extent - turned->size) / h;
        const int last_row = static_cast<int>(play.y());
        const int last_column = static_cast<int>(play.x());
        int tries_left = 8;
        for (int row = 0; row <= last_row && tries_left > 0; ++row) {
            if (best && base + row * h >= best->score) {
                return;
            }
            ++heap_.evaluations;
            if (!sheet.raster.free_positions(turned->stencil, row, last_column, blocked_)) {
                continue;
            }
            if (try_row(sheet, *turned, row, tries_left, best)) {
                return;
            }
        }
    }

    // The first few free positions of a row, from the left, against the exact outlines.
    bool try_row(const OpenSheet& sheet,
                 Turned& turned,
                 int row,
                 int& tries_left,
                 std::optional<Spot>& best) {
        int previous = -2;
        for (std::size_t word = 0; word < blocked_.size() && tries_left > 0; ++word) {
            std::uint64_t free = ~blocked_[word];
            while (free != 0 && tries_left > 0) {
                const int column = static_cast<int>(word) * 64 + std::countr_zero(free);
                free &= free - 1;
                if (column == previous + 1) {
                    previous = column;
                    continue;  // Within one run of free positions the left end is tried.
                }
                previous = column;
                --tries_left;
                const Eigen::Vector2d corner(column * options_.cell_mm, row * options_.cell_mm);
                if (const auto exact = nudge_free(sheet, turned, corner)) {
                    best = Spot{turned.angle_deg, std::move(turned.ring), *exact,
                                base_score(turned) + exact->y()};
                    return true;
                }
            }
        }
        return false;
    }

    // The raster is coarse: a collision by less than a cell is cured by a small step.
    std::optional<Eigen::Vector2d> nudge_free(const OpenSheet& sheet,
                                              const Turned& turned,
                                              const Eigen::Vector2d& corner) {
        static constexpr std::array<std::array<double, 2>, 4> kSteps{
            {{0.0, 0.0}, {0.0, 0.5}, {0.5, 0.0}, {0.0, 1.0}}};
        const Eigen::Vector2d play = options_.extent - turned.size;
        for (const auto& step : kSteps) {
            Eigen::Vector2d at = corner + options_.cell_mm * Eigen::Vector2d(step[0], step[1]);
            at = at.cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(play);
            heap_.evaluations += kExactRows;
            if (!sheet.outlines.collides(turned.ring, at, gap_)) {
                return at;
            }
        }
        return std::nullopt;
    }

    // Moves as far as possible along `direction`, to the nearest thousandth of a cell.
    void slide(const OpenSheet& sheet, Spot& spot, const Eigen::Vector2d& direction) const {
        for (double step = options_.cell_mm; step > 1e-3 * options_.cell_mm;) {
            const Eigen::Vector2d next =
                (spot.corner + step * direction).cwiseMax(Eigen::Vector2d::Zero());
            const bool moves = (next - spot.corner).squaredNorm() > 0.0;
            if (moves && !sheet.outlines.collides(spot.ring, next, gap_)) {
                spot.corner = next;
            } else {
                step *= 0.5;
            }
        }
    }

    void settle_down(OpenSheet& sheet, Spot spot, Laid laid, const NestShape& shape) {
        for (int round = 0; round < 2; ++round) {
            slide(sheet, spot, {0.0, -1.0});
            slide(sheet, spot, {-1.0, 0.0});
        }
        const Box box = bounds(moved(shape.outline, {spot.angle_deg, {0.0, 0.0}}));
        laid.pose = {spot.angle_deg, spot.corner - box.low};
        for (Eigen::Vector2d& point : spot.ring) {
            point += spot.corner;
        }
        sheet.raster.block(spot.ring, options_.gap_mm + kRasterSlack * options_.cell_mm);
        sheet.outlines.add(spot.ring);
        sheet.top_mm = std::max(sheet.top_mm, spot.corner.y() + box.size().y());
        ++sheet.laid;
        heap_.laid.push_back(laid);
    }

    const HeapOptions& options_;
    const geometry::Context& context_;
    double gap_;
    std::vector<OpenSheet> sheets_;
    std::vector<std::uint64_t> blocked_;
    Heap heap_;
};

}  // namespace

Heap build_heap(std::span<const NestShape> shapes,
                std::span<const std::size_t> order,
                const HeapOptions& options,
                const geometry::Context& context) {
    return HeapBuilder(options, context).build(shapes, order);
}

}  // namespace leafcutter::fab
