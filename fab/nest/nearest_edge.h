// Where a point is nearest to a part's outline.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/part.h"

namespace leafcutter::fab {

struct Foot {
    double distance = 0.0;                             // Below 0 inside.
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();  // Outwards, of length 1.
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
};

// The point of the outline that is nearest to `from`, both about the part's origin; nothing if it
// is `reach` away or more. Same bits on every machine.
std::optional<Foot> foot_of(const TurnedPart& part, const Eigen::Vector2d& from, double reach);

// A vertex of one part, the one its edge begins at, and a block of edges of another.
struct VertexBlock {
    std::uint32_t vertex = 0;
    std::uint32_t block = 0;
};

// Vertices of `from`, moved by `shift`, against the outline of `part`; nearer than `reach` counts.
struct Approach {
    const TurnedPart& from;
    const TurnedPart& part;
    Eigen::Vector2d shift;
    double reach = 0.0;
};

// Which vertices are near an edge of which blocks, in order.
void near_blocks(const Approach& approach, std::vector<VertexBlock>& out);

struct VertexFoot {
    std::size_t vertex = 0;
    Foot foot;
};

// What foot_of() finds for each vertex, if no other blocks but those of `among` are near.
void feet_among(const Approach& approach,
                const std::vector<VertexBlock>& among,
                std::vector<VertexFoot>& out);

}  // namespace leafcutter::fab
