// Closed surfaces of genus 0 (section 3.6.2).
//
// The paper maps the surface conformally to the sphere, that to the plane, and pulls back the
// plane's straight lines. All leaves then run through the point that goes to infinity, where the
// quadratic differential has a pole of order four: cells shrink to nothing round it and no finite
// grid covers the surface. Two ways round that, both with closed threads and even cells near all
// singular points:
//
// - Pillowcase: a quadratic differential with simple poles at four points instead. Its flat surface
//   is a rectangle and its mirror image, sewn together along all sides: nothing is cut out, and no
//   cell is far smaller than its neighbours.
// - Polar: latitudes and longitudes, poles of order two. A small disk is cut out round both.

#pragma once

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// `mesh` is connected, closed and of genus 0. One cylinder, ChartShape::Pillowcase, slit open along
// the two arcs between singular points; `critical_graph` has these arcs. Singular points are the
// vertices options.near, filled up to four with those of all tried (tips of limbs and points far
// from one another) that give the most even cells. Rings are the shorter of the closed leaves.
// Throws Error(BadOption), "bad-near" unless the vertices of `near` exist and differ, "too-many-near"
// if there are more than four.
Foliation foliate_pillowcase(const TriangleMesh& mesh,
                             const FoliationOptions& options,
                             const Context& context);

// `mesh` is connected, closed and of genus 0. A ring between two small holes, at options.poles, at
// options.near (one vertex, and what is opposite, or two) or at the two ends of the surface.
// `punctures` has the holes.
// Throws Error(BadOption), "bad-poles" unless poles are two different vertices, given once,
// "too-many-near" for more than two.
Foliation foliate_sphere_polar(const TriangleMesh& mesh,
                               const FoliationOptions& options,
                               const Context& context);

}  // namespace leafcutter::geometry
