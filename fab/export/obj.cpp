#include <iterator>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "fab/export/colour.h"
#include "fab/export/solids.h"

namespace leafcutter::fab {

namespace {

const char* name_of(Family family) {
    return family == Family::Weft ? "weft" : "warp";
}

}  // namespace

std::string write_obj(std::span<const Solid> solids, const std::string& material_file) {
    std::string out = fmt::format("# Leafcutter woven model, mm, z up\nmtllib {}\n", material_file);
    const auto append = std::back_inserter(out);
    std::size_t first = 1;
    for (const Solid& solid : solids) {
        fmt::format_to(append, "o {}\nusemtl {}\n", solid.name, name_of(solid.family));
        for (const Eigen::Vector3d& p : solid.vertices) {
            fmt::format_to(append, FMT_COMPILE("v {:.4f} {:.4f} {:.4f}\n"), p.x(), p.y(), p.z());
        }
        for (const auto& [i, j, k] : solid.triangles) {
            fmt::format_to(append, FMT_COMPILE("f {} {} {}\n"), first + static_cast<std::size_t>(i),
                           first + static_cast<std::size_t>(j),
                           first + static_cast<std::size_t>(k));
        }
        first += solid.vertices.size();
    }
    return out;
}

std::string write_mtl(const FamilyColours& colours) {
    std::string out;
    for (const Family family : {Family::Weft, Family::Warp}) {
        const Rgb c = rgb_of(family == Family::Weft ? colours.weft : colours.warp);
        fmt::format_to(std::back_inserter(out),
                       "newmtl {}\nKd {:.4f} {:.4f} {:.4f}\nKs 0 0 0\nd 1\nillum 1\n",
                       name_of(family), c[0], c[1], c[2]);
    }
    return out;
}

}  // namespace leafcutter::fab
