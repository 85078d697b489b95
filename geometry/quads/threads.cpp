#include "geometry/quads/threads.h"

#include <algorithm>
#include <cstddef>

#include "geometry/quads/quad_edges.h"

namespace leafcutter::geometry {

namespace {

constexpr int opposite(int side) {
    return (side + 2) % 4;
}

class ThreadTracer {
public:
    ThreadTracer(const QuadMesh& mesh, Family family, ThreadEnds ends)
        : mesh_(mesh),
          neighbours_(find_neighbours(mesh.quads)),
          ends_(ends),
          forward_side_(family == Family::Weft ? 1 : 2),
          taken_(mesh.quads.size(), false) {}

    bool taken(int quad) const { return taken_[static_cast<std::size_t>(quad)]; }

    Thread trace(int seed, Family family) {
        Thread thread{.family = family, .closed = false, .quads = {seed}};
        taken_[static_cast<std::size_t>(seed)] = true;
        thread.closed = walk(seed, forward_side_, thread.quads);
        if (!thread.closed) {
            std::vector<int> before;
            walk(seed, opposite(forward_side_), before);
            thread.quads.insert(thread.quads.begin(), before.rbegin(), before.rend());
        }
        return thread;
    }

private:
    // Leaves `seed` through `side` and goes straight on to the end of the thread. True if that is
    // where it began.
    bool walk(int seed, int side, std::vector<int>& quads) {
        QuadSide here{.quad = seed, .side = side};
        while (true) {
            const QuadSide next = neighbours_.across[static_cast<std::size_t>(here.quad)]
                                                    [static_cast<std::size_t>(here.side)];
            if (next.quad < 0 || ends_between(here.quad, next.quad)) {
                return false;
            }
            if (next.quad == seed) {
                return true;
            }
            taken_[static_cast<std::size_t>(next.quad)] = true;
            quads.push_back(next.quad);
            here = {.quad = next.quad, .side = opposite(next.side)};
        }
    }

    bool ends_between(int quad, int next) const {
        return ends_ == ThreadEnds::AtCriticalLeaves &&
               mesh_.addresses[static_cast<std::size_t>(quad)].cylinder !=
                   mesh_.addresses[static_cast<std::size_t>(next)].cylinder;
    }

    const QuadMesh& mesh_;
    QuadNeighbours neighbours_;
    ThreadEnds ends_;
    int forward_side_;
    std::vector<bool> taken_;
};

}  // namespace

std::vector<Thread> trace_threads(const QuadMesh& mesh, Family family, ThreadEnds ends) {
    ThreadTracer tracer(mesh, family, ends);
    std::vector<Thread> threads;
    for (int quad = 0; quad < static_cast<int>(mesh.quads.size()); ++quad) {
        if (!tracer.taken(quad)) {
            threads.push_back(tracer.trace(quad, family));
        }
    }
    return threads;
}

}  // namespace leafcutter::geometry
