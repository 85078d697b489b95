// Heaps give a first layout; overlap minimisation empties the last sheet from one side, then the
// next. Every layout that counts is proven.

#include "fab/nest/nest.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "fab/nest/check.h"
#include "fab/nest/compaction.h"
#include "fab/nest/heap_start.h"
#include "fab/nest/shape.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Kept above the wanted gap: numbers are rounded on their way into files.
constexpr double kGapGuardMm = 2e-4;

constexpr double kHeapShare = 0.15;  // Of the work, for the first layout.

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

// The sheet as the search sees it: turned so that it empties from the right.
struct Frame {
    int quarters = 0;  // From the search's frame to the sheet's, counter-clockwise.
    Eigen::Vector2d extent = Eigen::Vector2d::Zero();  // In the search's frame.
    BoardPlan plan;
};

class Nesting {
public:
    Nesting(std::span<const Piece* const> pieces,
            const SheetSize& size,
            const NestOptions& options,
            const geometry::Context& context)
        : all_(pieces), size_(size), options_(options), context_(context) {
        check_options(options);
        extent_ = usable_extent(size, options);
        grow_ = (options.spacing_mm + options.kerf_mm) / 2.0 + kGapGuardMm;
        for (const Piece* piece : pieces) {
            if (const std::string fault = ring_fault(piece->outline); !fault.empty()) {
                throw geometry::Error(geometry::ErrorKind::BadOption, "bad-piece",
                                      fmt::format("piece {}: {}", piece->id, fault));
            }
            // By as much as rounding may cost, a piece that only just fits doesn't.
            const Eigen::Vector2d room = extent_.array() - 4.0 * kGapGuardMm;
            if (fitting_angle(make_shape(piece->outline), room,
                              allowed_rotations(options, *piece))) {
                fitting_.push_back(piece);
            } else {
                unplaced_.push_back(piece->id);
            }
        }
    }

    Layout run() {
        if (fitting_.empty()) {
            Layout layout;
            layout.unplaced = unplaced_;
            return layout;
        }
        auto [frame, start] = first_layout();
        Layout best = proven(layout_of(frame, start.packing));
        CompactionOptions search;
        search.seed = options_.seed;
        // A few pieces are soon laid as well as can be.
        constexpr std::int64_t kPerPiece = 100'000;
        const auto count = static_cast<std::int64_t>(fitting_.size());
        search.max_evaluations = std::min(options_.max_evaluations, kPerPiece * count * count);
        search.time_s = options_.time_s;
        compact(frame.plan, start.packing, search, context_, [&](const Packing& better) {
            try {
                best = proven(layout_of(frame, better));
                return true;
            } catch (const geometry::Error&) {
                return false;
            }
        });
        return best;
    }

private:
    Frame make_frame(int quarters, std::size_t sheets) const {
        Frame frame;
        frame.quarters = quarters;
        frame.extent = quarters % 2 == 0 ? extent_ : Eigen::Vector2d(extent_.y(), extent_.x());
        for (std::size_t i = 0; i < fitting_.size(); ++i) {
            const Rotations allowed =
                allowed_rotations(options_, *fitting_[i]).shifted(-90.0 * quarters);
            frame.plan.parts.push_back(make_part(fitting_[i]->outline, grow_, allowed));
            std::vector<TurnedPart> turned(allowed.is_list() ? allowed.size() : 0);
            for (std::size_t k = 0; k < turned.size(); ++k) {
                turn_part(frame.plan.parts.back(), allowed[k], turned[k]);
            }
            frame.plan.turned.push_back(std::move(turned));
            frame.plan.part_of.push_back(i);
        }
        // Outlines are grown, so their sheets are, too.
        frame.plan.rooms.assign(sheets,
                                {frame.extent.x() + 2.0 * grow_, frame.extent.y() + 2.0 * grow_});
        return frame;
    }

    // The better one of heaps towards either edge.
    std::pair<Frame, HeapStart> first_layout() const {
        const auto rows = static_cast<std::int64_t>(
            kHeapShare * static_cast<double>(options_.max_evaluations) / 2.0);
        std::optional<std::pair<Frame, HeapStart>> best;
        for (const int quarters : {0, 1}) {
            Frame frame = make_frame(quarters, 1);
            HeapStart start = heap_start(frame.plan, rows, options_.seed, context_);
            frame.plan.rooms.assign(static_cast<std::size_t>(start.packing.extent.bins),
                                    frame.plan.rooms.front());
            const double area = area_taken(frame.plan, start.packing.extent);
            if (!best || area < area_taken(best->first.plan, best->second.packing.extent)) {
                best.emplace(std::move(frame), std::move(start));
            }
        }
        return std::move(*best);
    }

    Placement placement_of(const Frame& frame, std::size_t item, const Position& at) const {
        const double edge_mm = options_.margin_mm + options_.kerf_mm / 2.0;
        Eigen::Vector2d p(at.x - grow_, at.y - grow_);
        for (int turn = 0; turn < frame.quarters; ++turn) {
            p = {frame.extent.y() - p.y(), p.x()};
        }
        const double angle = std::remainder(at.angle_deg + 90.0 * frame.quarters, 360.0);
        const Ring origin = moved({frame.plan.parts[item].origin}, {angle, {0.0, 0.0}});
        p += Eigen::Vector2d(edge_mm, edge_mm) - origin.front();
        return {fitting_[item]->id, p.x(), p.y(), angle, false};
    }

    Layout layout_of(const Frame& frame, const Packing& packing) const {
        Layout layout;
        layout.unplaced = unplaced_;
        for (int bin = 0; bin < packing.extent.bins; ++bin) {
            Sheet sheet;
            sheet.size = size_;
            layout.sheets.push_back(std::move(sheet));
        }
        double area_mm2 = 0.0;
        for (std::size_t item = 0; item < packing.positions.size(); ++item) {
            const Position& at = packing.positions[item];
            layout.sheets[static_cast<std::size_t>(at.bin)].placements.push_back(
                placement_of(frame, item, at));
            area_mm2 += std::abs(signed_area(fitting_[item]->outline));
        }
        // A search may empty any sheet.
        std::erase_if(layout.sheets, [](const Sheet& sheet) { return sheet.placements.empty(); });
        for (std::size_t i = 0; i < layout.sheets.size(); ++i) {
            layout.sheets[i].id = static_cast<int>(i) + 1;
        }
        layout.density_percent =
            100.0 * area_mm2 /
            (size_.width_mm * size_.height_mm * static_cast<double>(layout.sheets.size()));
        return layout;
    }

    Layout proven(Layout layout) const {
        layout.smallest_gap_mm = prove_layout(layout, all_, options_);
        return layout;
    }

    std::span<const Piece* const> all_;
    const SheetSize& size_;
    const NestOptions& options_;
    const geometry::Context& context_;
    Eigen::Vector2d extent_;
    double grow_ = 0.0;
    std::vector<const Piece*> fitting_;
    std::vector<std::string> unplaced_;
};

}  // namespace

Layout nest(std::span<const Piece* const> pieces,
            const SheetSize& size,
            const NestOptions& options,
            const geometry::Context& context) {
    return Nesting(pieces, size, options, context).run();
}

}  // namespace leafcutter::fab
