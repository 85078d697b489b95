#include "geometry/cases/one_form.h"

namespace leafcutter::geometry {

Foliation foliate_one_form(const TriangleMesh& /*mesh*/,
                           const std::vector<std::vector<int>>& /*loops*/,
                           const std::vector<int>& /*sources*/,
                           const std::vector<int>& /*sinks*/,
                           const FoliationOptions& /*options*/,
                           const Context& /*context*/) {
    throw Error(ErrorKind::NotSupported, "mode-not-built",
                "foliation.mode: one-form is not supported yet; use auto");
}

}  // namespace leafcutter::geometry
