// Parts of package files that others write, too, as JSON.

#pragma once

#include <nlohmann/json_fwd.hpp>

#include "fab/cut/cut_program.h"
#include "fab/material/bill.h"
#include "fab/material/material.h"

namespace leafcutter::fab {

// Everything of a material; what it doesn't have is left out.
nlohmann::ordered_json material_record(const Material& material);

nlohmann::ordered_json bill_record(const Bill& bill);

nlohmann::ordered_json machine_record(const MachineProfile& machine);

}  // namespace leafcutter::fab
