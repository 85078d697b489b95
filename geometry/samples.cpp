#include "geometry/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/implicit_surface.h"

namespace leafcutter::geometry {

namespace {

using std::numbers::pi;

// ---- Grids of quads, halved along alternating diagonals

enum class Wrap { Open, Closed };

struct GridShape {
    int columns = 0;  // Of quads.
    int rows = 0;
    Wrap around = Wrap::Open;  // The last column meets the first.
    Wrap along = Wrap::Open;   // The last row meets the first.
};

// `point` maps (column, row) in [0, columns] x [0, rows]; faces are wound column, then row.
TriangleMesh grid(const GridShape& shape, const std::function<Eigen::Vector3d(int, int)>& point) {
    const int across = shape.columns + (shape.around == Wrap::Open ? 1 : 0);
    const int up = shape.rows + (shape.along == Wrap::Open ? 1 : 0);
    TriangleMesh mesh;
    for (int row = 0; row < up; ++row) {
        for (int column = 0; column < across; ++column) {
            mesh.positions.push_back(point(column, row));
        }
    }
    const auto vertex = [&](int column, int row) { return row % up * across + column % across; };
    for (int row = 0; row < shape.rows; ++row) {
        for (int column = 0; column < shape.columns; ++column) {
            const int a = vertex(column, row);
            const int b = vertex(column + 1, row);
            const int c = vertex(column + 1, row + 1);
            const int d = vertex(column, row + 1);
            if ((column + row) % 2 == 0) {
                mesh.triangles.push_back({a, b, c});
                mesh.triangles.push_back({a, c, d});
            } else {
                mesh.triangles.push_back({a, b, d});
                mesh.triangles.push_back({b, c, d});
            }
        }
    }
    return mesh;
}

// Columns and rows of about faces / 2 square quads over a width : height rectangle.
GridShape square_quads(int faces, double width_over_height) {
    const double rows = std::sqrt(faces / (2.0 * width_over_height));
    return {std::max(3, static_cast<int>(std::lround(rows * width_over_height))),
            std::max(3, static_cast<int>(std::lround(rows))), Wrap::Open, Wrap::Open};
}

// A point (radius, height) for t in [0, 1].
using Profile = std::function<Eigen::Vector2d(double)>;

// The surface that a profile draws as it turns about the z axis. Rows are as far apart as columns
// at each height (isothermal coordinates), so that the quads are squares everywhere.
TriangleMesh revolve(const Profile& profile, Wrap along, int faces) {
    constexpr int kSteps = 4096;
    std::vector<double> height(kSteps + 1, 0.0);  // In radians of a column, up to each step.
    for (int step = 0; step < kSteps; ++step) {
        const Eigen::Vector2d a = profile(static_cast<double>(step) / kSteps);
        const Eigen::Vector2d b = profile(static_cast<double>(step + 1) / kSteps);
        const auto at = static_cast<std::size_t>(step);
        height[at + 1] = height[at] + (b - a).norm() / (0.5 * (a.x() + b.x()));
    }
    GridShape shape = square_quads(faces, 2.0 * pi / height.back());
    shape.around = Wrap::Closed;
    shape.along = along;
    return grid(shape, [&](int column, int row) {
        const double wanted = height.back() * row / shape.rows;
        const auto above = std::clamp<std::ptrdiff_t>(
            std::lower_bound(height.begin(), height.end(), wanted) - height.begin(), 1, kSteps);
        const auto at = static_cast<std::size_t>(above);
        const double share = (wanted - height[at - 1]) / (height[at] - height[at - 1]);
        const Eigen::Vector2d p = profile((static_cast<double>(above - 1) + share) / kSteps);
        const double angle = 2.0 * pi * column / shape.columns;
        return Eigen::Vector3d(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    });
}

TriangleMesh make_torus(int faces) {
    constexpr double kRadius = 1.0;
    constexpr double kTube = 0.4;
    return revolve(
        [](double t) {
            const double angle = 2.0 * pi * t;
            return Eigen::Vector2d(kRadius + kTube * std::cos(angle), kTube * std::sin(angle));
        },
        Wrap::Closed, faces);
}

TriangleMesh make_cylinder(int faces) {
    static constexpr double kRadius = 0.4;
    return revolve([](double t) { return Eigen::Vector2d(kRadius, 2.0 * t - 1.0); }, Wrap::Open,
                   faces);
}

// Foot, belly, neck and lip; open above and below.
TriangleMesh make_vase(int faces) {
    return revolve(
        [](double t) {
            const double belly = 0.28 * std::sin(pi * (1.45 * t + 0.12));
            const double lip = 0.16 * std::pow(t, 6);
            return Eigen::Vector2d(0.36 + belly + lip, 1.8 * t - 0.9);
        },
        Wrap::Open, faces);
}

// A height field over the square [-1, 1] x [-1, 1].
TriangleMesh height_field(int faces,
                          const std::function<Eigen::Vector3d(double x, double y)>& point) {
    const GridShape shape = square_quads(faces, 1.0);
    return grid(shape, [&](int column, int row) {
        return point(2.0 * column / shape.columns - 1.0, 2.0 * row / shape.rows - 1.0);
    });
}

TriangleMesh make_square(int faces) {
    return height_field(faces, [](double x, double y) { return Eigen::Vector3d(x, y, 0.0); });
}

TriangleMesh make_saddle(int faces) {
    return height_field(
        faces, [](double x, double y) { return Eigen::Vector3d(x, y, 0.5 * (x * x - y * y)); });
}

struct Bump {
    double x;
    double y;
    double width;
    double length;
    double height;
};

// A mask: an oval dome with brow, eyes, nose, lips and chin.
TriangleMesh make_face(int faces) {
    static constexpr std::array<Bump, 10> kFeatures{{{0.0, 0.02, 0.09, 0.26, 0.16},     // Nose,
                                                     {0.0, -0.17, 0.12, 0.09, 0.14},    // its tip,
                                                     {-0.32, 0.24, 0.15, 0.10, -0.11},  // eyes,
                                                     {0.32, 0.24, 0.15, 0.10, -0.11},
                                                     {-0.28, 0.42, 0.24, 0.08, 0.06},  // brows,
                                                     {0.28, 0.42, 0.24, 0.08, 0.06},
                                                     {0.0, -0.44, 0.22, 0.06, 0.07},  // lips,
                                                     {0.0, -0.58, 0.18, 0.06, 0.06},
                                                     {0.0, -0.84, 0.20, 0.14, 0.08},   // chin,
                                                     {0.0, 0.72, 0.55, 0.28, 0.06}}};  // forehead.
    return height_field(faces, [](double u, double v) {
        constexpr double kRound = 0.3;  // How far the square's corners are drawn in.
        const double x = 0.78 * u * std::sqrt(1.0 - kRound * v * v);
        const double y = v * std::sqrt(1.0 - kRound * u * u);
        double z = 0.75 * (1.0 - 0.75 * x * x - 0.45 * y * y);
        for (const Bump& bump : kFeatures) {
            const double dx = (x - bump.x) / bump.width;
            const double dy = (y - bump.y) / bump.length;
            z += bump.height * std::exp(-dx * dx - dy * dy);
        }
        return Eigen::Vector3d(x, y, z);
    });
}

// ---- Solids

// The lesser of two distances, rounded where they are within `blend` of each other (I. Quilez's
// polynomial smooth minimum).
double smooth_min(double a, double b, double blend) {
    const double overlap = std::max(blend - std::abs(a - b), 0.0) / blend;
    return std::min(a, b) - overlap * overlap * blend * 0.25;
}

double torus_distance(const Eigen::Vector3d& p, double radius, double tube) {
    return std::hypot(std::hypot(p.x(), p.y()) - radius, p.z()) - tube;
}

struct Limb {
    Eigen::Vector3d from;
    Eigen::Vector3d to;
    double from_radius;
    double to_radius;
};

// Distance to a round stick that tapers from one end to the other, but for the taper's slope.
double limb_distance(const Eigen::Vector3d& p, const Limb& limb) {
    const Eigen::Vector3d axis = limb.to - limb.from;
    const double t = std::clamp((p - limb.from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    const double radius = limb.from_radius + t * (limb.to_radius - limb.from_radius);
    return (p - limb.from - t * axis).norm() - radius;
}

TriangleMesh make_sphere(int faces) {
    return mesh_implicit_surface(
        {[](const Eigen::Vector3d& p) { return p.norm() - 1.0; }, Eigen::Vector3d::Constant(-1.2),
         Eigen::Vector3d::Constant(1.2), 0.3},
        faces);
}

// A thickened lemniscate: the sum of squares of its plane equation, made nearly a distance by its
// slope, and of the height.
TriangleMesh make_eight(int faces) {
    const auto value = [](const Eigen::Vector3d& p) {
        constexpr double kTube = 0.2;
        const double x2 = p.x() * p.x();
        const double curve = x2 * (1.0 - x2) - p.y() * p.y();
        const double slope = std::hypot(2.0 * p.x() - 4.0 * x2 * p.x(), 2.0 * p.y());
        const double away = curve / std::hypot(slope, 0.45);
        return std::hypot(away, p.z()) - kTube;
    };
    return mesh_implicit_surface({value, {-1.6, -1.2, -0.5}, {1.6, 1.2, 0.5}, 0.1}, faces);
}

TriangleMesh make_double_torus(int faces) {
    const auto value = [](const Eigen::Vector3d& p) {
        const Eigen::Vector3d offset(1.15, 0.0, 0.0);
        return smooth_min(torus_distance(p - offset, 1.0, 0.4),
                          torus_distance(p + offset, 1.0, 0.4), 0.35);
    };
    return mesh_implicit_surface({value, {-2.8, -1.7, -0.7}, {2.8, 1.7, 0.7}, 0.2}, faces);
}

// Open at the wrist, fingers up.
TriangleMesh make_hand(int faces) {
    static const std::array<Limb, 8> limbs{{{{0, 0, -0.5}, {0, 0, 0.3}, 0.26, 0.26},
                                            {{-0.12, 0, 0.35}, {-0.16, 0, 0.85}, 0.22, 0.18},
                                            {{0.12, 0, 0.35}, {0.16, 0, 0.85}, 0.22, 0.18},
                                            {{-0.28, 0, 0.9}, {-0.42, 0, 1.48}, 0.095, 0.075},
                                            {{-0.09, 0, 0.95}, {-0.13, 0.02, 1.68}, 0.1, 0.08},
                                            {{0.1, 0, 0.95}, {0.14, 0.02, 1.62}, 0.1, 0.08},
                                            {{0.27, 0, 0.9}, {0.42, 0, 1.42}, 0.09, 0.07},
                                            {{0.2, 0.05, 0.4}, {0.66, 0.14, 0.88}, 0.13, 0.085}}};
    const auto value = [](const Eigen::Vector3d& p) {
        constexpr double kBlend = 0.09;
        double distance = limb_distance(p, limbs[0]);
        for (const Limb& limb : limbs) {
            distance = smooth_min(distance, limb_distance(p, limb), kBlend);
        }
        return distance;
    };
    return mesh_implicit_surface({value, {-0.7, -0.45, 0.0}, {0.95, 0.45, 1.95}, 0.06}, faces);
}

struct Sample {
    std::string_view name;
    TriangleMesh (*make)(int faces);
};

constexpr std::array<Sample, 10> kSamples{{{"eight", make_eight},
                                           {"double-torus", make_double_torus},
                                           {"torus", make_torus},
                                           {"sphere", make_sphere},
                                           {"hand", make_hand},
                                           {"face", make_face},
                                           {"vase", make_vase},
                                           {"cylinder", make_cylinder},
                                           {"square", make_square},
                                           {"saddle", make_saddle}}};

constexpr auto kNames = [] {
    std::array<std::string_view, kSamples.size()> names;
    for (std::size_t i = 0; i < kSamples.size(); ++i) {
        names[i] = kSamples[i].name;
    }
    return names;
}();

}  // namespace

std::span<const std::string_view> sample_names() {
    return kNames;
}

TriangleMesh make_sample(std::string_view name, int faces) {
    constexpr int kFewest = 100;
    constexpr int kMost = 5'000'000;
    if (faces < kFewest || faces > kMost) {
        throw Error(ErrorKind::BadOption, "bad-option",
                    fmt::format("faces: {} is out of range, give {} to {}", faces, kFewest, kMost));
    }
    for (const Sample& sample : kSamples) {
        if (sample.name == name) {
            return sample.make(faces);
        }
    }
    throw Error(
        ErrorKind::BadOption, "bad-option",
        fmt::format("sample: there is no \"{}\"; choose {}", name, fmt::join(kNames, ", ")));
}

}  // namespace leafcutter::geometry
