#include "fab/strips/crossings.h"

#include <array>
#include <cstddef>

namespace leafcutter::fab {

Crossings crossings_of(std::span<const Strip> strips, const Weave& weave) {
    struct Place {
        int strip = -1;
        int cell = -1;
    };
    std::array<std::vector<Place>, 2> at;  // Per family, per quad.
    at.fill(std::vector<Place>(weave.warp_on_top.size()));
    for (std::size_t i = 0; i < strips.size(); ++i) {
        auto& places = at[strips[i].family == Family::Weft ? 0 : 1];
        for (std::size_t cell = 0; cell < strips[i].quads.size(); ++cell) {
            places[static_cast<std::size_t>(strips[i].quads[cell])] = {static_cast<int>(i),
                                                                       static_cast<int>(cell)};
        }
    }
    Crossings crossings(strips.size());
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const bool weft = strips[i].family == Family::Weft;
        for (const int quad : strips[i].quads) {
            const auto index = static_cast<std::size_t>(quad);
            const Place& other = at[weft ? 1 : 0][index];
            crossings[i].push_back(
                {other.strip, other.cell, (weave.warp_on_top[index] != 0) != weft});
        }
    }
    return crossings;
}

}  // namespace leafcutter::fab
