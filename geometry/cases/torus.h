// A torus becomes a parallelogram with two periods (section 3.6.1): f is the harmonic map to a
// circle over one generator, g its conjugate.

#pragma once

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// `mesh` is connected, closed and of genus 1. The leaves of F are homotopic to the generator with
// the shorter (or longer) rings in the conformal metric, out of a Gauss-reduced pair.
Foliation foliate_torus(const TriangleMesh& mesh,
                        const FoliationOptions& options,
                        const Context& context);

}  // namespace leafcutter::geometry
