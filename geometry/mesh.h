// The surface data structure: OpenMesh's half-edge triangle mesh with Eigen points.
//
// Heavy header: include it only where half-edges are walked; pass TriangleMesh elsewhere.

#pragma once

#include <Eigen/Core>

// OpenMesh appends value-initialised points, which Eigen leaves unset until they are assigned: the
// compiler warns of that from inside these headers.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

// EigenVectorT.hh specialises a template that the mesh header declares, so it must come second.
// clang-format off
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
// clang-format on

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

namespace leafcutter::geometry {

struct MeshTraits : OpenMesh::DefaultTraits {
    using Point = Eigen::Vector3d;
    using Normal = Eigen::Vector3d;
};

using Mesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

}  // namespace leafcutter::geometry
