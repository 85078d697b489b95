// The line protocol of Marlin, and of Smoothieware, which speaks the same: bytes in, events out.
//
// Every line gets a number and a checksum: "N12 G1X3*97", the exclusive or of all bytes before the
// '*'. The controller answers "ok", or "Error:…" and "Resend: 12" ("rs N12" from Smoothieware) and
// forgets what it holds behind: the sender goes back to that line (Marlin 2.0 src/gcode/queue.cpp,
// Smoothieware GcodeDispatch.cpp). That makes it the one link here on which a disturbed byte costs
// nothing but time.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::drivers {

struct MarlinEvent {
    enum class Kind {
        Ack,
        Resend,      // From line `number` on.
        Error,       // What was wrong; a Resend follows where that helps.
        Unknown,     // It doesn't know the command, and did nothing.
        Halted,      // Killed: answers nothing but a reset (Marlin) or M999 (Smoothieware).
        Busy,        // Works on a line that takes long.
        Restart,     // Power was gone or a reset came.
        Waiting,     // It has nothing to do.
        Foreign,     // The greeting of a Grbl.
        Position,    // Answer to M114.
        Status,      // Smoothieware's answer to '?'.
        Firmware,    // FIRMWARE_NAME:…
        Capability,  // Cap:NAME:1
        Other
    };
    Kind kind = Kind::Other;
    std::size_t number = 0;
    std::string text;  // The whole line, without its line end.
};

class MarlinProtocol {
public:
    // MAX_CMD_SIZE with number and checksum; Smoothieware takes more.
    static constexpr std::size_t kMaxLine = 95;

    // Takes any split of the incoming stream and returns the lines completed by it. Endless lines
    // are cut at 512 bytes.
    std::vector<MarlinEvent> receive(std::string_view bytes);

private:
    std::string partial_;
};

// The line as it is sent: number, checksum, line end. Throws std::invalid_argument for a line that
// could never be taken: too long, or holding '*', a line end or a byte outside of ASCII.
std::string numbered_line(std::size_t number, std::string_view line);

// X and Y of an answer to M114: "X:10.00 Y:20.00 Z:0.00 E:0.00 Count X:800 …", or Smoothieware's
// "ok C: X:10.0 …".
struct MarlinPosition {
    double x_mm = 0.0;
    double y_mm = 0.0;
    double z_mm = 0.0;
};
std::optional<MarlinPosition> parse_position(std::string_view text);

// X and Y of "x:0.0000,y:-2.0000,…".
std::optional<std::array<double, 2>> parse_corner(std::string_view text);

}  // namespace leafcutter::drivers
