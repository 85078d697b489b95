#include "geometry/foliation_names.h"

namespace leafcutter::geometry {

const char* name_of(FoliationMode mode) {
    switch (mode) {
        case FoliationMode::Auto:
            return "auto";
        case FoliationMode::Pants:
            return "pants";
        case FoliationMode::OneForm:
            return "one-form";
        case FoliationMode::Disk:
            return "disk";
        case FoliationMode::Annulus:
            return "annulus";
        case FoliationMode::Torus:
            return "torus";
        case FoliationMode::SpherePolar:
            return "sphere-polar";
        case FoliationMode::SpherePillowcase:
            return "sphere-pillowcase";
    }
    return "";
}

}  // namespace leafcutter::geometry
