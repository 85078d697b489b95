#include "fab/strips/joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/plane.h"
#include "geometry/quads/quad_edges.h"

namespace leafcutter::fab {

using geometry::angle_between;

namespace {

using Eigen::Vector2d;

// Joints of neighbours this many cells apart don't look lined up.
constexpr int kApart = 5;

constexpr double kSeen = 1.5;       // All of the tab lies where the strip is on top.
constexpr double kTurnDeg = 20.0;   // Costs 1.
constexpr double kKink = 1.5;       // An irregular vertex at the joint.
constexpr double kKinkNear = 0.75;  // One at the far end of a cell beside it.
constexpr double kLinedUp = 1.0;

Vector2d middle(const Unfolded& flat, std::size_t rung) {
    return (flat.left[rung] + flat.right[rung]) / 2.0;
}

class JointCosts {
public:
    explicit JointCosts(const JointPlace& place)
        : place_(place), n_(static_cast<int>(place.strip.quads.size())) {}

    double at(int cell) const {
        double cost = kSeen * seen(cell) + turning(cell) / kTurnDeg;
        if (place_.joints != nullptr) {
            const JointMap& joints = *place_.joints;
            const WalkedCell& here = place_.cells[static_cast<std::size_t>(cell)];
            cost += kKink * kinks(here.l0, here.r0) + kKinkNear * kinks(here.l1, here.r1);
            const int before = cell > 0 ? cell - 1 : (place_.strip.closed ? n_ - 1 : -1);
            if (before >= 0) {
                const WalkedCell& back = place_.cells[static_cast<std::size_t>(before)];
                cost += kKinkNear * kinks(back.l0, back.r0);
            }
            const Family family = place_.strip.family;
            cost += kLinedUp *
                    std::max(joints.crowding(family, here.l0), joints.crowding(family, here.r0));
        }
        return cost;
    }

private:
    double kinks(int left, int right) const {
        return place_.joints->irregular(left) || place_.joints->irregular(right) ? 1.0 : 0.0;
    }

    double turning(int cell) const {
        const auto rung = static_cast<std::size_t>(cell > 0 ? cell : n_);
        return std::abs(turning_deg(place_.whole, rung));
    }

    // The part of the tab that lies on cells where the strip is on top.
    double seen(int cell) const {
        if (place_.crossings.empty()) {
            return 0.0;
        }
        double length = 0.0;
        double on_top = 0.0;
        for (int k = 0; k < n_ && (k == 0 || length < place_.tab_mm); ++k) {
            const int at = (cell + k) % n_;
            const auto rung = static_cast<std::size_t>(at);
            const double step = std::max(
                1e-6, (middle(place_.whole, rung + 1) - middle(place_.whole, rung)).norm());
            const double part = k == 0 ? std::min(step, std::max(place_.tab_mm, 1e-6))
                                       : std::min(step, place_.tab_mm - length);
            length += part;
            on_top += place_.crossings[rung].on_top ? part : 0.0;
        }
        return length > 0.0 ? on_top / length : 0.0;
    }

    const JointPlace& place_;
    int n_;
};

}  // namespace

JointMap::JointMap(const geometry::QuadMesh& mesh) : irregular_(mesh.vertices.size(), 0) {
    const geometry::QuadNeighbours neighbours = geometry::find_neighbours(mesh.quads);
    std::vector<int> quads_at(mesh.vertices.size(), 0);
    std::vector<char> boundary(mesh.vertices.size(), 0);
    for (std::size_t q = 0; q < mesh.quads.size(); ++q) {
        for (std::size_t k = 0; k < 4; ++k) {
            ++quads_at[static_cast<std::size_t>(mesh.quads[q][k])];
            if (neighbours.across[q][k].quad < 0) {
                boundary[static_cast<std::size_t>(mesh.quads[q][k])] = 1;
                boundary[static_cast<std::size_t>(mesh.quads[q][(k + 1) % 4])] = 1;
            }
        }
    }
    for (std::size_t v = 0; v < irregular_.size(); ++v) {
        irregular_[v] = boundary[v] != 0 ? (quads_at[v] > 2 ? 1 : 0) : (quads_at[v] != 4 ? 1 : 0);
    }
    crowding_.fill(std::vector<double>(mesh.vertices.size(), 0.0));
}

void JointMap::add(const Strip& strip, const std::vector<WalkedCell>& cells, int cell) {
    std::vector<double>& crowding = crowding_[index(strip.family)];
    const int n = static_cast<int>(strip.quads.size());
    for (int step = -kApart + 1; step < kApart; ++step) {
        int at = cell + step;
        if (strip.closed) {
            at = (at % n + n) % n;
        } else if (at < 0 || at >= n) {
            continue;
        }
        const WalkedCell& here = cells[static_cast<std::size_t>(at)];
        const double near = 1.0 - static_cast<double>(std::abs(step)) / kApart;
        for (const int vertex : {here.l0, here.r0}) {
            double& known = crowding[static_cast<std::size_t>(vertex)];
            known = std::max(known, near);
        }
    }
}

std::vector<double> joint_costs(const JointPlace& place) {
    const JointCosts costs(place);
    std::vector<double> result;
    for (std::size_t i = 0; i < place.strip.quads.size(); ++i) {
        result.push_back(costs.at(static_cast<int>(i)));
    }
    return result;
}

double turning_deg(const Unfolded& flat, std::size_t rung) {
    if (rung == 0 || rung + 1 >= flat.left.size()) {
        return 0.0;
    }
    const Vector2d in = middle(flat, rung) - middle(flat, rung - 1);
    const Vector2d out = middle(flat, rung + 1) - middle(flat, rung);
    const double angle = angle_between(in, out);
    return angle * 180.0 / std::numbers::pi;
}

}  // namespace leafcutter::fab
