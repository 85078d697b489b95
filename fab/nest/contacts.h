// Where the parts on a board touch each other, or nearly so: what all of them move by at once.

#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/board.h"
#include "fab/nest/nearest_edge.h"

namespace leafcutter::fab {

// A vertex of an item and the nearest point of what it must not enter. A move of an item is x, y
// and a turn, in units that move its ends about as far as one of x or y does.
struct Contact {
    std::size_t item = 0;
    std::size_t other = 0;                                 // An item, or one of the two below.
    Eigen::Vector3d item_gain = Eigen::Vector3d::Zero();   // Of distance by the item's move.
    Eigen::Vector3d other_gain = Eigen::Vector3d::Zero();  // Likewise by the other's.
    double want = 0.0;                                     // By how much the distance must grow.
};

class Contacts {
public:
    explicit Contacts(const Board& board);

    std::size_t still() const { return board_.items(); }     // What does not move.
    std::size_t edge() const { return board_.items() + 1; }  // The last sheet's right edge.

    // Radians for each unit of an item's turn.
    double turn(std::size_t item) const { return turn_[item]; }
    double clearance() const { return clearance_; }  // Between parts that do not overlap.

    // All of the board as it is now, in the order of items and what they touch.
    const std::vector<Contact>& find();

    // Must be called when an item has got another outline.
    void forget(std::size_t item) { ++outline_[item]; }

private:
    // Of an item, as it lies.
    struct Lying {
        const TurnedPart* shape = nullptr;
        int bin = 0;
        Eigen::Vector2d at = Eigen::Vector2d::Zero();
        Eigen::Vector2d low = Eigen::Vector2d::Zero();     // Of its box, on the sheet.
        Eigen::Vector2d high = Eigen::Vector2d::Zero();    // Likewise.
        Eigen::Vector2d along = Eigen::Vector2d::UnitX();  // Its own first axis.
        double angle_deg = 0.0;
    };
    // An item as seen from another one's axes.
    struct Relative {
        Eigen::Vector2d at = Eigen::Vector2d::Zero();
        double angle_deg = 0.0;
    };
    // What of an item was near another when the two were last looked at, with the outlines of these
    // numbers.
    struct Neighbours {
        Relative pose;
        std::size_t item_outline = 0;
        std::size_t other_outline = 0;
        std::vector<VertexBlock> near;
    };

    double width(std::size_t item, std::size_t other) const {  // Mean of both.
        return 0.5 * (width_[item] + width_[other]);
    }
    Lying lying(std::size_t item) const;
    bool may_touch(std::size_t item, std::size_t other) const;
    Relative relative(std::size_t item, std::size_t other) const;
    const std::vector<VertexBlock>& near(std::size_t item, std::size_t other);
    void add_walls(std::size_t item);
    void add_fixed(std::size_t item);
    void add_pair(std::size_t item, std::size_t other);

    const Board& board_;
    double clearance_ = 0.0;
    std::vector<double> turn_;            // [item]
    std::vector<double> width_;           // [item]
    std::vector<double> radius_;          // [item] Of the circle about the origin that it lies in.
    std::vector<std::size_t> outline_;    // [item] Number of the outline it has got, from 1.
    std::vector<Neighbours> neighbours_;  // [item][other]
    std::vector<Lying> lying_;            // [item] As of find().
    std::vector<Contact> contacts_;
    std::vector<VertexFoot> feet_;
};

}  // namespace leafcutter::fab
