// Several heaps, under gravity towards either edge and in different orders; the best is kept and
// proven.

#include "fab/nest/nest.h"

#include <algorithm>
#include <array>
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

// One way to build a heap.
struct Recipe {
    std::vector<std::size_t> order;
    bool turned = false;  // Gravity towards the left edge instead of the lower one.
    double top_weight = 0.0;
};

struct Best {
    Heap heap;
    double used =
        std::numeric_limits<double>::infinity();  // Sheets, the last one by its used part.
    Recipe recipe;
};

Eigen::Vector2d usable_extent(const SheetSize& size, const NestOptions& options) {
    const double edge = 2.0 * options.margin_mm + options.kerf_mm;
    Eigen::Vector2d extent(size.width_mm - edge, size.height_mm - edge);
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
    widths.reserve(shapes.size());
    for (const NestShape& shape : shapes) {
        widths.push_back(shape.width_mm);
    }
    const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
    std::nth_element(widths.begin(), quarter, widths.end());
    const double finest = extent.maxCoeff() / 2000.0;
    return std::max(finest, std::clamp(*quarter / 8.0, 0.4, 2.0));
}

// Longest first, wide before narrow.
std::vector<std::size_t> longest_first(const std::vector<NestShape>& shapes) {
    const auto size = [&](std::size_t i) {
        return shapes[i].diameter_mm + 2.0 * shapes[i].width_mm;
    };
    std::vector<std::size_t> order(shapes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
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
        constexpr std::size_t kMostRounds = 200;
        // One shape has nothing to be ordered against: each way of gravity is tried once.
        const std::size_t rounds = shapes_.size() == 1 ? 2 : kMostRounds;
        std::int64_t spent = 0;
        for (std::size_t round = 0; round < rounds; ++round) {
            if (round > 0 && spent >= options_.max_evaluations) {
                break;
            }
            try {
                spent += attempt(next_recipe(round));
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
    // First every plain recipe, then the best one with a few shapes moved to other turns.
    Recipe next_recipe(std::size_t round) {
        constexpr std::array<double, 3> kTopWeights{0.0, 0.5, 0.25};
        if (round < 2 * kTopWeights.size()) {
            return {longest_first(shapes_), round % 2 == 1, kTopWeights[round / 2]};
        }
        Recipe recipe = best_.recipe;
        const std::size_t count = recipe.order.size();
        const std::size_t moves = 1 + random_() % 4;
        const std::size_t reach = 1 + count / 4;
        for (std::size_t i = 0; i < moves; ++i) {
            const std::size_t from = random_() % count;
            const std::size_t step = random_() % (2 * reach + 1);
            const std::size_t to = std::min(count - 1, from + step - std::min(from + step, reach));
            const std::size_t shape = recipe.order[from];
            recipe.order.erase(recipe.order.begin() + static_cast<std::ptrdiff_t>(from));
            recipe.order.insert(recipe.order.begin() + static_cast<std::ptrdiff_t>(to), shape);
        }
        return recipe;
    }

    std::int64_t attempt(Recipe recipe) {
        HeapOptions heap_options;
        heap_options.extent = recipe.turned ? Eigen::Vector2d(extent_.y(), extent_.x()) : extent_;
        heap_options.gap_mm = options_.spacing_mm + options_.kerf_mm;
        heap_options.cell_mm = cell_mm_;
        heap_options.top_weight = recipe.top_weight;
        heap_options.allowed_deg = allowed_rotations(options_.rotation);
        for (double& angle : heap_options.allowed_deg) {
            angle -= recipe.turned ? 90.0 : 0.0;
        }
        Heap heap = build_heap(shapes_, recipe.order, heap_options, context_);
        const std::int64_t evaluations = heap.evaluations;
        const double used = heap.sheets_used(heap_options.extent.y());
        // An equal one is taken too: a walk over a plateau may find its way down.
        if (used <= best_.used) {
            best_ = {std::move(heap), used, std::move(recipe)};
        }
        return std::max<std::int64_t>(1, evaluations);
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
    if (best.recipe.turned) {
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
