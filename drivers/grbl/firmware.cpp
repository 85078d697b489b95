#include "drivers/grbl/firmware.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "drivers/grbl/protocol.h"

namespace leafcutter::drivers {

namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return result;
}

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

// From `at`, up to the first of the letters in `ends`.
std::string_view piece(std::string_view text, std::size_t at, std::string_view ends) {
    const std::size_t end = std::min(text.find_first_of(ends, at), text.size());
    return text.substr(at, end - at);
}

}  // namespace

void FirmwareSigns::take(std::string_view line) {
    const std::string small = lower(line);
    const std::size_t fluid = small.find("fluidnc");
    if (starts_with(small, "grbl")) {
        take_banner(line);
    } else if (starts_with(small, "[firmware:grblhal")) {
        kind_ = GrblFirmware::GrblHal;
    } else if (starts_with(small, "[opt:")) {
        take_options(line);
    } else if (starts_with(small, "[ver:") && fluid != std::string::npos) {
        kind_ = GrblFirmware::FluidNc;
        const std::size_t version = fluid + std::string_view("FluidNC ").size();
        name_ = "FluidNC " + std::string(piece(line, std::min(version, line.size()), " :]("));
    }
}

void FirmwareSigns::take_banner(std::string_view line) {
    *this = FirmwareSigns{};
    const std::string small = lower(line);
    name_ = std::string(line.substr(0, line.find(" [")));
    const std::size_t fluid = small.find("fluidnc");
    if (fluid != std::string::npos) {
        kind_ = GrblFirmware::FluidNc;
        const std::size_t version = fluid + std::string_view("FluidNC ").size();
        name_ = "FluidNC " + std::string(piece(line, std::min(version, line.size()), " ]("));
    } else if (starts_with(small, "grblhal")) {
        kind_ = GrblFirmware::GrblHal;
        name_ = "grblHAL " + std::string(piece(line, std::min<std::size_t>(8, line.size()), " ["));
    } else if (starts_with(small, "grbl 1.1")) {
        kind_ = GrblFirmware::Grbl;
    }
}

// "[OPT:VN,15,128]": letters, planner blocks, receive buffer. FluidNC states letters alone.
void FirmwareSigns::take_options(std::string_view line) {
    options_ = std::string(piece(line, 5, ",]"));
    const std::size_t first = line.find(',');
    const std::size_t second = first == std::string_view::npos ? first : line.find(',', first + 1);
    if (second != std::string_view::npos) {
        std::from_chars(line.data() + first + 1, line.data() + second, stated_blocks_);
        std::from_chars(line.data() + second + 1, line.data() + line.size(), stated_rx_);
    }
}

std::size_t FirmwareSigns::receive_budget() const {
    constexpr std::size_t kSafe = GrblProtocol::kSafeRxBytes;
    // One byte of a ring is never used, and grblHAL states the whole ring.
    std::size_t unused = kind_ == GrblFirmware::GrblHal ? 2 : 1;
    // A link that is no UART (a network's, grblHAL's simulator's) stops reading when the buffer is
    // nearly full: a hold or a '?' would be stuck behind what it doesn't read.
    constexpr std::size_t kLarge = 512;
    constexpr std::size_t kKeptFree = 128;
    unused += stated_rx_ >= kLarge ? kKeptFree : 0;
    constexpr std::size_t kMostBelieved = 65536;
    const bool believed = stated_rx_ > kSafe + unused && stated_rx_ <= kMostBelieved;
    return believed ? stated_rx_ - unused : kSafe;
}

std::size_t FirmwareSigns::longest_line() const {
    constexpr std::size_t kGrblHal = 254;
    constexpr std::size_t kFluidNc = 253;
    const std::size_t own = kind_ == GrblFirmware::GrblHal   ? kGrblHal
                            : kind_ == GrblFirmware::FluidNc ? kFluidNc
                                                             : GrblProtocol::kMaxLine;
    return std::min(own, receive_budget() - 1);
}

}  // namespace leafcutter::drivers
