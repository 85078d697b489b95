#include "fab/cut/certificate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include <polyclipping/clipper.hpp>

#include "fab/cut/audit.h"
#include "fab/strips/unfold.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kUnitsPerMm = 1e6;
constexpr double kJoinMm = 1e-6;  // Ends of burns this close follow each other.

struct Bounds {
    Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
    Vector2d high = -low;

    void add(const Vector2d& point) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    double difference(const Bounds& other) const {
        return std::max((low - other.low).cwiseAbs().maxCoeff(),
                        (high - other.high).cwiseAbs().maxCoeff());
    }
};

template <typename Points>
Bounds bounds_of(const Points& points) {
    Bounds bounds;
    for (const Vector2d& point : points) {
        bounds.add(point);
    }
    return bounds;
}

// Closed contours among the burns, each without its closing point.
std::vector<Ring> closed_contours(std::span<const BurntSegment> burnt) {
    std::vector<Ring> contours;
    Ring chain;
    for (const BurntSegment& segment : burnt) {
        if (chain.empty() || (chain.back() - segment.from).norm() > kJoinMm) {
            chain = {segment.from};
        }
        if ((segment.to - chain.front()).norm() <= kJoinMm && chain.size() > 2) {
            contours.push_back(std::move(chain));
            chain.clear();
        } else {
            chain.push_back(segment.to);
        }
    }
    return contours;
}

Vector2d into_piece(const Placement& placement, const Vector2d& point) {
    const double angle = placement.rotation_deg * std::numbers::pi / 180.0;
    const Vector2d moved = point - Vector2d(placement.x_mm, placement.y_mm);
    const double x = std::cos(angle) * moved.x() + std::sin(angle) * moved.y();
    const double y = -std::sin(angle) * moved.x() + std::cos(angle) * moved.y();
    return {placement.mirrored ? -x : x, y};
}

// The ring moved inward by half the kerf; the largest one if it falls apart.
Ring without_kerf(const Ring& ring, double kerf_mm) {
    ClipperLib::Path path;
    for (const Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() * kUnitsPerMm),
                          std::llround(point.y() * kUnitsPerMm));
    }
    ClipperLib::ClipperOffset offset;
    offset.AddPath(path, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    ClipperLib::Paths shrunk;
    offset.Execute(shrunk, -kerf_mm / 2.0 * kUnitsPerMm);
    Ring result;
    double largest = 0.0;
    for (const ClipperLib::Path& contour : shrunk) {
        const double area = std::abs(ClipperLib::Area(contour));
        if (area > largest) {
            largest = area;
            result.clear();
            for (const ClipperLib::IntPoint& point : contour) {
                result.emplace_back(static_cast<double>(point.X) / kUnitsPerMm,
                                    static_cast<double>(point.Y) / kUnitsPerMm);
            }
        }
    }
    return result;
}

Vector2d nearest_on(const Ring& ring, const Vector2d& point) {
    Vector2d best = ring.front();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d& from = ring[i];
        const Vector2d along = ring[(i + 1) % ring.size()] - from;
        const double length2 = along.squaredNorm();
        const double t =
            length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
        const Vector2d candidate = from + t * along;
        if ((candidate - point).squaredNorm() < (best - point).squaredNorm()) {
            best = candidate;
        }
    }
    return best;
}

double mean_edge(const geometry::QuadMesh& mesh) {
    double sum = 0.0;
    for (const auto& quad : mesh.quads) {
        for (std::size_t i = 0; i < 4; ++i) {
            sum += (mesh.vertices[static_cast<std::size_t>(quad[i])] -
                    mesh.vertices[static_cast<std::size_t>(quad[(i + 1) % 4])])
                       .norm();
        }
    }
    return sum / (4.0 * static_cast<double>(mesh.quads.size()));
}

class Certifier {
public:
    explicit Certifier(const JobResult& job) : job_(job), mean_edge_mm_(mean_edge(job.quads)) {
        for (const Strip& strip : job.strips) {
            strips_[strip.id] = &strip;
        }
        for (const Piece& piece : job.pieces) {
            pieces_[piece.id] = &piece;
        }
    }

    void add_sheet(const Sheet& sheet, const std::string& gcode) {
        const std::vector<BurntSegment> burnt = burnt_segments(gcode);
        const std::vector<Ring> contours = closed_contours(burnt);
        std::vector<Bounds> bounds;
        bounds.reserve(contours.size());
        for (const Ring& contour : contours) {
            bounds.push_back(bounds_of(contour));
        }
        for (const Placement& placement : sheet.placements) {
            const Piece& piece = *pieces_.at(placement.piece);
            const double kerf_mm = job_.material_of(piece.family).kerf_mm;
            const auto match = best_match(placement, piece, kerf_mm, bounds);
            if (!match) {
                note(mean_edge_mm_);
                continue;
            }
            Ring contour;
            for (const Vector2d& point : contours[*match]) {
                contour.push_back(into_piece(placement, point));
            }
            measure(piece, without_kerf(contour, kerf_mm));
        }
    }

    Certificate result() const { return certificate_; }

private:
    static std::optional<std::size_t> best_match(const Placement& placement,
                                                 const Piece& piece,
                                                 double kerf_mm,
                                                 const std::vector<Bounds>& bounds) {
        Bounds expected;
        for (const Vector2d& point : piece.outline) {
            expected.add(placement.apply(point));
        }
        expected.low.array() -= kerf_mm / 2.0;
        expected.high.array() += kerf_mm / 2.0;
        std::optional<std::size_t> best;
        for (std::size_t i = 0; i < bounds.size(); ++i) {
            if (!best || bounds[i].difference(expected) < bounds[*best].difference(expected)) {
                best = i;
            }
        }
        return best;
    }

    void measure(const Piece& piece, const Ring& burnt) {
        if (burnt.empty()) {
            note(mean_edge_mm_);
            return;
        }
        const auto rebuilt = [&](const Polyline& exact, const Polyline& planned) {
            Polyline points;
            for (std::size_t i = 0; i < exact.size(); ++i) {
                points.emplace_back(exact[i] + nearest_on(burnt, planned[i]) - planned[i]);
            }
            return points;
        };
        const Polyline left = rebuilt(piece.left, piece.cut_left);
        const Polyline right = rebuilt(piece.right, piece.cut_right);
        const std::vector<WalkedCell> cells = walk_cells(job_.quads, *strips_.at(piece.strip));
        for (std::size_t i = 0; i + 1 < left.size(); ++i) {
            const auto at = (static_cast<std::size_t>(piece.first_cell) + i) % cells.size();
            const WalkedCell& cell = cells[at];
            compare((left[i] - right[i]).norm(), cell.l0, cell.r0);
            compare((left[i + 1] - right[i + 1]).norm(), cell.l1, cell.r1);
            compare((left[i + 1] - left[i]).norm(), cell.l0, cell.l1);
            compare((right[i + 1] - right[i]).norm(), cell.r0, cell.r1);
        }
    }

    void compare(double rebuilt_mm, int from, int to) {
        const auto at = [&](int vertex) -> const Eigen::Vector3d& {
            return job_.quads.vertices[static_cast<std::size_t>(vertex)];
        };
        note(std::abs(rebuilt_mm - (at(from) - at(to)).norm()));
    }

    void note(double deviation_mm) {
        ++certificate_.edges_compared;
        certificate_.largest_deviation_mm =
            std::max(certificate_.largest_deviation_mm, deviation_mm);
        certificate_.largest_deviation_relative = certificate_.largest_deviation_mm / mean_edge_mm_;
    }

    const JobResult& job_;
    double mean_edge_mm_;
    std::map<std::string, const Strip*> strips_;
    std::map<std::string, const Piece*> pieces_;
    Certificate certificate_;
};

}  // namespace

Certificate certify(const JobResult& job, std::span<const std::string> gcode) {
    Certifier certifier(job);
    for (std::size_t i = 0; i < job.layout.sheets.size(); ++i) {
        certifier.add_sheet(job.layout.sheets[i], gcode[i]);
    }
    return certifier.result();
}

}  // namespace leafcutter::fab
