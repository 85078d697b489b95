// A part as the search by overlap sees it: an outline already grown by half the wanted gap, with
// inscribed circles that measure how deep two parts overlap. Any unit of length.
//
// Inscribed circles and their use as a measure of overlap follow Gardeyn, Vanden Berghe and
// Wauters, "An open-source heuristic to reboot 2D nesting research", arXiv 2509.13329.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/rotations.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

struct Circle {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double radius = 0.0;
};

// A point of a band's middle line.
struct BandPoint {
    Circle circle;
    Eigen::Vector2d along = Eigen::Vector2d::Zero();  // Unit vector; zero for what is no band.
    double from_start = 0.0;                          // Along the middle line.
};

struct NestPart {
    Ring outline;                                      // Grown; about `origin`.
    Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // Of the outline given, in its own frame.
    std::vector<Circle> circles;    // Inscribed; the largest first, or along a band.
    std::vector<BandPoint> middle;  // Of a long thin band, from end to end; else empty.
    Eigen::Vector2d bend_centre =
        Eigen::Vector2d::Zero();  // Of a band: of the arc it is most like.
    Rotations allowed_deg;
    double area = 0.0;
    double hull_area = 0.0;
    double diameter = 0.0;  // Largest distance between two vertices.
    double width = 0.0;     // Mean width of a band of this area and perimeter.
    int min_quality = 0;    // May not touch a zone of lower quality.

    // Turned as it moves: any rotation, or within intervals. Else the rotations are a list.
    bool turns_freely() const { return !allowed_deg.is_list(); }
    bool is_band() const { return !middle.empty(); }
    // Of a band; its points lie half a step from the ends.
    double middle_length() const { return middle.back().from_start + middle.front().from_start; }
};

// `outline` is simple, with at least three vertices, in either orientation. `grow` is what is added
// all around, never less.
NestPart make_part(const Ring& outline, double grow, Rotations allowed_deg);

// Up to `most` circles inside the ring, disjoint, about the largest that fit one after the other.
std::vector<Circle> inscribed_circles(const Ring& ring, std::size_t most);

// `count` circles along the middle of a long thin band, from end to end, evenly spaced.
std::vector<BandPoint> middle_line(const Ring& ring, std::size_t count);

// A part turned by some angle, as arrays for fast tests; about its origin. Edges come in blocks of
// kLanes with a bounding box to each block; all arrays are padded to a multiple of kLanes with
// what touches nothing.
struct TurnedPart {
    static constexpr std::size_t kLanes = 8;

    std::vector<float> x0, y0, x1, y1;                          // Edges.
    std::vector<float> block_x0, block_y0, block_x1, block_y1;  // Boxes of blocks of edges.
    std::vector<float> circle_x, circle_y, circle_r;
    std::vector<float> along_x, along_y, to_end;                // Of a band's circles; else zero.
    std::vector<float> group_x0, group_y0, group_x1, group_y1;  // Boxes of kLanes circles each.
    std::size_t edges = 0;
    std::size_t blocks = 0;
    std::size_t circles = 0;
    bool band = false;
    float width = 0.0F;
    float low_x = 0.0F, low_y = 0.0F, high_x = 0.0F, high_y = 0.0F;
    float diameter = 0.0F;
    float hull_area = 0.0F;
    float hull_root = 0.0F;  // Fourth root of the hull's area.
};

// Fills `out`, whose memory is used again.
void turn_part(const NestPart& part, double angle_deg, TurnedPart& out);
void shift_part(TurnedPart& part, float dx, float dy);

}  // namespace leafcutter::fab
