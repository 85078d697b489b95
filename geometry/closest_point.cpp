#include "geometry/closest_point.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLeafTriangles = 4;
constexpr std::size_t kBins = 16;

struct Box {
    Vector3d low = Vector3d::Constant(kInfinity);
    Vector3d high = Vector3d::Constant(-kInfinity);

    void extend(const Vector3d& point) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    void extend(const Box& box) {
        low = low.cwiseMin(box.low);
        high = high.cwiseMax(box.high);
    }
    double half_surface() const {
        const Vector3d size = (high - low).cwiseMax(0.0);
        return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
    }
    double squared_distance(const Vector3d& point) const {
        return (low - point).cwiseMax(point - high).cwiseMax(0.0).squaredNorm();
    }
};

struct Corners {
    Vector3d a;
    Vector3d b;
    Vector3d c;
};

Vector3d closest_on_segment(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
    const Vector3d along = to - from;
    const double length2 = along.squaredNorm();
    if (!(length2 > 0.0)) {
        return from;
    }
    return from + std::clamp((point - from).dot(along) / length2, 0.0, 1.0) * along;
}

Vector3d closest_on_outline(const Vector3d& point, const Corners& t) {
    Vector3d best = closest_on_segment(point, t.a, t.b);
    for (const Vector3d& next :
         {closest_on_segment(point, t.b, t.c), closest_on_segment(point, t.c, t.a)}) {
        if ((next - point).squaredNorm() < (best - point).squaredNorm()) {
            best = next;
        }
    }
    return best;
}

// Ericson, Real-Time Collision Detection, 2005, section 5.1.5: by Voronoi regions of the features.
Vector3d closest_on_triangle(const Vector3d& point, const Corners& t) {
    const Vector3d ab = t.b - t.a;
    const Vector3d ac = t.c - t.a;
    const Vector3d ap = point - t.a;
    const double d1 = ab.dot(ap);
    const double d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) {
        return t.a;
    }
    const Vector3d bp = point - t.b;
    const double d3 = ab.dot(bp);
    const double d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) {
        return t.b;
    }
    const Vector3d cp = point - t.c;
    const double d5 = ab.dot(cp);
    const double d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) {
        return t.c;
    }
    const double va = d3 * d6 - d5 * d4;
    const double vb = d5 * d2 - d1 * d6;
    const double vc = d1 * d4 - d3 * d2;
    if (va <= 0.0 || vb <= 0.0 || vc <= 0.0) {
        return closest_on_outline(point, t);
    }
    const double scale = 1.0 / (va + vb + vc);
    return t.a + ab * (vb * scale) + ac * (vc * scale);
}

}  // namespace

struct ClosestPoint::Tree {
    // Inner node: the left child follows at once, `link` is the right one. Leaf: triangles
    // [link, link + count).
    struct Node {
        Box box;
        int link = 0;
        int count = 0;
    };

    std::vector<Node> nodes;
    std::vector<Corners> triangles;  // In the order of the leaves.
    std::vector<int> triangle_ids;   // Index in the mesh.
    std::vector<int> place_of_id;
    double area = 0.0;

    explicit Tree(const TriangleMesh& mesh);
    void split(std::size_t node, std::size_t begin, std::size_t end);
    std::size_t cut_place(std::size_t begin, std::size_t end);
    void test(int place, const Vector3d& point, Hit& best) const;
    Hit descend(const Vector3d& point, Hit best) const;

private:
    struct Item {
        Box box;
        Vector3d centre;
        int id = 0;
    };
    std::vector<Item> items_;  // Only while building.
};

ClosestPoint::Tree::Tree(const TriangleMesh& mesh) {
    items_.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Item item{.box = {}, .centre = Vector3d::Zero(), .id = static_cast<int>(i)};
        for (const int corner : mesh.triangles[i]) {
            item.box.extend(mesh.positions[static_cast<std::size_t>(corner)]);
        }
        item.centre = 0.5 * (item.box.low + item.box.high);
        items_.push_back(item);
    }
    if (!items_.empty()) {
        nodes.reserve(items_.size());
        nodes.emplace_back();
        split(0, 0, items_.size());
    }
    place_of_id.resize(items_.size());
    for (const Item& item : items_) {
        const auto& corners = mesh.triangles[static_cast<std::size_t>(item.id)];
        const Corners t{mesh.positions[static_cast<std::size_t>(corners[0])],
                        mesh.positions[static_cast<std::size_t>(corners[1])],
                        mesh.positions[static_cast<std::size_t>(corners[2])]};
        place_of_id[static_cast<std::size_t>(item.id)] = static_cast<int>(triangles.size());
        triangles.push_back(t);
        triangle_ids.push_back(item.id);
        area += 0.5 * (t.b - t.a).cross(t.c - t.a).norm();
    }
    items_ = {};
}

// NOLINTNEXTLINE(misc-no-recursion): depth is bounded by the halving fallback of cut_place().
void ClosestPoint::Tree::split(std::size_t node, std::size_t begin, std::size_t end) {
    Box box;
    for (std::size_t i = begin; i < end; ++i) {
        box.extend(items_[i].box);
    }
    nodes[node].box = box;
    if (end - begin <= kLeafTriangles) {
        nodes[node].link = static_cast<int>(begin);
        nodes[node].count = static_cast<int>(end - begin);
        return;
    }
    const std::size_t middle = cut_place(begin, end);
    nodes.emplace_back();
    split(node + 1, begin, middle);
    const std::size_t right = nodes.size();
    nodes[node].link = static_cast<int>(right);
    nodes.emplace_back();
    split(right, middle, end);
}

// Orders the items of [begin, end) so that both parts are non-empty and cheap to search: the cut of
// least surface area heuristic over equal bins on the longest axis of the centres.
std::size_t ClosestPoint::Tree::cut_place(std::size_t begin, std::size_t end) {
    Box centres;
    for (std::size_t i = begin; i < end; ++i) {
        centres.extend(items_[i].centre);
    }
    Eigen::Index axis = 0;
    const double span = (centres.high - centres.low).maxCoeff(&axis);
    const double low = centres.low[axis];
    const auto bin_of = [&](const Item& item) {
        const double place = (item.centre[axis] - low) / span * static_cast<double>(kBins);
        return std::min(static_cast<std::size_t>(place), kBins - 1);
    };
    if (!(span > 0.0)) {
        return begin + (end - begin) / 2;
    }
    std::array<Box, kBins> boxes;
    std::array<std::size_t, kBins> counts{};
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t bin = bin_of(items_[i]);
        boxes[bin].extend(items_[i].box);
        ++counts[bin];
    }
    std::array<double, kBins> right_cost{};
    Box right_box;
    std::size_t right_count = 0;
    for (std::size_t bin = kBins; bin-- > 1;) {
        right_box.extend(boxes[bin]);
        right_count += counts[bin];
        right_cost[bin] =
            right_count == 0 ? 0.0 : right_box.half_surface() * static_cast<double>(right_count);
    }
    Box left_box;
    std::size_t left_count = 0;
    std::size_t best_bin = 0;
    double best_cost = kInfinity;
    for (std::size_t bin = 1; bin < kBins; ++bin) {
        left_box.extend(boxes[bin - 1]);
        left_count += counts[bin - 1];
        if (left_count == 0 || left_count == end - begin) {
            continue;
        }
        const double cost =
            left_box.half_surface() * static_cast<double>(left_count) + right_cost[bin];
        if (cost < best_cost) {
            best_cost = cost;
            best_bin = bin;
        }
    }
    const auto from = items_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = items_.begin() + static_cast<std::ptrdiff_t>(end);
    const auto middle =
        std::partition(from, to, [&](const Item& item) { return bin_of(item) < best_bin; });
    if (middle == from || middle == to) {
        return begin + (end - begin) / 2;
    }
    return static_cast<std::size_t>(middle - items_.begin());
}

void ClosestPoint::Tree::test(int place, const Vector3d& point, Hit& best) const {
    const auto at = static_cast<std::size_t>(place);
    const Vector3d found = closest_on_triangle(point, triangles[at]);
    const double squared = (found - point).squaredNorm();
    if (squared < best.distance) {
        best = {.point = found, .distance = squared, .triangle = triangle_ids[at]};
    }
}

// Hit::distance holds the squared distance in here.
ClosestPoint::Hit ClosestPoint::Tree::descend(const Vector3d& point, Hit best) const {
    struct Pending {
        std::size_t node;
        double squared;
    };
    thread_local std::vector<Pending> stack;
    stack.clear();
    stack.push_back({0, nodes.front().box.squared_distance(point)});
    while (!stack.empty()) {
        const Pending next = stack.back();
        stack.pop_back();
        if (next.squared >= best.distance) {
            continue;
        }
        const Node& node = nodes[next.node];
        if (node.count > 0) {
            for (int place = node.link; place < node.link + node.count; ++place) {
                test(place, point, best);
            }
            continue;
        }
        Pending near{next.node + 1, nodes[next.node + 1].box.squared_distance(point)};
        const auto other = static_cast<std::size_t>(node.link);
        Pending far{other, nodes[other].box.squared_distance(point)};
        if (far.squared < near.squared) {
            std::swap(near, far);
        }
        stack.push_back(far);
        stack.push_back(near);
    }
    return best;
}

ClosestPoint::ClosestPoint(const TriangleMesh& mesh) : tree_(std::make_unique<Tree>(mesh)) {}
ClosestPoint::~ClosestPoint() = default;
ClosestPoint::ClosestPoint(ClosestPoint&&) noexcept = default;
ClosestPoint& ClosestPoint::operator=(ClosestPoint&&) noexcept = default;

ClosestPoint::Hit ClosestPoint::query(const Vector3d& point) const {
    return query(point, -1);
}

ClosestPoint::Hit ClosestPoint::query(const Vector3d& point, int near_triangle) const {
    assert(!tree_->nodes.empty());
    Hit best{.point = point, .distance = kInfinity, .triangle = -1};
    if (near_triangle >= 0) {
        tree_->test(tree_->place_of_id[static_cast<std::size_t>(near_triangle)], point, best);
    }
    best = tree_->descend(point, best);
    best.distance = std::sqrt(best.distance);
    return best;
}

double ClosestPoint::total_area() const {
    return tree_->area;
}

double ClosestPoint::diagonal() const {
    assert(!tree_->nodes.empty());
    const Box& box = tree_->nodes.front().box;
    return (box.high - box.low).norm();
}

}  // namespace leafcutter::geometry
