// What a Lihuiyu board makes of LHYMICRO-GL, byte by byte. Knows nothing of the encoder, so that it
// can judge it; stricter than the board: what a careful program would never send is reported.
//
//   I                forget everything, be ready for a program
//   [C] V digits [C] speed (C: cutting; without: raster, see speed_code.h)
//   B T R L          right, left, away from the home corner, back to it; M: both axes at once, each
//                    in the last direction it had
//   a..y  z  |a..|z  1..25, 255, 26..51 steps; or three digits. They add up, and are made when the
//                    next letter comes, with the beam as it was before that letter.
//   D U              beam on, off
//   N                beam off, rapid: the steps collected outside a cut (or between N and S) are
//                    made as fast as the machine can
//   N R B S1E        begin to cut; the last letter of the two directions is the main axis
//   @NSE, FNSE       end this section, end the program
//   …S1P IS2P IPP    collected steps at once; let the rails go; home
//
// Sources: the maker's LHYMicro-GL2 (2024-06-24); MeerK40t meerk40t/lihuiyu/parser.py; K40
// Whisperer egv.py. Facts, no code.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/lihuiyu/speed_code.h"

namespace leafcutter::drivers {

struct BoardAction {
    enum class Kind {
        Cut,    // A move at the section's speed, beam on or off.
        Rapid,  // A move at the board's own speed, beam off.
        Home,
        Finish,
        ReleaseRails,
        Violation
    };
    Kind kind = Kind::Cut;
    long dx = 0;  // Steps: right.
    long dy = 0;  // Steps: away from the home corner.
    bool beam = false;
    DecodedSpeed speed;
    std::string text;       // What is wrong, of a violation.
    bool forgiven = false;  // The board does the right thing all the same.
};

class LihuiyuInterpreter {
public:
    explicit LihuiyuInterpreter(const SpeedModel& model = {}) : model_(model) {}

    // Returns what this byte makes the machine do, in this order.
    std::vector<BoardAction> take(char byte);

    // As after an I that comes by itself.
    void reset();

    // The beam, should the machine stand and wait for the next byte.
    bool beam() const { return beam_; }
    bool cutting() const { return mode_ == Mode::Cutting; }

    // Inside a program that has not been finished.
    bool in_program() const { return mode_ == Mode::Setup || mode_ == Mode::Cutting; }

private:
    // Idle: power-up and after FNSE. Setup: between I, @NSE or N and S1E or SE.
    enum class Mode { Idle, Setup, Cutting };
    enum class Digits { Distance, Speed, Start, Ignored };

    void digit(char byte);
    void letter(char byte);
    void mode_letter(char byte);
    void distance_letter(char byte);
    void direction(char byte);
    void laser(bool on);
    void skip_blank();
    void execute();
    void begin_cutting();
    void press();
    void end_speed_code(char next);
    void collect(long steps);
    void make_steps();
    void complain(std::string text, bool forgiven = false);

    SpeedModel model_;
    std::vector<BoardAction> actions_;
    Mode mode_ = Mode::Idle;
    Digits digits_ = Digits::Distance;
    std::string number_;
    std::string speed_text_;
    bool reading_speed_ = false;
    DecodedSpeed speed_;
    bool speed_known_ = false;
    bool vector_ = false;  // C stood before V.
    bool bar_ = false;     // The last byte was |.
    bool beam_ = false;
    bool left_ = false;
    bool back_ = false;
    bool x_on_ = false;
    bool y_on_ = false;
    bool x_major_ = false;
    long pending_x_ = 0;
    long pending_y_ = 0;
    char start_ = 0;        // The digit after S; 0: S alone.
    bool started_ = false;  // An S came.
    int presses_ = 0;       // P after P: home.
    bool finishing_ = false;
    bool resetting_ = false;  // After @.
};

}  // namespace leafcutter::drivers
