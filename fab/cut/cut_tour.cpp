// Nearest neighbour, then moves (tour_search.h) in turn with an exact choice of all starts for the
// order found, by dynamic programming along the tour.

#include "fab/cut/cut_tour.h"

#include <algorithm>
#include <limits>

#include "fab/cut/point_grid.h"
#include "fab/cut/tour_search.h"
#include "fab/nest/random.h"

namespace leafcutter::fab {

namespace {

constexpr double kStableMm = 1e-3;

// Nearest neighbour with free starts. A place that has to wait for others sends there first.
class NearestNeighbour {
public:
    explicit NearestNeighbour(const TourProblem& problem)
        : problem_(problem),
          first_point_(problem.places.size()),
          waits_for_(problem.places.size()),
          done_(problem.places.size(), 0) {
        for (const auto& [first, second] : problem.before) {
            waits_for_[second].push_back(first);
        }
    }

    std::vector<TourStop> tour() {
        std::vector<Eigen::Vector2d> points;
        std::vector<std::size_t> owner;
        for (std::size_t place = 0; place < problem_.places.size(); ++place) {
            first_point_[place] = points.size();
            for (const TourStart& start : problem_.places[place].starts) {
                points.push_back(start.entry);
                owner.push_back(place);
            }
        }
        PointGrid grid(points);
        std::vector<TourStop> tour;
        Eigen::Vector2d here = problem_.from;
        while (tour.size() < problem_.places.size()) {
            const TourStop next = first_free(owner[grid.nearest(here)], here);
            tour.push_back(next);
            done_[next.stop] = 1;
            here = problem_.places[next.stop].starts[next.start].exit;
            for (std::size_t i = 0; i < problem_.places[next.stop].starts.size(); ++i) {
                grid.remove(first_point_[next.stop] + i);
            }
        }
        return tour;
    }

private:
    TourStop nearest_start(std::size_t place, const Eigen::Vector2d& here) const {
        const std::vector<TourStart>& starts = problem_.places[place].starts;
        const auto nearest = std::min_element(
            starts.begin(), starts.end(), [&](const TourStart& a, const TourStart& b) {
                return (a.entry - here).squaredNorm() < (b.entry - here).squaredNorm();
            });
        return {place, static_cast<std::size_t>(nearest - starts.begin())};
    }

    TourStop first_free(std::size_t place, const Eigen::Vector2d& here) const {
        for (;;) {
            double least = std::numeric_limits<double>::infinity();
            std::size_t next = place;
            for (const std::size_t other : waits_for_[place]) {
                const TourStop stop = nearest_start(other, here);
                const double distance =
                    (problem_.places[other].starts[stop.start].entry - here).norm();
                if (done_[other] == 0 && distance < least) {
                    least = distance;
                    next = other;
                }
            }
            if (next == place) {
                return nearest_start(place, here);
            }
            place = next;
        }
    }

    const TourProblem& problem_;
    std::vector<std::size_t> first_point_;
    std::vector<std::vector<std::size_t>> waits_for_;
    std::vector<char> done_;
};

// Best starts for the order as it is: shortest path through layers of starts.
void choose_starts(const TourProblem& problem, std::vector<TourStop>& tour) {
    std::vector<std::vector<std::size_t>> came_from(tour.size());
    std::vector<double> cost{0.0};
    const std::vector<TourStart> home{{problem.from, problem.from, 0}};
    const std::vector<TourStart>* before = &home;
    for (std::size_t i = 0; i < tour.size(); ++i) {
        const std::vector<TourStart>& here = problem.places[tour[i].stop].starts;
        std::vector<double> next(here.size(), std::numeric_limits<double>::infinity());
        came_from[i].resize(here.size());
        for (std::size_t b = 0; b < here.size(); ++b) {
            for (std::size_t a = 0; a < before->size(); ++a) {
                const double way = cost[a] + (here[b].entry - (*before)[a].exit).norm();
                if (way < next[b]) {
                    next[b] = way;
                    came_from[i][b] = a;
                }
            }
        }
        cost = std::move(next);
        before = &here;
    }
    auto best = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (std::size_t i = tour.size(); i-- > 0;) {
        tour[i].start = best;
        best = came_from[i][best];
    }
}

// Places near any start of each place, whatever starts are chosen now.
std::vector<std::vector<std::size_t>> neighbours_of(const TourProblem& problem) {
    std::vector<Eigen::Vector2d> points;
    std::vector<std::size_t> owner;
    for (std::size_t place = 0; place < problem.places.size(); ++place) {
        for (const TourStart& start : problem.places[place].starts) {
            points.push_back(start.entry);
            owner.push_back(place);
        }
    }
    const PointGrid grid(points);
    constexpr std::size_t kNear = 4;
    constexpr std::size_t kMost = 14;
    constexpr std::size_t kAsked = 12;  // Starts of one place whose surroundings are looked at.
    std::vector<std::vector<std::size_t>> neighbours(problem.places.size());
    std::size_t first = 0;
    for (std::size_t place = 0; place < problem.places.size(); ++place) {
        const std::size_t count = problem.places[place].starts.size();
        std::vector<std::pair<double, std::size_t>> near;
        for (std::size_t k = 0; k < std::min(count, kAsked); ++k) {
            const std::size_t point = first + k * count / std::min(count, kAsked);
            for (const std::size_t other : grid.nearest_others(point, owner, kNear)) {
                near.emplace_back((points[other] - points[point]).norm(), owner[other]);
            }
        }
        first += count;
        std::sort(near.begin(), near.end());
        for (const auto& [distance, other] : near) {
            std::vector<std::size_t>& list = neighbours[place];
            if (list.size() < kMost && std::find(list.begin(), list.end(), other) == list.end()) {
                list.push_back(other);
            }
        }
    }
    return neighbours;
}

// Moves and starts in turn, until neither helps.
void settle(const TourProblem& problem, TourSearch& search) {
    constexpr int kRounds = 8;
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds && search.length_mm() < before - kStableMm; ++round) {
        before = search.length_mm();
        search.descend();
        std::vector<TourStop> tour = search.tour();
        choose_starts(problem, tour);
        search.set_starts(tour);
    }
}

}  // namespace

std::vector<TourStop> shortest_tour(const TourProblem& problem, const geometry::Context& context) {
    if (problem.places.empty()) {
        return {};
    }
    std::vector<TourStop> tour = NearestNeighbour(problem).tour();
    context.check();
    choose_starts(problem, tour);
    const std::vector<std::vector<std::size_t>> neighbours = neighbours_of(problem);
    TourSearch search(problem, neighbours, std::move(tour), context);
    settle(problem, search);
    constexpr int kBouts = 4;
    Random random(1);
    for (int bout = 0; bout < kBouts; ++bout) {
        search.kick(problem.evaluations / kBouts, random);
        settle(problem, search);
    }
    return search.tour();
}

}  // namespace leafcutter::fab
