// Fills packets with a program, so that each leaves the beam off.
//
// Every packet that burns begins by lighting the beam (D) and ends by putting it out (U): whatever
// becomes of the host between two packets, the board waits for the next one in the dark. Nobody but
// the maker knows what a board does with a lit beam when its data run out; it does fire while
// standing ("IDS1P" is used for that), so nothing is left to it. For the same reason a packet burns
// for no longer than `longest_burn_s`. Packets are full to the last byte, with U, so that the
// stream stays right if some other program cuts it into packets again.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/lihuiyu/packet.h"
#include "drivers/lihuiyu/runs.h"

namespace leafcutter::drivers {

struct JobPacket {
    Payload payload{};
    double seconds = 0.0;  // What its runs take.
    StepPlace end;         // Where they end.
};

struct EncodedJob {
    std::vector<JobPacket> packets;
    double seconds = 0.0;
    double burn_mm = 0.0;

    // All payloads in a row.
    std::string stream() const;
};

class Packer {
public:
    explicit Packer(double longest_burn_s) : longest_burn_s_(longest_burn_s) {}

    // Bytes with the beam off, which may be split between packets anywhere.
    void dark(std::string_view bytes);

    // One run with the beam on, of at most kPayloadBytes - 2 bytes.
    void lit(std::string_view token, double seconds);

    // How long the steps written last take, and where they end.
    void passed(double seconds, const StepPlace& end);

    // Ends the program and returns it.
    EncodedJob finish();

private:
    void put_out();
    void close();
    void flush();

    double longest_burn_s_;
    EncodedJob job_;
    std::string fill_;
    bool lit_ = false;
    double burn_s_ = 0.0;  // In this packet.
    double seconds_ = 0.0;
    StepPlace place_;
};

}  // namespace leafcutter::drivers
