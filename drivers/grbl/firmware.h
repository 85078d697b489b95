// Which firmware of the Grbl family a controller runs, by what it says of itself, and what follows
// from that for its sender.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

enum class GrblFirmware {
    Grbl,     // 1.1 on an ATmega, and what claims to be it.
    GrblHal,  // grblHAL
    FluidNc,  // FluidNC
    Other     // Grbl-like, of another version: trusted with nothing beyond the least.
};

// Collects what the banner and the answer to $I say.
class FirmwareSigns {
public:
    // One line from the controller; what is no sign is left alone.
    void take(std::string_view line);

    GrblFirmware kind() const { return kind_; }
    std::string name() const { return name_; }              // "Grbl 1.1h", "FluidNC v3.7.8"
    std::string build_options() const { return options_; }  // The letters of "[OPT:".

    // Blocks that its planner holds, as it states; 0: it states none.
    std::size_t planner_blocks() const { return stated_blocks_; }

    // Bytes that may be under way at a time: never more than the controller itself has stated,
    // and what every Grbl has where it states nothing.
    std::size_t receive_budget() const;

    // Characters of a line, without its end.
    std::size_t longest_line() const;

private:
    void take_banner(std::string_view line);
    void take_options(std::string_view line);

    GrblFirmware kind_ = GrblFirmware::Other;
    std::string name_;
    std::string options_;
    std::size_t stated_blocks_ = 0;
    std::size_t stated_rx_ = 0;
};

}  // namespace leafcutter::drivers
