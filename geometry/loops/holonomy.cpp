#include "geometry/loops/holonomy.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <random>
#include <utility>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

constexpr std::uint64_t kPrime = (std::uint64_t{1} << 31U) - 1;  // Of the form 4 k + 3.
constexpr int kMostDraws = 1000;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

std::uint64_t plus(std::uint64_t a, std::uint64_t b) {
    return (a + b) % kPrime;
}
std::uint64_t minus(std::uint64_t a, std::uint64_t b) {
    return (a + kPrime - b) % kPrime;
}
std::uint64_t times(std::uint64_t a, std::uint64_t b) {
    return a * b % kPrime;
}
std::uint64_t power(std::uint64_t base, std::uint64_t exponent) {
    std::uint64_t result = 1;
    for (; exponent > 0; exponent /= 2) {
        if (exponent % 2 == 1) {
            result = times(result, base);
        }
        base = times(base, base);
    }
    return result;
}
std::uint64_t reciprocal(std::uint64_t a) {
    return power(a, kPrime - 2);
}

// Any 2 x 2 matrix: ModularMatrix without its promise.
using Entries = std::array<std::uint64_t, 4>;

Entries product(const Entries& a, const Entries& b) {
    return {plus(times(a[0], b[0]), times(a[1], b[2])), plus(times(a[0], b[1]), times(a[1], b[3])),
            plus(times(a[2], b[0]), times(a[3], b[2])), plus(times(a[2], b[1]), times(a[3], b[3]))};
}

std::uint64_t determinant(const Entries& a) {
    return minus(times(a[0], a[3]), times(a[1], a[2]));
}

// Draws matrices. The same in every run.
class Draw {
public:
    explicit Draw(unsigned seed) : random_(seed) {}

    std::uint64_t number() { return random_() % kPrime; }

    ModularMatrix matrix() {
        for (int k = 0; k < kMostDraws; ++k) {
            const std::uint64_t a = number();
            const std::uint64_t b = number();
            const std::uint64_t c = number();
            if (a != 0) {
                return {{a, b, c, times(plus(1, times(b, c)), reciprocal(a))}};
            }
        }
        fail();
    }

    // P and m with P m P^-1 m^-1 = `wanted`: m of the same trace as `wanted` m, and then P that
    // takes one to the other.
    std::pair<ModularMatrix, ModularMatrix> commutator(const ModularMatrix& wanted) {
        for (int k = 0; k < kMostDraws; ++k) {
            const std::optional<ModularMatrix> m = with_trace_kept_by(wanted);
            if (!m) {
                continue;
            }
            if (const std::optional<ModularMatrix> p = between(wanted * *m, *m)) {
                return {*p, *m};
            }
        }
        fail();
    }

private:
    [[noreturn]] static void fail() {
        throw Error(ErrorKind::SelfCheck, "no-representation",
                    "loops: no matrices found for this surface");
    }

    // m = (x, y; z, w): its trace and that of c m agree where z and w solve two equations, one
    // linear and the other the determinant's.
    std::optional<ModularMatrix> with_trace_kept_by(const ModularMatrix& by) {
        const Entries& c = by.entries;
        const std::uint64_t x = number();
        const std::uint64_t y = number();
        const std::uint64_t last = minus(c[3], 1);
        if (last == 0) {
            return std::nullopt;
        }
        const std::uint64_t divide = reciprocal(last);
        const std::uint64_t fixed =
            times(minus(0, plus(times(minus(c[0], 1), x), times(c[2], y))), divide);
        const std::uint64_t slope = times(minus(0, c[1]), divide);  // w = fixed + slope z
        const std::uint64_t factor = minus(times(x, slope), y);
        if (factor == 0) {
            return std::nullopt;
        }
        const std::uint64_t z = times(minus(1, times(x, fixed)), reciprocal(factor));
        return ModularMatrix{{x, y, z, plus(fixed, times(slope, z))}};
    }

    // P with P m = d P, for matrices of equal trace: d R - R m^-1 is one for every R.
    std::optional<ModularMatrix> between(const ModularMatrix& d, const ModularMatrix& m) {
        const Entries r = matrix().entries;
        const Entries left = product(d.entries, r);
        const Entries right = product(r, m.inverse().entries);
        Entries p{};
        for (std::size_t i = 0; i < 4; ++i) {
            p[i] = minus(left[i], right[i]);
        }
        const std::uint64_t square = determinant(p);
        const std::uint64_t root = power(square, (kPrime + 1) / 4);
        if (square == 0 || times(root, root) != square) {
            return std::nullopt;
        }
        const std::uint64_t scale = reciprocal(root);
        for (std::uint64_t& entry : p) {
            entry = times(entry, scale);
        }
        return ModularMatrix{p};
    }

    std::mt19937 random_;
};

// The surface cut open along a tree of edges and some more to one polygon.
class CutOpen {
public:
    CutOpen(const HalfEdges& edges, const VertexRings& rings) : edges_(edges), rings_(rings) {
        kind_.assign(rings.edges.size(), Kind::Free);
        span_vertices();
        span_triangles();
    }

    std::vector<ModularMatrix> represent(unsigned seed) const {
        Draw draw(seed);
        std::vector<ModularMatrix> matrices(kind_.size());
        for (std::size_t e = 0; e < kind_.size(); ++e) {
            if (kind_[e] == Kind::Free) {
                matrices[e] = draw.matrix();
            }
        }
        if (parent_.front() < 0) {
            close(matrices, draw);
        }
        // Farthest triangles first: two sides are known, the third follows.
        for (std::size_t i = order_.size(); i-- > 0;) {
            const int h = parent_[at(order_[i])];
            if (h >= 0) {
                set(matrices, h,
                    (along(matrices, HalfEdges::next(h)) * along(matrices, HalfEdges::previous(h)))
                        .inverse());
            }
        }
        return matrices;
    }

private:
    enum class Kind : char { Free, Tree, Dual };

    int edge_of(int h) const { return rings_.edge_of_half_edge[at(h)]; }
    bool is_forward(int h) const { return rings_.edges[at(edge_of(h))].from == edges_.from_of(h); }

    ModularMatrix along(const std::vector<ModularMatrix>& matrices, int h) const {
        const ModularMatrix& matrix = matrices[at(edge_of(h))];
        return is_forward(h) ? matrix : matrix.inverse();
    }
    void set(std::vector<ModularMatrix>& matrices, int h, const ModularMatrix& matrix) const {
        matrices[at(edge_of(h))] = is_forward(h) ? matrix : matrix.inverse();
    }

    void span_vertices() {
        std::vector<char> seen(rings_.begin.size() - 1, 0);
        std::vector<int> queue{0};
        seen[0] = 1;
        for (std::size_t i = 0; i < queue.size(); ++i) {
            const int v = queue[i];
            for (int k = rings_.begin[at(v)]; k < rings_.begin[at(v) + 1]; ++k) {
                const RingSlot& slot = rings_.slots[at(k)];
                if (std::exchange(seen[at(slot.neighbour)], char{1}) == 0) {
                    kind_[at(slot.edge)] = Kind::Tree;
                    queue.push_back(slot.neighbour);
                }
            }
        }
    }

    // From outside through the boundary, if there is one, else from the first triangle.
    void span_triangles() {
        const std::size_t triangles = at(edges_.size() / 3);
        parent_.assign(triangles, -1);
        std::vector<char> seen(triangles, 0);
        const auto enter = [&](int h) {
            if (std::exchange(seen[at(h / 3)], char{1}) == 0) {
                kind_[at(edge_of(h))] = Kind::Dual;
                parent_[at(h / 3)] = h;
                order_.push_back(h / 3);
            }
        };
        for (int h = 0; h < edges_.size(); ++h) {
            if (edges_.twin_of(h) < 0 && kind_[at(edge_of(h))] == Kind::Free) {
                enter(h);
            }
        }
        if (order_.empty()) {
            order_.push_back(0);
            seen[0] = 1;
        }
        std::size_t done = 0;
        while (done < order_.size()) {
            const int t = order_[done++];
            for (int h = 3 * t; h < 3 * t + 3; ++h) {
                const int twin = edges_.twin_of(h);
                if (twin >= 0 && kind_[at(edge_of(h))] == Kind::Free) {
                    enter(twin);
                }
            }
        }
    }

    // The free half-edges round the polygon that all triangles of a closed surface make together.
    std::vector<int> border() const {
        std::vector<int> found;
        std::vector<int> stack{2, 1, 0};
        while (!stack.empty()) {
            const int h = stack.back();
            stack.pop_back();
            const int twin = edges_.twin_of(h);
            if (kind_[at(edge_of(h))] == Kind::Free) {
                found.push_back(h);
            } else if (kind_[at(edge_of(h))] == Kind::Dual) {
                stack.push_back(HalfEdges::previous(twin));
                stack.push_back(HalfEdges::next(twin));
            }
        }
        return found;
    }

    // Chooses two of the free matrices anew so that the product round the polygon is the identity.
    // With a and b such that it reads a X b Y a^-1 Z b^-1 U, Q = Z Y, P = Q^-1 a and m = X b Y, it
    // is so if P m P^-1 m^-1 = (X U Q)^-1.
    void close(std::vector<ModularMatrix>& matrices, Draw& draw) const {
        std::vector<int> word = border();
        const auto find = [&](int h) {
            return static_cast<std::size_t>(std::find(word.begin(), word.end(), h) - word.begin());
        };
        std::size_t back = 0;
        std::size_t b = 0;
        // Another start until some b is linked with the first letter.
        for (std::size_t turn = 0; turn < word.size(); ++turn) {
            back = find(edges_.twin_of(word.front()));
            b = 1;
            while (b < back && find(edges_.twin_of(word[b])) < back) {
                ++b;
            }
            if (b < back) {
                break;
            }
            std::rotate(word.begin(), word.begin() + 1, word.end());
        }
        const std::size_t b_back = find(edges_.twin_of(word[b]));
        const auto between = [&](std::size_t from, std::size_t to) {
            ModularMatrix all;
            for (std::size_t k = from; k < to; ++k) {
                all = all * along(matrices, word[k]);
            }
            return all;
        };
        const ModularMatrix x = between(1, b);
        const ModularMatrix y = between(b + 1, back);
        const ModularMatrix z = between(back + 1, b_back);
        const ModularMatrix u = between(b_back + 1, word.size());
        const ModularMatrix q = z * y;
        const auto [p, m] = draw.commutator((x * u * q).inverse());
        set(matrices, word.front(), q * p);
        set(matrices, word[b], x.inverse() * m * y.inverse());
    }

    const HalfEdges& edges_;
    const VertexRings& rings_;
    std::vector<Kind> kind_;
    std::vector<int> order_;   // Triangles, each after the one it is reached from.
    std::vector<int> parent_;  // Per triangle: the half-edge by which it is reached, or -1.
};

}  // namespace

ModularMatrix ModularMatrix::inverse() const {
    return {{entries[3], minus(0, entries[1]), minus(0, entries[2]), entries[0]}};
}

std::uint64_t ModularMatrix::trace() const {
    return plus(entries[0], entries[3]);
}

ModularMatrix operator*(const ModularMatrix& a, const ModularMatrix& b) {
    return {product(a.entries, b.entries)};
}

Holonomy operator*(const Holonomy& a, const Holonomy& b) {
    return {{a.matrices[0] * b.matrices[0], a.matrices[1] * b.matrices[1]}};
}

LoopTrace trace_of(const Holonomy& holonomy) {
    return {holonomy.matrices[0].trace(), holonomy.matrices[1].trace()};
}

std::vector<Holonomy> random_holonomies(const HalfEdges& edges, const VertexRings& rings) {
    const CutOpen open(edges, rings);
    const std::vector<ModularMatrix> first = open.represent(1);
    const std::vector<ModularMatrix> second = open.represent(2);
    std::vector<Holonomy> holonomies;
    for (std::size_t e = 0; e < first.size(); ++e) {
        holonomies.push_back({{first[e], second[e]}});
    }
    return holonomies;
}

}  // namespace leafcutter::geometry
