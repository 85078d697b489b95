// Nesting instances and layouts as JSON, in the form of the public collections: see `solve`.

#pragma once

#include <string>
#include <string_view>

#include "fab/nest/instance.h"

namespace leafcutter::fab {

// Throws Error(BadFile) if the text is no instance; the message names the place.
NestInstance read_instance(std::string_view text);

std::string write_solution(const NestInstance& instance, const InstanceSolution& solution);

// All layouts below each other.
std::string draw_solution(const NestInstance& instance, const InstanceSolution& solution);

}  // namespace leafcutter::fab
