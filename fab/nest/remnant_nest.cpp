#include "fab/nest/remnant_nest.h"

#include <utility>

#include <fmt/format.h>

#include "fab/nest/family_nest.h"
#include "fab/nest/nest.h"
#include "fab/nest/offcut.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"

namespace leafcutter::fab {

Layout nest_remnant(std::span<const Piece* const> pieces,
                    const Material& material,
                    const Ring& outline,
                    const NestingParams& params,
                    const geometry::Context& context) {
    if (const std::string fault = ring_fault(outline); !fault.empty()) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "bad-remnant",
                              fmt::format("remnant: {}", fault));
    }
    StockItem remnant;
    remnant.id = "remnant";
    remnant.outline = outline;
    move_to_origin(remnant);
    NestOptions options;
    options.spacing_mm = params.spacing_mm;
    options.margin_mm = params.margin_mm;
    options.kerf_mm = material.kerf_mm;
    options.turns = turns_on(material, params);
    options.seed = params.seed;
    options.max_evaluations = tries_in(params.time_s, pieces);
    options.time_s = 4.0 * params.time_s;
    Layout layout = nest(pieces, {&remnant, 1}, options, context);
    context.check();
    add_offcuts(layout, pieces, material.kerf_mm);
    for (Sheet& sheet : layout.sheets) {
        sheet.material = material.id;
        sheet.stock.clear();
    }
    return layout;
}

}  // namespace leafcutter::fab
