// Several heaps, under gravity towards either edge and in different orders; the best is kept and
// proven.

#include "fab/nest/nest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>

#include <fmt/format.h>

#include "fab/nest/check.h"
#include "fab/nest/construct.h"
#include "fab/nest/shape.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Of two heaps, the one whose last sheet is less used by this much is better.
struct Best {
    Heap heap;
    double used = std::numeric_limits<double>::infinity();
    bool turned = false;
};

Eigen::Vector2d usable_extent(const SheetSize& size, const NestOptions& options) {
    const double edge = 2.0 * options.margin_mm + options.kerf_mm;
    const Eigen::Vector2d extent(size.width_mm - edge, size.height_mm - edge);
    if (!(extent.minCoeff() > 0.0)) {
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "sheet-too-small",
            fmt::format("nesting.margin_mm: a sheet of {} x {} mm is no larger than its margins",
                        size.width_mm, size.height_mm));
    }
    return extent;
}

void check_options(const NestOptions& options) {
    const auto refuse = [](const char* path) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "bad-option",
                              fmt::format("{}: must be a number and not below 0", path));
    };
    if (!(options.spacing_mm >= 0.0) || !std::isfinite(options.spacing_mm)) {
        refuse("nesting.spacing_mm");
    }
    if (!(options.margin_mm >= 0.0) || !std::isfinite(options.margin_mm)) {
        refuse("nesting.margin_mm");
    }
    if (!(options.kerf_mm >= 0.0) || !std::isfinite(options.kerf_mm)) {
        refuse("material.kerf_mm");
    }
}

// The search raster resolves the narrow bands among the shapes.
double raster_cell_mm(const std::vector<NestShape>& shapes, const Eigen::Vector2d& extent) {
    std::vector<double> widths;
    for (const NestShape& shape : shapes) {
        widths.push_back(shape.width_mm);
    }
    const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
    std::nth_element(widths.begin(), quarter, widths.end());
    const double finest = extent.maxCoeff() / 2000.0;
    return std::max(finest, std::clamp(*quarter / 8.0, 0.4, 2.0));
}

// Longest first, wide before narrow; `noise` in [0, 1) reorders neighbours.
std::vector<std::size_t> order_of(const std::vector<NestShape>& shapes,
                                  double noise,
                                  std::mt19937& random) {
    std::vector<double> keys;
    for (const NestShape& shape : shapes) {
        const double roll = static_cast<double>(random()) / 4294967296.0;
        const double size = shape.diameter_mm + 2.0 * shape.width_mm;
        keys.push_back(size * (1.0 + noise * (2.0 * roll - 1.0)));
    }
    std::vector<std::size_t> order(shapes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return keys[a] > keys[b]; });
    return order;
}

class Search {
public:
    Search(const std::vector<NestShape>& shapes,
           const Eigen::Vector2d& extent,
           const NestOptions& options,
           const geometry::Context& context)
        : shapes_(shapes),
          extent_(extent),
          options_(options),
          context_(context),
          cell_mm_(raster_cell_mm(shapes, extent)),
          random_(options.seed) {}

    Best run() {
        constexpr std::array<double, 3> kTopWeights{0.0, 0.5, 0.25};
        constexpr std::size_t kMostRounds = 64;
        // One shape has nothing to be ordered against: each way of gravity is tried once.
        const std::size_t rounds = shapes_.size() == 1 ? 2 : kMostRounds;
        std::int64_t spent = 0;
        for (std::size_t round = 0; round < rounds; ++round) {
            if (round > 0 && spent >= options_.max_evaluations) {
                break;
            }
            const double noise = round < 2 ? 0.0 : 0.04 * static_cast<double>(1 + round % 4);
            const std::vector<std::size_t> order = order_of(shapes_, noise, random_);
            const double weight = kTopWeights[(round / 2) % kTopWeights.size()];
            try {
                spent += std::max<std::int64_t>(1, attempt(order, round % 2 == 1, weight));
            } catch (const geometry::Cancelled&) {
                if (best_.heap.laid.empty()) {
                    throw;
                }
                break;  // The caller's time is up: the best so far is a whole layout.
            }
        }
        return std::move(best_);
    }

private:
    std::int64_t attempt(const std::vector<std::size_t>& order, bool turned, double top_weight) {
        HeapOptions heap_options;
        heap_options.extent = turned ? Eigen::Vector2d(extent_.y(), extent_.x()) : extent_;
        heap_options.gap_mm = options_.spacing_mm + options_.kerf_mm;
        heap_options.cell_mm = cell_mm_;
        heap_options.top_weight = top_weight;
        heap_options.allowed_deg = allowed_rotations(options_.rotation);
        for (double& angle : heap_options.allowed_deg) {
            angle -= turned ? 90.0 : 0.0;
        }
        Heap heap = build_heap(shapes_, order, heap_options, context_);
        const std::int64_t evaluations = heap.evaluations;
        const double used = heap.sheets_used(heap_options.extent.y());
        if (used < best_.used) {
            best_ = {std::move(heap), used, turned};
        }
        return evaluations;
    }

    const std::vector<NestShape>& shapes_;
    Eigen::Vector2d extent_;
    const NestOptions& options_;
    const geometry::Context& context_;
    double cell_mm_;
    std::mt19937 random_;
    Best best_;
};

// From the heap's frame, which may be turned by a quarter, to the sheet's.
Pose on_sheet(const Pose& pose, const Best& best, const Eigen::Vector2d& extent, double edge_mm) {
    Pose out = pose;
    if (best.turned) {
        out.angle_deg += 90.0;
        out.offset = {extent.x() - pose.offset.y(), pose.offset.x()};
    }
    out.angle_deg = std::remainder(out.angle_deg, 360.0);
    out.offset.array() += edge_mm;
    return out;
}

}  // namespace

Layout nest(std::span<const Piece* const> pieces,
            const SheetSize& size,
            const NestOptions& options,
            const geometry::Context& context) {
    check_options(options);
    const Eigen::Vector2d extent = usable_extent(size, options);
    const std::vector<double> allowed = allowed_rotations(options.rotation);
    Layout layout;
    std::vector<NestShape> shapes;
    std::vector<const Piece*> fitting;
    for (const Piece* piece : pieces) {
        NestShape shape = make_shape(piece->outline);
        if (fitting_angle(shape, extent, allowed)) {
            shapes.push_back(std::move(shape));
            fitting.push_back(piece);
        } else {
            layout.unplaced.push_back(piece->id);
        }
    }
    if (shapes.empty()) {
        return layout;
    }
    const Best best = Search(shapes, extent, options, context).run();
    double area_mm2 = 0.0;
    for (std::size_t i = 0; i < best.heap.sheets; ++i) {
        Sheet sheet;
        sheet.id = static_cast<int>(i) + 1;
        sheet.size = size;
        layout.sheets.push_back(std::move(sheet));
    }
    const double edge_mm = options.margin_mm + options.kerf_mm / 2.0;
    for (const Laid& laid : best.heap.laid) {
        const Pose pose = on_sheet(laid.pose, best, extent, edge_mm);
        layout.sheets[laid.sheet].placements.push_back(
            {fitting[laid.shape]->id, pose.offset.x(), pose.offset.y(), pose.angle_deg, false});
        area_mm2 += shapes[laid.shape].area_mm2;
    }
    layout.density_percent =
        100.0 * area_mm2 /
        (size.width_mm * size.height_mm * static_cast<double>(layout.sheets.size()));
    layout.smallest_gap_mm = prove_layout(layout, pieces, options);
    return layout;
}

}  // namespace leafcutter::fab
