#include "geometry/quads/threads.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "geometry/quads/quad_edges.h"

namespace leafcutter::geometry {

namespace {

constexpr int opposite(int side) {
    return (side + 2) % 4;
}

class ThreadTracer {
public:
    ThreadTracer(const QuadMesh& mesh, Family family)
        : neighbours_(find_neighbours(mesh.quads)),
          forward_side_(family == Family::Weft ? 1 : 2),
          taken_(mesh.quads.size(), false) {}

    bool taken(int quad) const { return taken_[static_cast<std::size_t>(quad)]; }

    Thread trace(int seed, Family family) {
        Thread thread{.family = family, .closed = false, .quads = {seed}, .next = -1};
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
            if (next.quad < 0) {
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

    QuadNeighbours neighbours_;
    int forward_side_;
    std::vector<bool> taken_;
};

// Whether a critical leaf of F lies between two neighbours in a warp thread: they are in different
// cylinders, or at the two ends of one that meets itself. Weft threads run along F and cross none.
bool leaf_between(const QuadMesh& mesh, Family family, int quad, int next) {
    const QuadAddress& one = mesh.addresses[static_cast<std::size_t>(quad)];
    const QuadAddress& other = mesh.addresses[static_cast<std::size_t>(next)];
    if (family == Family::Weft) {
        return false;
    }
    if (one.cylinder != other.cylinder) {
        return true;
    }
    const auto cylinder = static_cast<std::size_t>(one.cylinder);
    return cylinder < mesh.grids.size() && mesh.grids[cylinder].shape == ChartShape::Annulus &&
           std::abs(one.row - other.row) != 1;
}

// The parts of a thread between critical leaves.
std::vector<Thread> parted(const QuadMesh& mesh, Thread thread) {
    const std::size_t count = thread.quads.size();
    std::vector<std::size_t> firsts;  // Places of quads with a leaf before them.
    for (std::size_t i = thread.closed ? 0 : 1; i < count; ++i) {
        const int before = thread.quads[(i + count - 1) % count];
        if (leaf_between(mesh, thread.family, before, thread.quads[i])) {
            firsts.push_back(i);
        }
    }
    if (firsts.empty()) {
        return {std::move(thread)};
    }
    if (thread.closed) {
        const auto turn = static_cast<std::ptrdiff_t>(firsts.front());
        std::rotate(thread.quads.begin(), thread.quads.begin() + turn, thread.quads.end());
        for (std::size_t& first : firsts) {
            first -= static_cast<std::size_t>(turn);
        }
    } else {
        firsts.insert(firsts.begin(), 0);
    }
    std::vector<Thread> parts;
    for (std::size_t i = 0; i < firsts.size(); ++i) {
        const bool last = i + 1 == firsts.size();
        const auto from = thread.quads.begin() + static_cast<std::ptrdiff_t>(firsts[i]);
        const auto to = last ? thread.quads.end()
                             : thread.quads.begin() + static_cast<std::ptrdiff_t>(firsts[i + 1]);
        Thread part{.family = thread.family, .closed = false, .quads = {from, to}, .next = -1};
        if (!last || thread.closed) {
            part.next = last ? thread.quads.front() : *to;
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace

std::vector<Thread> trace_threads(const QuadMesh& mesh, Family family, ThreadEnds ends) {
    ThreadTracer tracer(mesh, family);
    std::vector<Thread> threads;
    for (int quad = 0; quad < static_cast<int>(mesh.quads.size()); ++quad) {
        if (!tracer.taken(quad)) {
            threads.push_back(tracer.trace(quad, family));
        }
    }
    if (ends == ThreadEnds::Through) {
        return threads;
    }
    std::vector<Thread> parts;
    for (Thread& thread : threads) {
        for (Thread& part : parted(mesh, std::move(thread))) {
            parts.push_back(std::move(part));
        }
    }
    const auto smallest = [](const Thread& thread) {
        return *std::min_element(thread.quads.begin(), thread.quads.end());
    };
    std::sort(parts.begin(), parts.end(), [&](const Thread& one, const Thread& other) {
        return smallest(one) < smallest(other);
    });
    return parts;
}

}  // namespace leafcutter::geometry
