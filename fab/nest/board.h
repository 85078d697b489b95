// Parts on sheets, overlaps allowed: what a search moves about until nothing overlaps.

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fab/nest/part.h"

namespace leafcutter::fab {

// Sheet, rotation and place of a part's origin.
struct Position {
    int bin = 0;
    int turn = 0;  // Index into the part's list of rotations; 0 if it turns freely.
    double angle_deg = 0.0;
    double x = 0.0;
    double y = 0.0;
};

// What never changes during a search; shared by all boards.
struct BoardPlan {
    struct Room {
        double width = 0.0;
        double height = 0.0;
    };
    // Something that stays where it is: outside of an irregular sheet, hole, or zone.
    struct Fixed {
        TurnedPart shape;
        int bin = 0;
        int quality = 0;  // Binds parts that want a higher one; holes bind all.
        bool solid = true;
    };

    std::vector<NestPart> parts;
    std::vector<std::vector<TurnedPart>> turned;  // [part][allowed rotation]; empty if free.
    std::vector<std::size_t> part_of;             // [item]
    std::vector<Room> rooms;                      // Sheets, in the order in which they are used.
    std::vector<Fixed> fixed;

    const NestPart& part(std::size_t item) const { return parts[part_of[item]]; }
    bool binds(const Fixed& fixed_part, const NestPart& moving) const {
        return fixed_part.solid || moving.min_quality > fixed_part.quality;
    }
};

// Whether all parts turn freely and most are long bands: those stack well in heaps and are pressed.
bool is_banded(const BoardPlan& plan);

// Whether there are, on the average, at least eight of each part.
bool has_many_copies(const BoardPlan& plan);

// The first `bins` sheets, the last one only up to `last_width`.
struct Extent {
    int bins = 1;
    double last_width = 0.0;
};

// One overlap. `other` is an item, items + a fixed thing, or items + all fixed things for the
// sheet's edge.
struct PoseClash {
    std::size_t item = 0;
    std::size_t other = 0;
    float loss = 0.0F;
};

class Board {
public:
    explicit Board(const BoardPlan& plan);

    const BoardPlan& plan() const { return plan_; }
    std::size_t items() const { return at_.size(); }
    const Extent& extent() const { return extent_; }
    double width_of(int bin) const;
    double height_of(int bin) const { return plan_.rooms[static_cast<std::size_t>(bin)].height; }

    const std::vector<Position>& positions() const { return at_; }
    const Position& position(std::size_t item) const { return at_[item]; }
    const TurnedPart& shape(std::size_t item) const;

    // Everything at once; forgets weights.
    void restore(const std::vector<Position>& positions, const Extent& extent);
    void move(std::size_t item, const Position& to);

    // After the plan has given an item that turns freely another part.
    void take_outline(std::size_t item);

    // Moves the last sheet's right edge.
    void set_last_width(double width) { extent_.last_width = width; }

    // `part` of the item at a rotation: from the plan or turned into `scratch`.
    const TurnedPart& turned(std::size_t item, const Position& position, TurnedPart& scratch) const;

    // Weighted loss of an item if it lay elsewhere; stops at `bound` and then returns any value not
    // below it.
    float loss_at(std::size_t item,
                  const TurnedPart& shape,
                  const Position& position,
                  float bound) const;
    bool is_free(std::size_t item) const;

    // All overlaps, each pair once, in a fixed order.
    std::vector<PoseClash> clashes() const;
    float weight(std::size_t item, std::size_t other) const;

    // Guided local search: overlaps that stay grow dearer, others are forgotten.
    void reweigh(const std::vector<PoseClash>& clashes);

    std::int64_t evaluations() const { return evaluations_; }

private:
    // Boxes of what lies on a sheet.
    struct Shelf {
        std::vector<float> low_x, low_y, high_x, high_y;
        std::vector<std::size_t> who;
    };

    void put(std::size_t item);
    void take(std::size_t item);
    void put_fixed();
    std::size_t edge_column() const { return items() + plan_.fixed.size(); }
    float& weight_cell(std::size_t item, std::size_t other);
    float pair_at(std::size_t item,
                  const TurnedPart& shape,
                  const Position& position,
                  std::size_t other) const;
    std::span<const std::size_t> near(const Shelf& shelf,
                                      const TurnedPart& shape,
                                      const Position& position) const;

    const BoardPlan& plan_;
    Extent extent_;
    std::vector<Position> at_;
    std::vector<TurnedPart> own_;  // Of items that turn freely.
    std::vector<Shelf> shelves_;
    std::vector<std::size_t> slot_;   // [item or fixed]
    std::vector<float> weights_;      // [item][other]; of a pair of items at the lower one's row.
    std::vector<std::size_t> heavy_;  // Cells of `weights_` above 1.
    mutable std::vector<std::size_t> near_;
    mutable std::int64_t evaluations_ = 0;
};

}  // namespace leafcutter::fab
