#include "geometry/cases/sphere.h"
#include "geometry/error.h"

namespace leafcutter::geometry {

Foliation foliate_sphere_polar(const TriangleMesh& /*mesh*/,
                               const FoliationOptions& /*options*/,
                               const Context& /*context*/) {
    throw Error(ErrorKind::NotSupported, "not-supported-yet", "sphere-polar is being built");
}

}  // namespace leafcutter::geometry
