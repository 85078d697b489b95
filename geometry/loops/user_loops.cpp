#include "geometry/loops/user_loops.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

// How many steps of a search pass between two looks at the stop request.
constexpr int kStepsBetweenChecks = 4096;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class LoopCloser {
public:
    LoopCloser(const VertexRings& rings,
               std::span<const Eigen::Vector3d> positions,
               std::span<const std::vector<int>> given,
               const Context& context)
        : rings_(rings),
          positions_(positions),
          given_(given),
          context_(context),
          loop_of_(positions.size(), -1),
          length_(positions.size(), std::numeric_limits<double>::infinity()),
          before_(positions.size(), -1) {
        for (std::size_t k = 0; k < given.size(); ++k) {
            claim(static_cast<int>(k));
        }
    }

    std::vector<std::vector<int>> close() {
        std::vector<std::vector<int>> loops;
        for (std::size_t k = 0; k < given_.size(); ++k) {
            std::vector<int> loop;
            for (std::size_t i = 0; i < given_[k].size(); ++i) {
                const int to = given_[k][(i + 1) % given_[k].size()];
                const std::vector<int> way = shortest_way(given_[k][i], to);
                if (way.empty()) {
                    fail("loop-blocked", k,
                         fmt::format("no way from vertex {} to {} keeps clear of the boundary and "
                                     "of loops before it; give more vertices or another order",
                                     given_[k][i], to));
                }
                for (const int v : way) {
                    loop_of_[at(v)] = static_cast<int>(k);
                }
                loop.insert(loop.end(), way.begin(), way.end());
            }
            loops.push_back(std::move(loop));
        }
        return loops;
    }

private:
    [[noreturn]] static void fail(const char* code, std::size_t loop, const std::string& what) {
        throw Error(ErrorKind::BadOption, code, fmt::format("loops[{}]: {}", loop, what));
    }

    bool is_on_boundary(int v) const {
        return rings_.slots[at(rings_.begin[at(v) + 1] - 1)].link < 0;
    }

    void claim(int loop) {
        const std::vector<int>& vertices = given_[at(loop)];
        if (vertices.size() < 3) {
            fail("loop-vertices", at(loop), "give at least three vertices");
        }
        for (const int v : vertices) {
            if (v < 0 || at(v) >= positions_.size()) {
                fail("loop-vertices", at(loop),
                     fmt::format("vertex {} is not one of the {} of the surface", v,
                                 positions_.size()));
            }
            if (loop_of_[at(v)] == loop) {
                fail("loop-not-simple", at(loop), fmt::format("vertex {} is given twice", v));
            }
            if (loop_of_[at(v)] >= 0) {
                fail("loops-meet", at(loop),
                     fmt::format("vertex {} is in loops[{}] too", v, loop_of_[at(v)]));
            }
            if (is_on_boundary(v)) {
                fail("loop-at-boundary", at(loop),
                     fmt::format("vertex {} is on the boundary; move the loop inwards", v));
            }
            loop_of_[at(v)] = loop;
        }
    }

    // From `from`, included, to `to`, not included; empty if there is no way.
    std::vector<int> shortest_way(int from, int to) {
        using Entry = std::pair<double, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        std::vector<int> touched{from};
        length_[at(from)] = 0.0;
        queue.emplace(0.0, from);
        int steps = 0;
        while (!queue.empty() && queue.top().second != to) {
            const auto [d, v] = queue.top();
            queue.pop();
            if (++steps % kStepsBetweenChecks == 0) {
                context_.check();
            }
            for (int k = d > length_[at(v)] ? rings_.begin[at(v) + 1] : rings_.begin[at(v)];
                 k < rings_.begin[at(v) + 1]; ++k) {
                const int w = rings_.slots[at(k)].neighbour;
                const double through = d + (positions_[at(v)] - positions_[at(w)]).norm();
                const bool is_free = w == to || (loop_of_[at(w)] < 0 && !is_on_boundary(w));
                if (is_free && through < length_[at(w)]) {
                    length_[at(w)] = through;
                    before_[at(w)] = v;
                    touched.push_back(w);
                    queue.emplace(through, w);
                }
            }
        }
        std::vector<int> way;
        for (int v = queue.empty() ? -1 : before_[at(to)]; v >= 0; v = before_[at(v)]) {
            way.push_back(v);
        }
        std::reverse(way.begin(), way.end());
        for (const int v : touched) {
            length_[at(v)] = std::numeric_limits<double>::infinity();
            before_[at(v)] = -1;
        }
        return way;
    }

    const VertexRings& rings_;
    std::span<const Eigen::Vector3d> positions_;
    std::span<const std::vector<int>> given_;
    const Context& context_;
    std::vector<int> loop_of_;  // Per vertex, -1 while free.
    std::vector<double> length_;
    std::vector<int> before_;
};

}  // namespace

std::vector<std::vector<int>> close_loops(const VertexRings& rings,
                                          std::span<const Eigen::Vector3d> positions,
                                          std::span<const std::vector<int>> given,
                                          const Context& context) {
    return LoopCloser(rings, positions, given, context).close();
}

}  // namespace leafcutter::geometry
