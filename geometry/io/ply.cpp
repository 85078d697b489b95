#include "geometry/error.h"
#include "geometry/io/read_mesh.h"

namespace leafcutter::geometry {

PolygonSoup read_ply(std::span<const std::byte> /*bytes*/, const ReadLimits& /*limits*/) {
    throw Error(ErrorKind::NotSupported, "not-supported", "PLY is not read yet; use OBJ or OFF");
}

}  // namespace leafcutter::geometry
