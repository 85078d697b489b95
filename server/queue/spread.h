// A job's sheets over several machines: each where it fits, so that the last one is done soonest.

#pragma once

#include <array>
#include <string>
#include <vector>

#include "server/store/cut_store.h"

namespace leafcutter::server {

struct CutPlace {
    std::string device;
    std::array<double, 2> bed_mm{};
    double busy_s = 0.0;  // With what is in its queue.
};

// The longest sheets first, each to the machine that is free first among those that it fits; sheets
// of unknown size fit everywhere. Machines that get none are left out. Throws NotCuttable for a
// sheet that fits nowhere.
std::vector<CutWish> spread_sheets(std::vector<SheetRecord> sheets, std::vector<CutPlace> places);

}  // namespace leafcutter::server
