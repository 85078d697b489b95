#include "fab/cut/sheet_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kJoinMm = 1e-6;  // Ends of burns this close follow each other.

// Burns that follow each other without a gap.
struct Chain {
    std::vector<BurntSegment> segments;
    bool closed = false;
};

bool same_settings(const BurntSegment& a, const BurntSegment& b) {
    return a.power == b.power && a.feed_mm_per_min == b.feed_mm_per_min;
}

// A chain ends where it comes back to its start: the next pass over a contour is another one.
std::vector<Chain> chains_of(std::span<const BurntSegment> burnt) {
    std::vector<Chain> chains;
    for (const BurntSegment& segment : burnt) {
        if (chains.empty() || chains.back().closed ||
            !same_settings(chains.back().segments.back(), segment) ||
            (chains.back().segments.back().to - segment.from).norm() > kJoinMm) {
            chains.emplace_back();
        }
        Chain& chain = chains.back();
        chain.segments.push_back(segment);
        chain.closed = chain.segments.size() > 2 &&
                       (chain.segments.front().from - segment.to).norm() <= kJoinMm;
    }
    return chains;
}

// Coordinates in micrometres, the finest that our programs spell.
using Spot = std::array<std::int64_t, 2>;

Spot spot_of(const Vector2d& point) {
    return {std::llround(point.x() * 1e3), std::llround(point.y() * 1e3)};
}

using LineKey = std::pair<Spot, Spot>;

LineKey key_of(const BurntSegment& segment) {
    const Spot from = spot_of(segment.from);
    const Spot to = spot_of(segment.to);
    return {std::min(from, to), std::max(from, to)};
}

struct Outline {
    Ring ring;
    Box box;
    std::vector<Spot> spots;  // Sorted: the same for every pass over a contour.
    int times = 1;
};

Outline outline_of(const Chain& chain) {
    Outline outline;
    for (const BurntSegment& segment : chain.segments) {
        outline.ring.push_back(segment.from);
        outline.spots.push_back(spot_of(segment.from));
    }
    outline.box = bounds(outline.ring);
    std::sort(outline.spots.begin(), outline.spots.end());
    return outline;
}

bool contains(const Box& box, const Vector2d& point) {
    return (point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all();
}

// The smallest outline round `point`, if any.
std::optional<std::size_t> outline_round(const std::vector<Outline>& outlines,
                                         const Vector2d& point) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        const bool smaller =
            !found || outlines[i].box.size().prod() < outlines[*found].box.size().prod();
        if (smaller && contains(outlines[i].box, point) && encloses(outlines[i].ring, point)) {
            found = i;
        }
    }
    return found;
}

// Takes the chains that are outlines out of `chains`.
std::vector<Outline> take_outlines(std::vector<Chain>& chains) {
    std::vector<Outline> closed;
    std::vector<std::size_t> chain_of;
    std::map<std::vector<Spot>, std::size_t> place_of;
    std::set<std::size_t> taken;
    const BurntSegment cut = chains.back().segments.back();
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (!chains[i].closed || !same_settings(chains[i].segments.front(), cut)) {
            continue;
        }
        Outline outline = outline_of(chains[i]);
        const auto [known, is_new] = place_of.emplace(outline.spots, closed.size());
        if (!is_new) {
            ++closed[known->second].times;
            taken.insert(i);
            continue;
        }
        closed.push_back(std::move(outline));
        chain_of.push_back(i);
    }
    std::vector<Outline> outer;
    for (std::size_t i = 0; i < closed.size(); ++i) {
        bool inside = false;
        for (std::size_t j = 0; j < closed.size() && !inside; ++j) {
            inside = i != j && contains(closed[j].box, closed[i].ring.front()) &&
                     encloses(closed[j].ring, closed[i].ring.front()) &&
                     !encloses(closed[i].ring, closed[j].ring.front());
        }
        if (!inside) {
            outer.push_back(std::move(closed[i]));
            taken.insert(chain_of[i]);
        }
    }
    std::vector<Chain> rest;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (taken.count(i) == 0) {
            rest.push_back(std::move(chains[i]));
        }
    }
    chains = std::move(rest);
    return outer;
}

}  // namespace

bool encloses(const Ring& ring, const Vector2d& point) {
    bool inside = false;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        const Vector2d& a = ring[i];
        const Vector2d& b = ring[j];
        if ((a.y() > point.y()) != (b.y() > point.y()) &&
            point.x() < (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()) + a.x()) {
            inside = !inside;
        }
    }
    return inside;
}

BurntSheet read_sheet(std::string_view gcode) {
    BurntSheet sheet;
    const std::vector<BurntSegment> burnt = burnt_segments(gcode);
    if (burnt.empty()) {
        return sheet;
    }
    std::vector<Chain> chains = chains_of(burnt);
    const std::vector<Outline> outlines = take_outlines(chains);
    for (const Outline& outline : outlines) {
        sheet.pieces.push_back({outline.ring, outline.times, {}});
    }
    std::set<LineKey> seen;
    for (const Chain& chain : chains) {
        const BurntSegment& first = chain.segments.front();
        const auto home = outline_round(outlines, (first.from + first.to) / 2.0);
        for (const BurntSegment& segment : chain.segments) {
            if (!home) {
                ++sheet.stray_lines;
            } else if (seen.insert(key_of(segment)).second) {
                sheet.pieces[*home].marks.push_back(segment);
            }
        }
    }
    return sheet;
}

}  // namespace leafcutter::fab
