// Cards that are cut before the real thing: how wide the beam is in a material, and which power and
// speed cut, score or engrave it well.

#pragma once

#include <array>
#include <string>
#include <variant>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

// A window parted into cells by plain lines, without any kerf counted. Pushed to its left end, the
// cells leave a gap there of so many kerfs that a ruler under it shows the kerf itself.
struct KerfCard {
    int cells = 10;
    double cell_mm = 20.0;  // Width and height of each.
    double largest_kerf_mm = 0.5;
};

// A cell for every pair: power grows to the right, feed upwards.
struct PowerCard {
    Operation operation = Operation::Cut;
    std::array<double, 2> power_percent{20.0, 100.0};
    std::array<double, 2> feed_mm_per_min{300.0, 3000.0};
    int powers = 5;
    int feeds = 5;
    int passes = 1;
    double cell_mm = 8.0;
};

using TestCard = std::variant<KerfCard, PowerCard>;

// The program of a card whose lower left corner is the sheet's origin; its size is as small as can
// be. Labels are engraved as the material is.
//
// Throws geometry::Error(BadOption) if no sheet of the material is large enough.
CutProgram plan_test_card(const TestCard& card,
                          const Material& material,
                          const MachineProfile& machine);

// What to look for on it, for people.
std::string reading_of(const TestCard& card);

}  // namespace leafcutter::fab
