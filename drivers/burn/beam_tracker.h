// Follows the head along a program's path by what its controller says. Pure.
//
// A position is looked for only where the head can be: behind what is certain already, before the
// end of what was sent, and no further than the feed allows. Of several such places, where the path
// meets itself, the one nearest to where the head was expected counts, and the first of them is
// what is certain.

#pragma once

#include <cstddef>
#include <optional>

#include "drivers/burn/beam_path.h"

namespace leafcutter::drivers {

struct TrackerOptions {
    double tolerance_mm = 0.05;        // Of a reported position from the path.
    std::size_t planner_blocks = 0;    // What the controller may hold unmoved; 0: not known.
    double rapid_mm_per_min = 6000.0;  // A guess until a rapid was seen.
};

// Ways along the path.
struct WayRange {
    double least_mm = 0.0;
    double likely_mm = 0.0;
    double most_mm = 0.0;
};

class BeamTracker {
public:
    // The path must outlive the tracker.
    explicit BeamTracker(const BeamPath& path, const TrackerOptions& options = {});

    // So many lines may have reached the controller, or are known to be planned by it.
    void sent(std::size_t lines);
    void acknowledged(std::size_t lines, double t_s);

    // Returns false for a place that is not on the path, which changes nothing.
    bool position(const Point& at_mm, double t_s);

    // The head stands there: what is certain is this place. Of several, the one nearest to where
    // the head was heard of last counts, or to the end of what was sent, if it went on alone.
    enum class Since { Heard, Alone };
    bool stands(const Point& at_mm, Since since = Since::Heard);

    // Whether the head may be there, that far from the path at most.
    bool near(const Point& at_mm, double distance_mm) const;

    // The head as last heard of.
    WayRange heard() const { return range_; }

    // The head at that time, if it went on as before.
    double reckoned_mm(double t_s) const;

    // No further than that by then, unless its feed was raised.
    double furthest_mm(double t_s) const;

    // The end of all that was sent.
    double sent_mm() const { return sent_mm_; }

private:
    struct Place {
        double first_mm;
        double nearest_mm;
        double last_mm;
    };

    struct Search {
        double most_mm;
        double expected_mm;
        double tolerance_mm;
    };

    std::optional<Place> find(const Point& at_mm, const Search& search) const;
    double within_reach(double seconds) const;
    double speed(const PathPiece& piece) const;
    double walk(double way_mm, double seconds, double pace) const;

    const BeamPath& path_;
    TrackerOptions options_;
    WayRange range_;
    double heard_s_ = 0.0;
    double pace_ = 1.0;  // How fast the head is, measured, against the feed words.
    double sent_mm_ = 0.0;
};

}  // namespace leafcutter::drivers
