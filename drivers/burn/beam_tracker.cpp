#include "drivers/burn/beam_tracker.h"

#include <algorithm>
#include <cmath>

namespace leafcutter::drivers {

namespace {

constexpr double kSlackSeconds = 0.15;  // A report may have been on its way for so long.
constexpr double kFastest = 1.3;        // Against the feed words: an override may be set.
constexpr double kFastestOverride = 2.0;
constexpr double kSlowestPace = 0.02;

}  // namespace

BeamTracker::BeamTracker(const BeamPath& path, const TrackerOptions& options)
    : path_(path), options_(options) {}

void BeamTracker::sent(std::size_t lines) {
    sent_mm_ = std::max(sent_mm_, path_.way_after(lines));
}

// All but the planner's fill of the acknowledged lines has been moved.
void BeamTracker::acknowledged(std::size_t lines, double t_s) {
    if (options_.planner_blocks == 0 || path_.pieces().empty()) {
        return;
    }
    const double planned = path_.way_after(lines);
    const std::size_t last = path_.piece_at(planned);
    constexpr std::size_t kMiscounted = 3;  // Answers that a bad link doubled.
    const std::size_t held = options_.planner_blocks + kMiscounted;
    const double certain = last >= held ? path_.begin_mm(last + 1 - held) : 0.0;
    if (certain > range_.least_mm) {
        range_.least_mm = certain;
        range_.most_mm = std::max(range_.most_mm, certain);
        if (certain > range_.likely_mm) {
            range_.likely_mm = certain;
            heard_s_ = t_s;
        }
    }
}

double BeamTracker::speed(const PathPiece& piece) const {
    const double feed = piece.rapid ? options_.rapid_mm_per_min : piece.feed_mm_per_min;
    return std::max(feed, 1.0) / 60.0;
}

// Where one gets from `way_mm` in that time.
double BeamTracker::walk(double way_mm, double seconds, double pace) const {
    const std::vector<PathPiece>& pieces = path_.pieces();
    if (pieces.empty()) {
        return way_mm;
    }
    for (std::size_t i = path_.piece_at(way_mm); i < pieces.size(); ++i) {
        const double left = pieces[i].end_mm - way_mm;
        const double needed = left / (speed(pieces[i]) * pace);
        if (needed > seconds) {
            return way_mm + left * seconds / needed;
        }
        seconds -= needed;
        way_mm = pieces[i].end_mm;
    }
    return way_mm;
}

double BeamTracker::within_reach(double seconds) const {
    return std::min(sent_mm_, walk(range_.most_mm, seconds + kSlackSeconds, kFastest));
}

double BeamTracker::reckoned_mm(double t_s) const {
    const double passed = std::max(0.0, t_s - heard_s_);
    return std::min(sent_mm_, walk(range_.likely_mm, passed, pace_));
}

double BeamTracker::furthest_mm(double t_s) const {
    constexpr double kClock = 1.05;  // Reports don't arrive to the millisecond.
    return std::min(sent_mm_, walk(range_.most_mm, std::max(0.0, t_s - heard_s_), kClock));
}

std::optional<BeamTracker::Place> BeamTracker::find(const Point& at_mm,
                                                    const Search& search) const {
    const std::vector<PathPiece>& pieces = path_.pieces();
    std::optional<Place> place;
    if (pieces.empty()) {
        return place;
    }
    const double least_mm = range_.least_mm;
    for (std::size_t i = path_.piece_at(least_mm); i < pieces.size(); ++i) {
        const double begin = path_.begin_mm(i);
        if (begin > search.most_mm) {
            break;
        }
        const Point& from = path_.from_mm(i);
        const double length = pieces[i].end_mm - begin;
        const double dx = (pieces[i].to_mm[0] - from[0]) / length;
        const double dy = (pieces[i].to_mm[1] - from[1]) / length;
        const double along = (at_mm[0] - from[0]) * dx + (at_mm[1] - from[1]) * dy;
        const double on = std::clamp(along, std::max(0.0, least_mm - begin),
                                     std::max(0.0, std::min(length, search.most_mm - begin)));
        const double off = std::hypot(from[0] + on * dx - at_mm[0], from[1] + on * dy - at_mm[1]);
        if (off > search.tolerance_mm) {
            continue;
        }
        const double way = begin + on;
        place = place.value_or(Place{way, way, way});
        place->last_mm = way;
        if (std::abs(way - search.expected_mm) < std::abs(place->nearest_mm - search.expected_mm)) {
            place->nearest_mm = way;
        }
    }
    return place;
}

bool BeamTracker::position(const Point& at_mm, double t_s) {
    const double passed = std::max(0.0, t_s - heard_s_);
    const double expected = reckoned_mm(t_s);
    std::optional<Place> place =
        find(at_mm, {within_reach(passed), expected, options_.tolerance_mm});
    if (!place) {
        place = find(at_mm, {sent_mm_, expected, options_.tolerance_mm});
    }
    if (!place) {
        return false;
    }
    const double before = range_.likely_mm;
    range_ = {place->first_mm, place->nearest_mm, place->last_mm};
    const double nominal = passed > 0.0 ? walk(before, passed, 1.0) - before : 0.0;
    if (nominal > 0.0) {
        const double measured = (range_.likely_mm - before) / nominal;
        pace_ = std::clamp(measured, kSlowestPace, kFastestOverride);
    }
    heard_s_ = t_s;
    return true;
}

bool BeamTracker::near(const Point& at_mm, double distance_mm) const {
    return find(at_mm, {sent_mm_, range_.likely_mm, distance_mm}).has_value();
}

bool BeamTracker::stands(const Point& at_mm, Since since) {
    const double expected = since == Since::Alone ? sent_mm_ : range_.likely_mm;
    const std::optional<Place> place = find(at_mm, {sent_mm_, expected, options_.tolerance_mm});
    if (!place) {
        return false;
    }
    range_ = {place->nearest_mm, place->nearest_mm, place->nearest_mm};
    if (since ==
        Since::Alone) {  // It may have been stopped on the way, where the path meets itself.
        range_ = {place->first_mm, place->nearest_mm, place->last_mm};
    }
    return true;
}

}  // namespace leafcutter::drivers
