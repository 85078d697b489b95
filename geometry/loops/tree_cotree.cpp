#include "geometry/loops/tree_cotree.h"

#include <cassert>
#include <cstddef>

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

std::vector<std::vector<int>> outgoing_half_edges(const HalfEdges& edges, int vertex_count) {
    std::vector<std::vector<int>> outgoing(at(vertex_count));
    for (int h = 0; h < edges.size(); ++h) {
        outgoing[at(edges.from_of(h))].push_back(h);
    }
    return outgoing;
}

// A breadth-first tree over the vertices. Marks both half-edges of its edges in `in_tree`; returns
// each vertex's parent, -1 for the root.
std::vector<int> vertex_tree(const HalfEdges& edges, int vertex_count, std::vector<char>& in_tree) {
    const auto outgoing = outgoing_half_edges(edges, vertex_count);
    in_tree.assign(edges.from.size(), 0);
    std::vector<int> parent(at(vertex_count), -1);
    std::vector<char> reached(at(vertex_count), 0);
    std::vector<int> queue{edges.from_of(0)};
    reached[at(queue.front())] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        for (const int h : outgoing[at(queue[i])]) {
            const int to = edges.to_of(h);
            if (reached[at(to)] != 0) {
                continue;
            }
            reached[at(to)] = 1;
            parent[at(to)] = queue[i];
            in_tree[at(h)] = 1;
            in_tree[at(edges.twin_of(h))] = 1;
            queue.push_back(to);
        }
    }
    return parent;
}

// From `a` up the tree to where `b` is below too, and down to `b`.
std::vector<int> tree_path(const std::vector<int>& parent, int a, int b) {
    const auto to_root = [&](int v) {
        std::vector<int> path;
        for (; v >= 0; v = parent[at(v)]) {
            path.push_back(v);
        }
        return path;
    };
    std::vector<int> up = to_root(a);
    std::vector<int> down = to_root(b);
    while (up.size() > 1 && down.size() > 1 && up[up.size() - 2] == down[down.size() - 2]) {
        up.pop_back();
        down.pop_back();
    }
    down.pop_back();
    up.insert(up.end(), down.rbegin(), down.rend());
    return up;
}

// Per triangle the half-edge it leaves for its parent by, in a breadth-first tree over the
// triangles that crosses no edge of `blocked`; -1 at the root. Marks the edges it crosses in
// `blocked`.
std::vector<int> triangle_tree(const HalfEdges& edges, std::vector<char>& blocked) {
    std::vector<int> exit_of(at(edges.size() / 3), -1);
    std::vector<char> reached(exit_of.size(), 0);
    std::vector<int> queue{0};
    reached[0] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        for (int h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
            const int twin = edges.twin_of(h);
            if (blocked[at(h)] != 0 || reached[at(twin / 3)] != 0) {
                continue;
            }
            reached[at(twin / 3)] = 1;
            exit_of[at(twin / 3)] = twin;
            blocked[at(h)] = 1;
            blocked[at(twin)] = 1;
            queue.push_back(twin / 3);
        }
    }
    return exit_of;
}

void cross(const HalfEdges& edges, Cochain& cochain, int leaving, int times) {
    cochain[at(leaving)] += times;
    if (edges.twin_of(leaving) >= 0) {
        cochain[at(edges.twin_of(leaving))] -= times;
    }
}

}  // namespace

DualBasis dual_basis(const HalfEdges& edges, int vertex_count) {
    std::vector<char> used;
    const std::vector<int> parent = vertex_tree(edges, vertex_count, used);
    const std::vector<int> exit_of = triangle_tree(edges, used);
    DualBasis basis;
    for (int h = 0; h < edges.size(); ++h) {
        if (used[at(h)] != 0 || !edges.is_first(h)) {
            continue;
        }
        // The loop of triangles: down from the root to the right side of h, across it, up again.
        Cochain cochain(edges.from.size(), 0);
        const int twin = edges.twin_of(h);
        cross(edges, cochain, twin, 1);
        for (int exit = exit_of[at(h / 3)]; exit >= 0;
             exit = exit_of[at(edges.twin_of(exit) / 3)]) {
            cross(edges, cochain, exit, 1);
        }
        for (int exit = exit_of[at(twin / 3)]; exit >= 0;
             exit = exit_of[at(edges.twin_of(exit) / 3)]) {
            cross(edges, cochain, exit, -1);
        }
        basis.cochains.push_back(std::move(cochain));
        basis.cycles.push_back(tree_path(parent, edges.to_of(twin), edges.from_of(twin)));
    }
    return basis;
}

std::vector<Cochain> cohomology_basis(const HalfEdges& edges, int vertex_count) {
    return dual_basis(edges, vertex_count).cochains;
}

Cochain arc_cochain(const HalfEdges& edges,
                    const std::vector<int>& loop_of_vertex,
                    int from,
                    int to) {
    const auto loop_at = [&](int h) {
        return edges.twin_of(h) < 0 ? loop_of_vertex[at(edges.from_of(h))] : -1;
    };
    Cochain cochain(edges.from.size(), 0);
    std::vector<int> entry_of(at(edges.size() / 3), -1);  // Half-edge the arc came in by.
    std::vector<int> queue;
    for (int h = 0; h < edges.size(); ++h) {
        if (loop_at(h) == from && entry_of[at(h / 3)] < 0) {
            entry_of[at(h / 3)] = h;
            queue.push_back(h / 3);
        }
    }
    for (std::size_t i = 0; i < queue.size(); ++i) {
        for (int h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
            if (loop_at(h) == to) {
                cross(edges, cochain, h, 1);
                int entry = entry_of[at(h / 3)];
                for (; edges.twin_of(entry) >= 0; entry = entry_of[at(edges.twin_of(entry) / 3)]) {
                    cross(edges, cochain, edges.twin_of(entry), 1);
                }
                cross(edges, cochain, entry, -1);
                return cochain;
            }
            const int twin = edges.twin_of(h);
            if (twin >= 0 && entry_of[at(twin / 3)] < 0) {
                entry_of[at(twin / 3)] = twin;
                queue.push_back(twin / 3);
            }
        }
    }
    assert(false && "the two loops bound one connected surface");
    return cochain;
}

}  // namespace leafcutter::geometry
