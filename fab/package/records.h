// Parts of package files that others write, too, as JSON.

#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "fab/job_result.h"

namespace leafcutter::fab {

// Everything of a material; what it doesn't have is left out.
nlohmann::ordered_json material_record(const Material& material);

// As nesting.stock takes it.
nlohmann::ordered_json stock_record(const StockItem& item);

nlohmann::ordered_json bill_record(const Bill& bill);

nlohmann::ordered_json machine_record(const MachineProfile& machine, Dialect dialect);

nlohmann::ordered_json input_record(const InputFacts& input);
nlohmann::ordered_json nesting_record(const Layout& layout);
nlohmann::ordered_json cut_record(const JobResult& job);

// Floats by number; how many moves lay, thread and join.
nlohmann::ordered_json floats_record(const Floats& floats);
nlohmann::ordered_json assembly_record(const Assembly& assembly);

// What cutting pieces of this job again needs to know: bill, materials, machine, parameters.
void add_makings(const JobResult& job, nlohmann::ordered_json& file);

// Throws geometry::Error(SelfCheck) naming a number that is not finite: JSON would hide it as null.
std::string report_text(const nlohmann::ordered_json& report);

}  // namespace leafcutter::fab
