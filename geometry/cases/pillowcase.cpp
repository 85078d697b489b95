#include "geometry/cases/sphere.h"
#include "geometry/error.h"

namespace leafcutter::geometry {

Foliation foliate_pillowcase(const TriangleMesh& /*mesh*/,
                             const FoliationOptions& /*options*/,
                             const Context& /*context*/) {
    throw Error(ErrorKind::NotSupported, "not-supported-yet", "sphere-pillowcase is being built");
}

}  // namespace leafcutter::geometry
