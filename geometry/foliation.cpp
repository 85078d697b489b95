#include "geometry/foliation.h"

#include <string>

#include "geometry/cases/annulus.h"
#include "geometry/cases/disk.h"
#include "geometry/cases/pants.h"
#include "geometry/cases/torus.h"
#include "geometry/topology.h"

namespace leafcutter::geometry {
namespace {

[[noreturn]] void refuse(const std::string& code, const std::string& what) {
    throw Error(ErrorKind::NotSupported, code, what);
}

void check_mode_is_built(FoliationMode mode) {
    switch (mode) {
        case FoliationMode::OneForm:
            refuse("mode-not-built", "foliation.mode: one-form is not supported yet; use auto");
        case FoliationMode::SpherePolar:
        case FoliationMode::SpherePillowcase:
            refuse(
                "mode-not-built",
                "foliation.mode: the sphere modes are not supported yet; cut a hole into the model "
                "and use auto");
        case FoliationMode::Auto:
        case FoliationMode::Pants:
        case FoliationMode::Disk:
        case FoliationMode::Annulus:
        case FoliationMode::Torus:
            return;
    }
}

// The mode that a surface of this topology asks for.
FoliationMode natural_mode(const Topology& topology) {
    const std::string figures = " (genus " + std::to_string(topology.genus) + ", " +
                                std::to_string(topology.boundary_loops.size()) + " boundary loops)";
    if (topology.components != 1) {
        throw Error(ErrorKind::BadMesh, "several-components",
                    "the model has " + std::to_string(topology.components) +
                        " separate parts; weave them one at a time");
    }
    if (topology.euler == 2) {
        refuse("sphere-not-supported",
               "the model is a closed sphere, which is not supported yet; cut one hole into it (a "
               "disk) "
               "or two (an annulus)");
    }
    if (topology.euler < 0) {
        return FoliationMode::Pants;
    }
    if (topology.euler == 1) {
        return FoliationMode::Disk;
    }
    return topology.boundary_loops.empty() ? FoliationMode::Torus : FoliationMode::Annulus;
}

const char* name_of(FoliationMode mode) {
    switch (mode) {
        case FoliationMode::Disk:
            return "disk";
        case FoliationMode::Annulus:
            return "annulus";
        case FoliationMode::Pants:
            return "surface for pants";
        default:
            return "torus";
    }
}

void check_options(const FoliationOptions& options, FoliationMode natural) {
    if (options.mode != FoliationMode::Auto && options.mode != natural) {
        throw Error(ErrorKind::BadOption, "mode-does-not-fit",
                    std::string("foliation.mode: \"") + name_of(options.mode) +
                        "\" does not fit, the model is a topological " + name_of(natural));
    }
    if (options.corners && natural != FoliationMode::Disk) {
        throw Error(ErrorKind::BadOption, "bad-corners",
                    std::string("foliation.corners: only a disk has corners, the model is a "
                                "topological ") +
                        name_of(natural));
    }
}

}  // namespace

Foliation compute_foliation(const Mesh& mesh,
                            const FoliationOptions& options,
                            const Context& context) {
    context.report("foliation", 0.0);
    check_mode_is_built(options.mode);
    const Topology topology = analyse_topology(mesh);
    const FoliationMode natural = natural_mode(topology);
    check_options(options, natural);
    const TriangleMesh surface = to_triangle_mesh(mesh);
    Foliation foliation;
    if (natural == FoliationMode::Disk) {
        foliation = foliate_disk(surface, topology.boundary_loops[0], options, context);
    } else if (natural == FoliationMode::Pants) {
        foliation = foliate_pants(surface, topology.boundary_loops, options, context);
    } else if (natural == FoliationMode::Annulus) {
        foliation = foliate_annulus(
            surface, {topology.boundary_loops[0], topology.boundary_loops[1]}, options, context);
    } else {
        foliation = foliate_torus(surface, options, context);
    }
    context.report("foliation", 1.0);
    return foliation;
}

}  // namespace leafcutter::geometry
