// A simulated Lihuiyu board with its laser. Pure: wire bytes in, wire bytes out, time only as it is
// told. The wire format is that of lihuiyu/packet.h.
//
// Stricter than the board: what a careful program would never send is kept as a violation (unknown
// bytes, leaving the bed, a beam that is lit while the head stands or at a rapid move, packets
// while the board is busy or homing, a program that never ends). It powers up with the head
// somewhere, so that whoever doesn't home burns in the wrong place. What the real board does with a
// lit beam when its data run out is not known; this one lets it burn.

#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/lihuiyu/encoder.h"
#include "drivers/lihuiyu/interpreter.h"
#include "drivers/lihuiyu/packet.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct LihuiyuFault {
    enum class Kind {
        Crc,        // Packet `at` is found bad, once.
        CrcAlways,  // Every packet from `at` on is found bad.
        Busy,       // The board says busy for 30 s after packet `at`.
        Stall,      // It says so for ever.
        Mute,       // It doesn't answer any more.
        Power,      // It says that it has no power.
        Lose,   // Packet `at` vanishes without a trace. Nobody can notice: the board never counts.
        Unplug  // The link is gone.
    };
    Kind kind = Kind::Crc;
    std::size_t at = 1;  // Counts packets received since power-up, from 1.
};

// Reads "crc:12", "crc-always:N", "busy:N", "stall:N", "mute:N", "power:N", "lose:N", "unplug:N".
// Throws std::invalid_argument.
LihuiyuFault parse_lihuiyu_fault(std::string_view text);

struct LihuiyuMachineOptions {
    LihuiyuBed bed;  // Beam log in program coordinates of it.
    SpeedModel speed;
    double rapid_mm_per_s = 80.0;
    double home_mm_per_s = 68.0;
    std::size_t packets_held = 4;  // The board is busy while it holds so many.
    bool busy_while_homing = true;
    std::optional<LihuiyuFault> fault;
};

class LihuiyuMachine final : public SimMachine {
public:
    explicit LihuiyuMachine(const LihuiyuMachineOptions& options = {});

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;

    // A tenth of a second, or more as long as it is busy with data, 2 s at most: for a sender that
    // isn't to wait.
    std::string hurry() override;

    void power_cycle() override;
    bool waits_for_questions() const override { return true; }
    bool at_rest() const override;
    bool unplugged() const override { return unplugged_; }
    double beam_power() const override { return beam_on() ? 1.0 : 0.0; }
    double now_s() const override { return now_s_; }
    const BeamLog& beam_log() const override { return log_; }
    BeamLog& beam_log() override { return log_; }
    std::vector<Violation> take_violations() override;

    bool beam_on() const;
    bool paused() const { return paused_; }
    PlaceMm position_mm() const;  // In program coordinates.
    std::size_t packets() const { return packets_; }
    std::size_t programs_finished() const { return programs_finished_; }
    const std::vector<Violation>& violations() const { return violations_; }

private:
    struct Motion {
        BoardAction action;
        StepPlace from;
        StepPlace to;
        double seconds = 0.0;
        double done_s = 0.0;
        StepPlace logged;  // Up to where, and when, it is in the beam log.
        double logged_s = 0.0;
    };

    void receive(char byte);
    void take_packet(std::string_view payload, unsigned char crc);
    bool take_realtime(std::string_view payload);
    bool disturb();
    std::uint8_t status() const;
    bool busy() const;
    bool homing() const;
    void stop();
    void perform(BoardAction action);
    void begin_motion(const BoardAction& action, const StepPlace& to, double seconds);
    void move_for(double seconds);
    void stand_for(double seconds);
    bool fetch();
    StepPlace place_in_motion() const;
    void log_burn();
    void violate(std::string text);

    LihuiyuMachineOptions options_;
    LihuiyuInterpreter interpreter_;
    BeamLog log_;
    std::vector<Violation> violations_;
    std::size_t violations_told_ = 0;

    std::string wire_;  // Of a packet not yet whole.
    std::string out_;
    std::deque<char> queue_;
    std::optional<Motion> motion_;
    std::deque<BoardAction> actions_;
    StepPlace at_;

    double now_s_ = 0.0;
    double finished_until_s_ = -1.0;
    double busy_until_s_ = -1.0;
    bool last_was_bad_ = false;
    bool paused_ = false;
    bool standing_lit_ = false;
    bool mute_ = false;
    bool no_power_ = false;
    bool unplugged_ = false;
    std::size_t packets_ = 0;
    std::size_t programs_finished_ = 0;
};

}  // namespace leafcutter::drivers
