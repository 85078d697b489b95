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
        Thread thread{.family = family, .closed = false, .quads = {seed}, .next = -1, .leaves = {}};
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

// Places of quads in a thread that have a critical leaf before them.
std::vector<int> leaves_in(const QuadMesh& mesh, const Thread& thread) {
    const std::size_t count = thread.quads.size();
    std::vector<int> leaves;
    for (std::size_t i = thread.closed ? 0 : 1; i < count; ++i) {
        const int before = thread.quads[(i + count - 1) % count];
        if (leaf_between(mesh, thread.family, before, thread.quads[i])) {
            leaves.push_back(static_cast<int>(i));
        }
    }
    return leaves;
}

// The leaves of `whole` inside the part that begins at `from`.
std::vector<int> leaves_of_part(const Thread& whole, int from, int count) {
    const int total = static_cast<int>(whole.quads.size());
    std::vector<int> leaves;
    for (const int leaf : whole.leaves) {
        const int at = (leaf - from + total) % total;
        if (at > 0 && at < count) {
            leaves.push_back(at);
        }
    }
    std::sort(leaves.begin(), leaves.end());
    return leaves;
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
    for (Thread& thread : threads) {
        thread.leaves = leaves_in(mesh, thread);
    }
    if (ends == ThreadEnds::Through) {
        return threads;
    }
    std::vector<Thread> parts;
    for (Thread& thread : threads) {
        const std::vector<int> leaves = thread.leaves;
        for (Thread& part : parted(std::move(thread), leaves)) {
            parts.push_back(std::move(part));
        }
    }
    sort_by_smallest_quad(parts);
    return parts;
}

std::vector<Thread> parted(Thread thread, const std::vector<int>& firsts) {
    if (firsts.empty()) {
        return {std::move(thread)};
    }
    const int total = static_cast<int>(thread.quads.size());
    std::vector<int> begins = firsts;
    if (!thread.closed) {
        begins.insert(begins.begin(), 0);
    }
    std::vector<Thread> parts;
    for (std::size_t i = 0; i < begins.size(); ++i) {
        const bool last = i + 1 == begins.size();
        const int from = begins[i];
        const int behind = last ? (thread.closed ? begins.front() + total : total) : begins[i + 1];
        Thread part{
            .family = thread.family, .closed = false, .quads = {}, .next = -1, .leaves = {}};
        for (int k = from; k < behind; ++k) {
            part.quads.push_back(thread.quads[static_cast<std::size_t>(k % total)]);
        }
        part.leaves = leaves_of_part(thread, from, behind - from);
        if (!last || thread.closed) {
            part.next = thread.quads[static_cast<std::size_t>(behind % total)];
        } else {
            part.next = thread.next;
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

void sort_by_smallest_quad(std::vector<Thread>& threads) {
    const auto smallest = [](const Thread& thread) {
        return *std::min_element(thread.quads.begin(), thread.quads.end());
    };
    std::sort(threads.begin(), threads.end(), [&](const Thread& one, const Thread& other) {
        return smallest(one) < smallest(other);
    });
}

}  // namespace leafcutter::geometry
