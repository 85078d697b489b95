// What a sender says, to each simulated machine: none falls over, and however the bytes are cut
// into pieces, it says the same and stands at the same place.

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/grbl_machine.h"
#include "drivers/sim/lihuiyu_machine.h"
#include "drivers/sim/marlin_machine.h"
#include "drivers/sim/smoothie_machine.h"
#include "parts.h"

namespace {

using namespace leafcutter::drivers;
using namespace leafcutter::fuzz;

std::unique_ptr<SimMachine> make_machine(unsigned choice) {
    switch (choice % 4) {
        case 0:
            return std::make_unique<FaultyMachine>(GrblMachineOptions());
        case 1:
            return std::make_unique<MarlinMachine>();
        case 2:
            return std::make_unique<SmoothieMachine>();
        default:
            return std::make_unique<LihuiyuMachine>();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Script script = read_script(data, size);
    const auto whole = make_machine(script.choice);
    const auto cut = make_machine(script.choice);
    for (const std::string_view part : script.parts) {
        std::string said = whole->feed(part);
        std::string said_to_cut;
        for (std::size_t i = 0; i < part.size(); ++i) {
            said_to_cut += cut->feed(part.substr(i, 1));
        }
        said_to_cut += part.empty() ? cut->feed({}) : std::string();
        said += whole->advance(0.05);
        said_to_cut += cut->advance(0.05);
        require(said == said_to_cut);
        require(std::isfinite(whole->beam_power()) && whole->beam_power() >= 0.0);
        require(whole->beam_power() == cut->beam_power());
    }
    for (const BurntPiece& piece : std::as_const(*whole).beam_log().pieces()) {
        require(std::isfinite(piece.x1_mm) && std::isfinite(piece.y1_mm) &&
                piece.t1_s >= piece.t0_s);
    }
    return 0;
}
