#include "fab/nest/heap_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "fab/nest/construct.h"
#include "fab/nest/random.h"
#include "fab/nest/shape.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// One way to build a heap.
struct Recipe {
    std::vector<std::size_t> order;
    double top_weight = 0.0;
};

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

// The search raster resolves the narrow bands among the shapes.
double raster_cell(const std::vector<NestShape>& shapes, const Eigen::Vector2d& extent) {
    std::vector<double> widths;
    widths.reserve(shapes.size());
    for (const NestShape& shape : shapes) {
        widths.push_back(shape.width_mm);
    }
    const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
    std::nth_element(widths.begin(), quarter, widths.end());
    return std::max(extent.maxCoeff() / 2000.0, *quarter / 8.0);
}

// As the heap sees it: the plan's y axis reversed is its x axis.
Ring outline_of(const TurnedPart& shape, double height) {
    Ring ring;
    for (std::size_t i = 0; i < shape.edges; ++i) {
        ring.emplace_back(height - static_cast<double>(shape.y0[i]),
                          static_cast<double>(shape.x0[i]));
    }
    return ring;
}

class HeapSearch {
public:
    HeapSearch(const BoardPlan& plan, std::uint64_t seed, const geometry::Context& context)
        : context_(context), random_(seed) {
        shapes_.reserve(plan.part_of.size());
        for (const std::size_t part : plan.part_of) {
            shapes_.push_back(make_shape(plan.parts[part].outline));
            shapes_.back().allowed_deg = plan.parts[part].allowed_deg.shifted(90.0);
        }
        // In a heap's frame gravity points down: the sheet turned by a quarter.
        const BoardPlan::Room& room = plan.rooms.front();
        options_.extent = {room.height, room.width};
        options_.cell_mm = raster_cell(shapes_, options_.extent);
        for (const BoardPlan::Fixed& fixed : plan.fixed) {
            options_.taken.push_back(outline_of(fixed.shape, room.height));
        }
    }

    void run(std::int64_t rows, const std::vector<std::size_t>& order) {
        constexpr std::array<double, 3> kTopWeights{0.0, 0.5, 0.25};
        constexpr std::size_t kMostRounds = 200;
        const std::vector<std::size_t> first = order.empty() ? longest_first(shapes_) : order;
        for (std::size_t round = 0; round < kMostRounds && (round == 0 || rows_ < rows); ++round) {
            try {
                attempt(round < kTopWeights.size() ? Recipe{first, kTopWeights[round]} : varied());
            } catch (const geometry::Cancelled&) {
                if (best_.laid.empty() && best_.left_over.empty()) {
                    throw;
                }
                return;  // The best so far is a whole layout.
            }
        }
    }

    Packing packing(const BoardPlan& plan) const {
        Packing out;
        out.positions.resize(shapes_.size());
        for (const std::size_t shape : best_.left_over) {
            out.positions[shape].bin = -1;
        }
        out.extent.bins = static_cast<int>(best_.sheets);
        double right = 0.0;
        for (const Laid& laid : best_.laid) {
            Position& at = out.positions[laid.shape];
            at.bin = static_cast<int>(laid.sheet);
            at.x = laid.pose.offset.y();
            at.y = options_.extent.x() - laid.pose.offset.x();
            turn_to(plan.part(laid.shape), laid.pose.angle_deg - 90.0, at);
            if (at.bin + 1 == out.extent.bins) {
                const Ring ring =
                    moved(shapes_[laid.shape].outline, {at.angle_deg, Eigen::Vector2d::Zero()});
                right = std::max(right, at.x + bounds(ring).high.x());
            }
        }
        out.extent.last_width = std::min(plan.rooms.front().width, right * (1.0 + 1e-6));
        return out;
    }

    std::int64_t rows() const { return rows_; }

private:
    static void turn_to(const NestPart& part, double angle_deg, Position& at) {
        at.angle_deg = std::remainder(angle_deg, 360.0);
        for (std::size_t i = 0; i < part.allowed_deg.size() && !part.turns_freely(); ++i) {
            if (std::abs(std::remainder(part.allowed_deg[i] - angle_deg, 360.0)) < 1e-6) {
                at.turn = static_cast<int>(i);
                at.angle_deg = part.allowed_deg[i];
            }
        }
    }

    // The best one with a few shapes moved to other turns.
    Recipe varied() {
        Recipe recipe = best_recipe_;
        const std::size_t count = recipe.order.size();
        const std::size_t moves = 1 + random_.below(4);
        const std::size_t reach = 1 + count / 4;
        for (std::size_t i = 0; i < moves; ++i) {
            const std::size_t from = random_.below(count);
            const std::size_t step = random_.below(2 * reach + 1);
            const std::size_t to = std::min(count - 1, from + step - std::min(from + step, reach));
            const std::size_t shape = recipe.order[from];
            recipe.order.erase(recipe.order.begin() + static_cast<std::ptrdiff_t>(from));
            recipe.order.insert(recipe.order.begin() + static_cast<std::ptrdiff_t>(to), shape);
        }
        return recipe;
    }

    void attempt(Recipe recipe) {
        options_.top_weight = recipe.top_weight;
        Heap heap = build_heap(shapes_, recipe.order, options_, context_);
        rows_ += std::max<std::int64_t>(1, heap.evaluations);
        // What is left over counts as a sheet each.
        const double used =
            heap.sheets_used(options_.extent.y()) + static_cast<double>(heap.left_over.size());
        // An equal one is taken too: a walk over a plateau may find its way down.
        if (used <= best_used_) {
            best_ = std::move(heap);
            best_used_ = used;
            best_recipe_ = std::move(recipe);
        }
    }

    const geometry::Context& context_;
    Random random_;
    std::vector<NestShape> shapes_;
    HeapOptions options_;
    Heap best_;
    double best_used_ = std::numeric_limits<double>::infinity();
    Recipe best_recipe_;
    std::int64_t rows_ = 0;
};

}  // namespace

HeapStart heap_start(const BoardPlan& plan,
                     std::int64_t rows,
                     std::uint64_t seed,
                     const geometry::Context& context,
                     const std::vector<std::size_t>& order) {
    HeapSearch search(plan, seed, context);
    search.run(rows, order);
    return {search.packing(plan), search.rows()};
}

}  // namespace leafcutter::fab
