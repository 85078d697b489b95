// A program file, to every driver that reads one: words, Grbl's checks, the moves for a Lihuiyu
// board, EGV. Nothing but a refusal comes out of them, and what a board is given can be read back.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "drivers/gcode_words.h"
#include "drivers/grbl/program.h"
#include "drivers/lihuiyu/egv.h"
#include "drivers/lihuiyu/program.h"
#include "parts.h"

namespace {

using namespace leafcutter::drivers;
using leafcutter::fuzz::require;

void read_for_grbl(std::string_view text) {
    try {
        MachineFacts facts;
        facts.laser_mode = true;
        facts.s_max = 1000.0;
        facts.travel_mm = {600.0, 400.0};
        facts.origin_in_travel_mm = {0.0, 0.0};
        preflight(read_program(text), facts);
    } catch (const Refused&) {
        return;
    }
}

void read_for_board(std::string_view text) {
    const EncoderOptions options;
    std::string egv;
    try {
        egv = convert_to_egv(text, options);
    } catch (const ProgramRefused&) {
        return;
    }
    // Ours is always readable.
    for (const CutMove& move : read_program_moves(egv, options)) {
        require(std::isfinite(move.x_mm) && std::isfinite(move.y_mm));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    split_words(strip_gcode(text));
    read_for_grbl(text);
    read_for_board(text);
    return 0;
}
