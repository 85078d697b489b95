// Everything that a job computed, as values: what the writers of the package's files read.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/certificate_facts.h"
#include "fab/cut/cut_program.h"
#include "fab/job_params.h"
#include "fab/layout.h"
#include "fab/material/bill.h"
#include "fab/material/material.h"
#include "fab/parts.h"
#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "fab/weave/assembly.h"
#include "fab/weave/thickness_report.h"
#include "fab/weave/weave.h"
#include "fab/weave/woven_model.h"
#include "geometry/foliation.h"
#include "geometry/leaves.h"
#include "geometry/quads/quality.h"
#include "geometry/quads/two_sided.h"
#include "geometry/repair.h"
#include "geometry/topology.h"

namespace leafcutter::fab {

struct InputFacts {
    std::string file;  // Valid UTF-8.
    std::size_t vertices = 0;
    std::size_t faces = 0;
    double scale = 1.0;  // The factor applied to its coordinates.
};

// A hole that the foliation opened.
struct OpenedHole {
    int input_vertex = -1;     // Its centre in the input file; -1 if that has no such vertex.
    Eigen::Vector3d position;  // mm
    double radius_mm = 0.0;    // On the surface.
};

// How near a singular point came to where one was wanted.
struct ReachedPlace {
    int input_vertex = -1;     // As it was asked for; for a position, the vertex there.
    int singularity = -1;      // Of the foliation's; -1 for a pole, which is cut out.
    double distance_mm = 0.0;  // Along the surface.
};

struct JobResult {
    JobParams params;
    std::string params_json;  // The same as JSON, for the report; empty: whoever asked has none.
    MachineProfile machine;
    InputFacts input;
    geometry::RepairReport repair;
    geometry::Topology topology;
    std::vector<Part> parts;  // One for each component.
    geometry::Foliation foliation;
    std::vector<OpenedHole> holes;
    std::vector<ReachedPlace> reached;
    geometry::QuadMesh quads;
    geometry::QualityReport quality;
    geometry::TwoSidedDistance two_sided;
    double surface_area_mm2 = 0.0;
    double woven_area_mm2 = 0.0;  // Of the cylinders: without holes, poles and parts left out.
    std::vector<geometry::Leaf> leaves;
    std::vector<Strip> strips;
    std::vector<Piece> pieces;
    Weave weave;
    Crossings crossings;
    Assembly assembly;
    WovenModel woven;
    ThicknessReport thickness;
    Bill bill;
    Material weft;
    Material warp;
    Layout layout;
    std::vector<CutProgram> programs;  // One for each sheet of the layout, same order.
    Certificate certificate;
    std::vector<std::pair<std::string, double>> timings_s;
    std::vector<std::string> warnings;

    const Material& material_of(Family family) const {
        return family == Family::Weft ? weft : warp;
    }
};

}  // namespace leafcutter::fab
