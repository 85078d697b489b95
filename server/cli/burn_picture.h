// Pictures of burns as files.

#pragma once

#include <span>
#include <string>

#include "drivers/sim/beam_log.h"

namespace leafcutter::server {

// Throws UsageError for an ending other than .svg and .png.
void check_picture_path(const std::string& path);

// By the ending. Throws UsageError, std::runtime_error for a file that can't be written.
void write_burn_picture(const std::string& path, std::span<const drivers::BurntPiece> pieces);

}  // namespace leafcutter::server
