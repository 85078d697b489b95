#include "drivers/lihuiyu/interpreter.h"

#include <cstdlib>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr long kZ = 255;
constexpr long kBar = 25;
constexpr long kBarZ = 26;

bool is_digit(char byte) {
    return byte >= '0' && byte <= '9';
}

bool is_distance(char byte) {
    return byte == '|' || (byte >= 'a' && byte <= 'z');
}

std::string shown(char byte) {
    const bool plain = byte > ' ' && byte <= '~';
    return plain ? fmt::format("'{}'", byte)
                 : fmt::format("byte {}", static_cast<unsigned>(static_cast<unsigned char>(byte)));
}

}  // namespace

std::vector<BoardAction> LihuiyuInterpreter::take(char byte) {
    actions_.clear();
    if (is_digit(byte)) {
        digit(byte);
        return std::move(actions_);
    }
    if (reading_speed_) {
        end_speed_code(byte);
        if (byte == 'C') {
            return std::move(actions_);
        }
    }
    if (!number_.empty()) {
        complain("a distance of less than three digits");
        number_.clear();
    }
    digits_ = Digits::Distance;
    if (is_distance(byte)) {
        distance_letter(byte);
        return std::move(actions_);
    }
    if (bar_) {
        complain("| without a letter after it");
        bar_ = false;
    }
    letter(byte);
    return std::move(actions_);
}

void LihuiyuInterpreter::reset() {
    const SpeedModel model = model_;
    *this = LihuiyuInterpreter(model);
}

void LihuiyuInterpreter::complain(std::string text, bool forgiven) {
    BoardAction action;
    action.kind = BoardAction::Kind::Violation;
    action.text = std::move(text);
    action.forgiven = forgiven;
    actions_.push_back(std::move(action));
}

void LihuiyuInterpreter::digit(char byte) {
    switch (digits_) {
        case Digits::Speed:
            speed_text_ += byte;
            return;
        case Digits::Start:
            start_ = byte;
            digits_ = Digits::Ignored;
            return;
        case Digits::Ignored:
            return;
        case Digits::Distance:
            break;
    }
    number_ += byte;
    if (number_.size() == 3) {
        const long steps = std::strtol(number_.c_str(), nullptr, 10);
        number_.clear();
        if (steps > kZ) {
            complain(fmt::format("the distance {} is above 255", steps));
        }
        collect(steps);
    }
}

void LihuiyuInterpreter::distance_letter(char byte) {
    const bool after_bar = bar_;
    bar_ = byte == '|';
    if (byte == '|') {
        collect(kBar);
    } else if (byte == 'z') {
        collect(after_bar ? kBarZ : kZ);
    } else {
        collect(byte - 'a' + 1);
    }
}

void LihuiyuInterpreter::collect(long steps) {
    if (mode_ == Mode::Idle) {
        complain("a distance outside a program");
        return;
    }
    if (!x_on_ && !y_on_) {
        complain("a distance without a direction");
    }
    pending_x_ += x_on_ ? steps : 0;
    pending_y_ += y_on_ ? steps : 0;
}

void LihuiyuInterpreter::make_steps() {
    if (pending_x_ == 0 && pending_y_ == 0) {
        return;
    }
    BoardAction action;
    action.kind = mode_ == Mode::Cutting ? BoardAction::Kind::Cut : BoardAction::Kind::Rapid;
    action.dx = left_ ? -pending_x_ : pending_x_;
    action.dy = back_ ? -pending_y_ : pending_y_;
    action.beam = mode_ == Mode::Cutting && beam_;
    action.speed = speed_;
    pending_x_ = pending_y_ = 0;
    actions_.push_back(std::move(action));
}

void LihuiyuInterpreter::letter(char byte) {
    if (byte == 'I') {
        const bool interrupted = mode_ == Mode::Cutting;
        reset();
        mode_ = Mode::Setup;
        if (interrupted) {
            complain("I in the middle of a cut");
        }
        return;
    }
    if (mode_ == Mode::Idle) {
        if (byte != 'F') {
            complain(shown(byte) + " outside a program");
        }
        return;
    }
    if (mode_ == Mode::Cutting) {
        make_steps();
    }
    if (byte != 'P') {
        presses_ = 0;
    }
    switch (byte) {
        case 'B':
        case 'T':
        case 'R':
        case 'L':
        case 'M':
            direction(byte);
            break;
        case 'D':
        case 'U':
            laser(byte == 'D');
            break;
        case 'C':
            vector_ = true;
            break;
        case 'V':
            speed_text_.assign(1, 'V');
            reading_speed_ = true;
            digits_ = Digits::Speed;
            break;
        case 'G':
            complain("raster steps (G) are not for cutting");
            digits_ = Digits::Ignored;
            break;
        case 'W':
            digits_ = Digits::Ignored;  // Power, of new M3 boards alone.
            break;
        default:
            mode_letter(byte);
    }
}

void LihuiyuInterpreter::mode_letter(char byte) {
    switch (byte) {
        case 'N':
            skip_blank();
            break;
        case 'S':
            make_steps();
            started_ = true;
            start_ = 0;
            digits_ = Digits::Start;
            break;
        case 'E':
            execute();
            break;
        case 'P':
            press();
            break;
        case 'F':
            finishing_ = true;
            break;
        case '@':
            resetting_ = true;
            finishing_ = false;
            break;
        default:
            complain(shown(byte) + " is no LHYMICRO-GL");
    }
}

void LihuiyuInterpreter::end_speed_code(char next) {
    reading_speed_ = false;
    const auto decoded = decode_speed(model_, speed_text_ + (next == 'C' ? "C" : ""));
    if (!decoded) {
        complain(fmt::format("\"{}\" is no speed code of board {}", speed_text_,
                             to_string(model_.board)));
    }
    if (!vector_) {
        complain("a speed code without C is for raster");
    }
    vector_ = false;
    speed_ = decoded.value_or(DecodedSpeed{});
    speed_known_ = decoded.has_value();
}

void LihuiyuInterpreter::direction(char byte) {
    x_on_ = byte == 'B' || byte == 'T' || byte == 'M';
    y_on_ = byte == 'R' || byte == 'L' || byte == 'M';
    if (byte == 'B' || byte == 'T') {
        left_ = byte == 'T';
    }
    if (byte == 'R' || byte == 'L') {
        back_ = byte == 'L';
    }
}

void LihuiyuInterpreter::laser(bool on) {
    if (on && mode_ != Mode::Cutting) {
        complain("the beam is lit outside a cut");
    }
    beam_ = on;
}

// From a cut into a rapid move, or the end of one collected before.
void LihuiyuInterpreter::skip_blank() {
    if (beam_) {
        complain("the beam is still on where a rapid move begins", true);
    }
    beam_ = false;
    if (mode_ == Mode::Cutting) {
        mode_ = Mode::Setup;
        started_ = false;
        return;
    }
    make_steps();
}

void LihuiyuInterpreter::execute() {
    if (!started_) {
        complain("E without S");
        return;
    }
    started_ = false;
    if (start_ == '1') {
        begin_cutting();
    } else if (start_ != 0) {
        complain(fmt::format("S{}E is not for programs", start_));
    } else if (finishing_) {
        BoardAction action;
        action.kind = BoardAction::Kind::Finish;
        actions_.push_back(std::move(action));
        mode_ = Mode::Idle;
    } else {
        // Back from a rapid move, with the main axis reversed; or ready for a new section.
        mode_ = resetting_ ? Mode::Setup : Mode::Cutting;
        (x_major_ ? left_ : back_) = !(x_major_ ? left_ : back_);
        x_on_ = x_major_;
        y_on_ = !x_major_;
    }
    finishing_ = resetting_ = false;
}

void LihuiyuInterpreter::begin_cutting() {
    if (!speed_known_) {
        complain("a cut begins without a speed");
    }
    if (finishing_) {
        complain("a cut begins after F");
    }
    beam_ = false;
    mode_ = Mode::Cutting;
    x_major_ = x_on_;
}

void LihuiyuInterpreter::press() {
    beam_ = false;
    if (started_) {
        started_ = false;
        if (start_ == '2') {
            BoardAction action;
            action.kind = BoardAction::Kind::ReleaseRails;
            actions_.push_back(std::move(action));
        }
        mode_ = Mode::Idle;
        return;
    }
    if (++presses_ == 2) {
        BoardAction action;
        action.kind = BoardAction::Kind::Home;
        actions_.push_back(std::move(action));
        mode_ = Mode::Idle;
    }
}

}  // namespace leafcutter::drivers
