#include "geometry/punctures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "geometry/puncture_cutter.h"
#include "geometry/puncture_site.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

constexpr std::size_t kLeastLoop = 32;
constexpr double kLeastRadius = 1e-4;  // By the diagonal of the bounding box.
constexpr int kMostAttempts = 24;

[[noreturn]] void refuse(std::size_t puncture, const std::string& why) {
    throw Error(ErrorKind::BadOption, "bad-puncture",
                fmt::format("foliation.punctures[{}]: {}", puncture, why));
}

void check_punctures(const PunctureSite& site) {
    const int vertices = static_cast<int>(site.surface.mesh.positions.size());
    for (std::size_t k = 0; k < site.punctures.size(); ++k) {
        const Puncture& puncture = site.punctures[k];
        if (puncture.vertex < 0 || puncture.vertex >= vertices) {
            refuse(k, fmt::format("the model has no vertex {}; its vertices are 0 to {}",
                                  puncture.vertex, vertices - 1));
        }
        if (!(puncture.radius >= kLeastRadius * site.diagonal) || !std::isfinite(puncture.radius)) {
            refuse(k,
                   fmt::format("the radius must be at least {:.3g}", kLeastRadius * site.diagonal));
        }
        for (std::size_t i = 0; i < k; ++i) {
            if (site.punctures[i].vertex == puncture.vertex) {
                refuse(k, fmt::format("its vertex {} is that of [{}], too", puncture.vertex, i));
            }
        }
    }
}

// Makes a hole smaller, or gives it up, or refuses.
void settle(PunctureSite& site, const Misfit& misfit, PunctureFit fit) {
    const double least = kLeastRadius * site.diagonal;
    const bool is_possible = misfit.radius > least;
    if (fit == PunctureFit::AsGiven) {
        refuse(misfit.puncture,
               is_possible ? fmt::format("{}; a radius of {:.3g}{} would do", misfit.why,
                                         misfit.radius, misfit.other < 0 ? "" : " for both")
                           : fmt::format("{}; choose another vertex", misfit.why));
    }
    if (is_possible) {
        double& radius = site.punctures[misfit.puncture].radius;
        radius = std::min(radius, misfit.radius);
        if (misfit.other >= 0) {
            double& other = site.punctures[static_cast<std::size_t>(misfit.other)].radius;
            other = std::min(other, misfit.radius);
        }
    } else {
        const auto place = static_cast<std::ptrdiff_t>(misfit.puncture);
        site.punctures.erase(site.punctures.begin() + place);
        site.fineness.erase(site.fineness.begin() + place);
    }
}

}  // namespace

OpenedMesh open_punctures(const TriangleMesh& mesh,
                          std::span<const Puncture> punctures,
                          const Context& context,
                          PunctureFit fit) {
    PunctureSite site;
    site.surface = start_surface(mesh, std::vector<std::uint8_t>(mesh.positions.size(), 0));
    site.punctures.assign(punctures.begin(), punctures.end());
    site.fineness.assign(punctures.size(), 1.0);
    site.area = surface_area(mesh);
    site.diagonal = diagonal(mesh);
    check_punctures(site);
    for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
        refine(site, context);
        const std::vector<Ball> balls = balls_of(site, context);
        std::vector<Disk> disks;
        if (const std::optional<Misfit> misfit = find_disks(site, balls, disks)) {
            settle(site, *misfit, fit);
            continue;
        }
        PunctureCutter cutter(site, balls, disks);
        cutter.cut();
        bool is_fine = true;
        for (std::size_t k = 0; k < disks.size(); ++k) {
            if (cutter.rims()[k].size() < kLeastLoop) {
                site.fineness[k] *= 0.5;
                is_fine = false;
            }
        }
        if (is_fine) {
            return cutter.finish();
        }
    }
    throw Error(ErrorKind::SelfCheck, "broken-hole",
                "punctures: no holes could be opened; give vertices and radii or use \"none\"");
}

}  // namespace leafcutter::geometry
