#include "drivers/sim/lihuiyu_machine.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kFinishedPulseS = 0.39;
constexpr double kBusyFaultS = 30.0;
constexpr double kNominalStepMm = 0.0254;  // What speed codes take a step for.
constexpr StepPlace kPowerUpPlace{4000, 3000};

using Kind = LihuiyuFault::Kind;
constexpr std::array<std::pair<std::string_view, Kind>, 8> kFaults{{
    {"crc", Kind::Crc},
    {"crc-always", Kind::CrcAlways},
    {"busy", Kind::Busy},
    {"stall", Kind::Stall},
    {"mute", Kind::Mute},
    {"power", Kind::Power},
    {"lose", Kind::Lose},
    {"unplug", Kind::Unplug},
}};

bool is_padding(std::string_view text) {
    return text.find_first_not_of('F') == std::string_view::npos;
}

}  // namespace

LihuiyuFault parse_lihuiyu_fault(std::string_view text) {
    const std::size_t colon = text.find(':');
    for (const auto& [name, kind] : kFaults) {
        if (text.substr(0, colon) != name || colon == std::string_view::npos) {
            continue;
        }
        LihuiyuFault fault{kind, 0};
        const char* const last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data() + colon + 1, last, fault.at);
        if (error == std::errc{} && end == last && fault.at > 0) {
            return fault;
        }
    }
    throw std::invalid_argument(fmt::format(
        "fault \"{}\": must be crc:N, crc-always:N, busy:N, stall:N, mute:N, power:N, lose:N or "
        "unplug:N with N > 0",
        text));
}

LihuiyuMachine::LihuiyuMachine(const LihuiyuMachineOptions& options)
    : options_(options), interpreter_(options.speed), at_(kPowerUpPlace) {}

// ---- The wire ----

std::string LihuiyuMachine::feed(std::string_view bytes) {
    for (const char byte : bytes) {
        if (!unplugged_) {
            receive(byte);
        }
    }
    return mute_ || unplugged_ ? std::string() : std::exchange(out_, {});
}

void LihuiyuMachine::receive(char byte) {
    if (wire_.empty() && byte == kAskStatus) {
        out_ += '\xFF';
        out_ += static_cast<char>(status());
        out_ += std::string("\x6F\x08\x13\0", 4);
        return;
    }
    const bool begins_group = wire_.empty() || wire_.size() == kFirstTransferBytes;
    if (begins_group && byte != kWriteData) {
        violate(fmt::format("byte {} where a transfer begins", static_cast<unsigned char>(byte)));
        wire_.clear();
        return;
    }
    wire_ += byte;
    if (wire_.size() == kWirePacketBytes) {
        const std::string packet = std::exchange(wire_, {});
        if (packet[1] != 0) {
            violate("a packet doesn't begin with 0");
        }
        take_packet(std::string_view(packet).substr(2, kPayloadBytes),
                    static_cast<unsigned char>(packet.back()));
    }
}

std::uint8_t LihuiyuMachine::status() const {
    const auto said = [](BoardStatus status) { return static_cast<std::uint8_t>(status); };
    if (no_power_) {
        return said(BoardStatus::Power);
    }
    if (now_s_ < finished_until_s_) {
        return said(BoardStatus::Finished);
    }
    if (busy()) {
        return said(BoardStatus::Busy);
    }
    return said(last_was_bad_ ? BoardStatus::CrcError : BoardStatus::Ok);
}

bool LihuiyuMachine::homing() const {
    return motion_ && motion_->action.kind == BoardAction::Kind::Home;
}

bool LihuiyuMachine::busy() const {
    return queue_.size() >= options_.packets_held * kPayloadBytes || now_s_ < busy_until_s_ ||
           (homing() && options_.busy_while_homing);
}

// Returns whether a fault has swallowed the packet.
bool LihuiyuMachine::disturb() {
    if (!options_.fault || packets_ < options_.fault->at) {
        return false;
    }
    const Kind kind = options_.fault->kind;
    if (kind != Kind::CrcAlways) {
        options_.fault.reset();
    }
    switch (kind) {
        case Kind::Crc:
        case Kind::CrcAlways:
            last_was_bad_ = true;
            return true;
        case Kind::Busy:
            busy_until_s_ = now_s_ + kBusyFaultS;
            return false;
        case Kind::Stall:
            busy_until_s_ = kForever;
            return false;
        case Kind::Mute:
            mute_ = true;
            return false;
        case Kind::Power:
            no_power_ = true;
            return false;
        case Kind::Lose:
            return true;
        case Kind::Unplug:
            unplugged_ = true;
            return false;
    }
    return false;
}

void LihuiyuMachine::take_packet(std::string_view payload, unsigned char crc) {
    ++packets_;
    last_was_bad_ = false;
    if (crc != crc8(payload)) {
        last_was_bad_ = true;
        return;
    }
    const bool was_busy = busy();
    if (disturb() || take_realtime(payload)) {
        return;
    }
    if (was_busy) {
        violate("a packet while the board is busy");
        return;
    }
    if (homing()) {
        violate("a packet while the machine homes");
    }
    queue_.insert(queue_.end(), payload.begin(), payload.end());
}

// Packets that take effect at once, before all that the board still holds.
bool LihuiyuMachine::take_realtime(std::string_view payload) {
    const bool running = motion_ || !queue_.empty() || interpreter_.in_program();
    if (payload[0] == 'I' && is_padding(payload.substr(1))) {
        if (running) {
            stop();
        }
        interpreter_.reset();
        return true;
    }
    if (payload.substr(0, 2) == "PN" && is_padding(payload.substr(2)) && running) {
        log_burn();
        paused_ = !paused_;
        return true;
    }
    return false;
}

// The head stays where it is, and nobody knows where that is.
void LihuiyuMachine::power_cycle() {
    stop();
    interpreter_.reset();
    wire_.clear();
    out_.clear();
    last_was_bad_ = false;
    finished_until_s_ = busy_until_s_ = now_s_;
}

void LihuiyuMachine::stop() {
    if (motion_) {
        log_burn();
        at_ = place_in_motion();
        motion_.reset();
    }
    queue_.clear();
    actions_.clear();
    paused_ = standing_lit_ = false;
    if (busy_until_s_ != kForever) {
        busy_until_s_ = now_s_;
    }
}

// ---- Motion ----

std::string LihuiyuMachine::advance(double seconds) {
    const double end = now_s_ + seconds;
    while (now_s_ < end) {
        if (paused_) {
            now_s_ = end;
        } else if (motion_) {
            move_for(end - now_s_);
        } else if (!fetch()) {
            stand_for(end - now_s_);
        }
    }
    return {};  // It speaks when asked.
}

std::string LihuiyuMachine::hurry() {
    constexpr double kTurnS = 0.1;
    constexpr int kMostTurns = 20;
    int turns = 0;
    do {
        advance(kTurnS);
    } while (busy() && !homing() && !paused_ && ++turns < kMostTurns);
    return {};
}

bool LihuiyuMachine::at_rest() const {
    return (!motion_ && queue_.empty() && actions_.empty()) || paused_;
}

std::vector<Violation> LihuiyuMachine::take_violations() {
    const auto first = violations_.begin() + static_cast<std::ptrdiff_t>(violations_told_);
    violations_told_ = violations_.size();
    return {first, violations_.end()};
}

bool LihuiyuMachine::beam_on() const {
    if (paused_) {
        return false;
    }
    return motion_ ? motion_->action.beam : standing_lit_;
}

PlaceMm LihuiyuMachine::position_mm() const {
    return to_program_mm(options_.bed, motion_ ? place_in_motion() : at_);
}

// Takes the next thing to do from the data; false if there is none.
bool LihuiyuMachine::fetch() {
    while (actions_.empty() && !queue_.empty()) {
        const char byte = queue_.front();
        queue_.pop_front();
        for (BoardAction& action : interpreter_.take(byte)) {
            actions_.push_back(std::move(action));
        }
    }
    if (actions_.empty()) {
        return false;
    }
    standing_lit_ = false;
    BoardAction action = std::move(actions_.front());
    actions_.pop_front();
    perform(std::move(action));
    return true;
}

void LihuiyuMachine::perform(BoardAction action) {
    const double steps_per_mm = options_.bed.steps_per_mm;
    const StepPlace to{at_.x + action.dx, at_.y + action.dy};
    const double way = static_cast<double>(std::max(std::labs(action.dx), std::labs(action.dy)));
    switch (action.kind) {
        case BoardAction::Kind::Violation:
            violate(std::move(action.text));
            break;
        case BoardAction::Kind::Finish:
            finished_until_s_ = now_s_ + kFinishedPulseS;
            ++programs_finished_;
            break;
        case BoardAction::Kind::ReleaseRails:
            break;
        case BoardAction::Kind::Home: {
            const double far = static_cast<double>(std::max(at_.x, at_.y)) / steps_per_mm;
            begin_motion(action, {}, 0.1 + far / options_.home_mm_per_s);
            break;
        }
        case BoardAction::Kind::Rapid:
            begin_motion(action, to, way / steps_per_mm / options_.rapid_mm_per_s);
            break;
        case BoardAction::Kind::Cut: {
            const bool diagonal = action.dx != 0 && action.dy != 0;
            const double slower = diagonal && action.speed.slows_diagonals ? std::sqrt(2.0) : 1.0;
            const double speed = std::max(action.speed.mm_per_s, 1e-3);
            begin_motion(action, to, way * kNominalStepMm / speed * slower);
            break;
        }
    }
}

void LihuiyuMachine::begin_motion(const BoardAction& action, const StepPlace& to, double seconds) {
    const LihuiyuBed& bed = options_.bed;
    const StepPlace corner{std::lround(bed.width_mm * bed.steps_per_mm),
                           std::lround(bed.height_mm * bed.steps_per_mm)};
    const StepPlace inside{std::clamp(to.x, 0L, corner.x), std::clamp(to.y, 0L, corner.y)};
    if (!(inside == to)) {
        violate("the head runs against the end of the bed");
    }
    motion_ = Motion{action, at_, inside, seconds, 0.0, at_, now_s_};
}

StepPlace LihuiyuMachine::place_in_motion() const {
    const double part = motion_->seconds > 0.0 ? motion_->done_s / motion_->seconds : 1.0;
    const auto between = [part](long from, long to) {
        return from + std::lround(part * static_cast<double>(to - from));
    };
    return {between(motion_->from.x, motion_->to.x), between(motion_->from.y, motion_->to.y)};
}

void LihuiyuMachine::move_for(double seconds) {
    const double left = motion_->seconds - motion_->done_s;
    const double step = std::min(seconds, left);
    now_s_ += step;
    motion_->done_s += step;
    if (step >= left) {
        motion_->done_s = motion_->seconds;
        log_burn();
        at_ = motion_->to;
        motion_.reset();
    }
}

// What the motion in progress has burnt since this was called last.
void LihuiyuMachine::log_burn() {
    if (!motion_) {
        return;
    }
    const StepPlace place = place_in_motion();
    if (motion_->action.beam && !paused_ && now_s_ > motion_->logged_s) {
        const PlaceMm a = to_program_mm(options_.bed, motion_->logged);
        const PlaceMm b = to_program_mm(options_.bed, place);
        const double feed_mm_per_min = motion_->action.speed.mm_per_s * 60.0;
        log_.add(
            {motion_->logged_s, now_s_, a.x_mm, a.y_mm, b.x_mm, b.y_mm, 1.0, 1.0, feed_mm_per_min});
    }
    motion_->logged = place;
    motion_->logged_s = now_s_;
}

// The head waits for data; a beam that the data left on burns on.
void LihuiyuMachine::stand_for(double seconds) {
    const bool lit = interpreter_.beam() && interpreter_.cutting();
    if (lit && !standing_lit_) {
        violate("the beam is lit while the head stands and waits for data");
    }
    standing_lit_ = lit;
    now_s_ += seconds;
    if (lit) {
        const PlaceMm place = to_program_mm(options_.bed, at_);
        log_.add({now_s_ - seconds, now_s_, place.x_mm, place.y_mm, place.x_mm, place.y_mm, 1.0,
                  1.0, 0.0});
    }
}

void LihuiyuMachine::violate(std::string text) {
    violations_.push_back({now_s_, std::move(text)});
}

}  // namespace leafcutter::drivers
