#include "fab/cut/sheet_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "fab/cut/planar_faces.h"
#include "fab/nest/collision.h"
#include "fab/nest/shape.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

using Eigen::Vector2d;

constexpr double kJoinMm = 1e-6;  // Ends of burns this close follow each other.

// The longest tab that a contour is read across.
constexpr double kLongestTabMm = 5.0;

// Burns that follow each other without a gap.
struct Chain {
    std::vector<BurntSegment> segments;
    bool closed = false;
    bool leads_in = false;  // The first segment only leads to where it closes.
};

bool same_settings(const BurntSegment& a, const BurntSegment& b) {
    return a.power == b.power && a.feed_mm_per_min == b.feed_mm_per_min;
}

bool meets(const Vector2d& a, const Vector2d& b) {
    return (a - b).norm() <= kJoinMm;
}

bool is_bridged(const BurntSegment& before, const BurntSegment& after) {
    return bridges({before.from, before.to}, {after.from, after.to}, kLongestTabMm);
}

// A chain that closes, over tabs too, from its first burn or its second: then the first leads in.
std::optional<Chain> closed_chain(std::span<const BurntSegment> burnt) {
    for (std::size_t i = 0; i < burnt.size(); ++i) {
        if (i > 0 &&
            (!same_settings(burnt[i - 1], burnt[i]) ||
             (!meets(burnt[i - 1].to, burnt[i].from) && !is_bridged(burnt[i - 1], burnt[i])))) {
            return std::nullopt;
        }
        const bool leads_in = i > 2 && meets(burnt[i].to, burnt[0].to);
        if (leads_in || (i > 1 && meets(burnt[i].to, burnt[0].from))) {
            return Chain{{burnt.begin(), burnt.begin() + static_cast<std::ptrdiff_t>(i) + 1},
                         true,
                         leads_in};
        }
    }
    return std::nullopt;
}

// How many of the burns run once more along the beginning of the chain that has just closed.
std::size_t over_cut(const Chain& closed, std::span<const BurntSegment> burnt) {
    const std::size_t first = closed.leads_in ? 1 : 0;
    std::size_t count = 0;
    while (count < burnt.size() && first + count < closed.segments.size()) {
        const BurntSegment& drawn = closed.segments[first + count];
        const BurntSegment& again = burnt[count];
        if (!meets(again.from, drawn.from) || !same_settings(again, drawn)) {
            return 0;
        }
        ++count;
        if (!meets(again.to, drawn.to)) {
            constexpr double kOnMm = 1.5e-3;  // Rounded.
            const Segment line{drawn.from, drawn.to};
            const bool stops = count == burnt.size() || !meets(again.to, burnt[count].from);
            return stops && squared_distance(again.to, line) < kOnMm * kOnMm ? count : 0;
        }
        if (count < burnt.size() && !meets(again.to, burnt[count].from)) {
            return count;  // Ends at a corner.
        }
    }
    return count == burnt.size() ? count : 0;
}

// A chain ends where it comes back to its start: the next pass over a contour is another one.
// Over-cuts are left out.
std::vector<Chain> chains_of(std::span<const BurntSegment> burnt) {
    std::vector<Chain> chains;
    for (std::size_t i = 0; i < burnt.size();) {
        const std::span<const BurntSegment> rest = burnt.subspan(i);
        const bool joins = i > 0 && !chains.empty() && same_settings(burnt[i - 1], burnt[i]) &&
                           meets(burnt[i - 1].to, burnt[i].from);
        if (same_settings(burnt[i], burnt.back()) && (!joins || chains.back().closed)) {
            if (auto chain = closed_chain(rest)) {
                i += chain->segments.size();
                chains.push_back(std::move(*chain));
                continue;
            }
        }
        if (joins && chains.back().closed) {
            const std::size_t again = over_cut(chains.back(), rest);
            if (again > 0) {
                i += again;
                continue;
            }
        }
        if (!joins || chains.back().closed) {
            chains.emplace_back();
        }
        Chain& chain = chains.back();
        chain.segments.push_back(burnt[i]);
        chain.closed = chain.segments.size() > 2 && meets(chain.segments.front().from, burnt[i].to);
        ++i;
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
    double area_mm2 = 0.0;
    std::vector<Spot> spots;  // Sorted: the same for every pass over a contour.
    int times = 1;
    bool in_net = false;
};

Outline outline_of(const Chain& chain) {
    Outline outline;
    for (std::size_t i = chain.leads_in ? 1 : 0; i < chain.segments.size(); ++i) {
        outline.ring.push_back(chain.segments[i].from);
        outline.spots.push_back(spot_of(chain.segments[i].from));
        const bool last = i + 1 == chain.segments.size();
        if (!last && !meets(chain.segments[i].to, chain.segments[i + 1].from)) {  // A tab.
            outline.ring.push_back(chain.segments[i].to);
            outline.spots.push_back(spot_of(chain.segments[i].to));
        }
    }
    outline.box = bounds(outline.ring);
    outline.area_mm2 = std::abs(signed_area(outline.ring));
    std::sort(outline.spots.begin(), outline.spots.end());
    return outline;
}

bool contains(const Box& box, const Vector2d& point) {
    return (point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all();
}

// Clear of the ring's edge, along which another contour may run.
Vector2d point_within(const Ring& ring) {
    constexpr double kClearMm = 0.02;
    std::size_t longest = 0;
    const auto edge = [&](std::size_t i) -> Vector2d {
        return ring[(i + 1) % ring.size()] - ring[i];
    };
    for (std::size_t i = 1; i < ring.size(); ++i) {
        longest = edge(i).squaredNorm() > edge(longest).squaredNorm() ? i : longest;
    }
    const Vector2d along = edge(longest).stableNormalized();
    const double side = signed_area(ring) > 0.0 ? kClearMm : -kClearMm;
    return ring[longest] + edge(longest) / 2.0 + side * Vector2d(-along.y(), along.x());
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
        const Vector2d within = point_within(closed[i].ring);
        for (std::size_t j = 0; j < closed.size() && !inside; ++j) {
            inside = i != j && closed[j].area_mm2 > closed[i].area_mm2 &&
                     contains(closed[j].box, within) && encloses(closed[j].ring, within);
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

// Paths of a net that follow each other may close like a contour. Opens those that meet open cuts.
void open_the_net(const BurntSegment& cut, std::vector<Chain>& chains) {
    std::map<Spot, std::vector<std::size_t>> chains_at;
    std::vector<std::vector<Spot>> spots(chains.size());
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (!same_settings(chains[i].segments.front(), cut)) {
            continue;
        }
        spots[i] = outline_of(chains[i]).spots;
        spots[i].push_back(spot_of(chains[i].segments.back().to));
        for (const Spot& spot : spots[i]) {
            chains_at[spot].push_back(i);
        }
        if (!chains[i].closed) {
            open.push_back(i);
        }
    }
    for (std::size_t next = 0; next < open.size(); ++next) {
        for (const Spot& spot : spots[open[next]]) {
            for (const std::size_t other : chains_at.at(spot)) {
                if (chains[other].closed) {
                    chains[other].closed = false;
                    open.push_back(other);
                }
            }
        }
    }
}

bool is_in_net(const Chain& chain, const BurntSegment& cut, const std::vector<Outline>& outlines) {
    const BurntSegment& first = chain.segments.front();
    return !chain.closed && same_settings(first, cut) &&
           !outline_round(outlines, (first.from + first.to) / 2.0);
}

// Takes the cuts that lie in no outline, but enclose something together, out of `chains`.
std::vector<Outline> take_net(const BurntSegment& cut,
                              const std::vector<Outline>& outlines,
                              std::vector<Chain>& chains) {
    std::vector<Segment> lines;
    std::vector<std::size_t> chain_of;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (!is_in_net(chains[i], cut, outlines)) {
            continue;
        }
        for (const BurntSegment& segment : chains[i].segments) {
            lines.push_back({segment.from, segment.to});
            chain_of.push_back(i);
        }
    }
    std::vector<Outline> net;
    std::set<std::size_t> taken;
    for (PlanarFace& face : faces_of(lines, kLongestTabMm)) {
        for (const std::size_t line : face.lines) {
            taken.insert(chain_of[line]);
        }
        Outline outline;
        outline.box = bounds(face.ring);
        outline.area_mm2 = signed_area(face.ring);
        outline.ring = std::move(face.ring);
        outline.times = face.times;
        outline.in_net = true;
        net.push_back(std::move(outline));
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        if (taken.count(i) == 0) {
            if (kept != i) {
                chains[kept] = std::move(chains[i]);
            }
            ++kept;
        }
    }
    chains.resize(kept);
    return net;
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
    open_the_net(burnt.back(), chains);
    std::vector<Outline> outlines = take_outlines(chains);
    std::vector<Outline> net = take_net(burnt.back(), outlines, chains);
    std::move(net.begin(), net.end(), std::back_inserter(outlines));
    for (const Outline& outline : outlines) {
        sheet.pieces.push_back({outline.ring, outline.times, outline.in_net, {}});
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
