// Overrides, and the $ settings of a controller.

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "drivers/grbl/firmware_tables.h"
#include "drivers/grbl/session.h"

namespace leafcutter::drivers {

void GrblSession::set_overrides(const std::array<int, 3>& percent) {
    if (phase_ != Phase::Ready) {
        throw Refused("overrides: the machine has not answered yet");
    }
    constexpr int kLeast = 10;
    constexpr int kMost = 200;
    std::array<int, 3> wanted = percent;
    wanted[0] = std::clamp(wanted[0], kLeast, kMost);
    wanted[1] = wanted[1] > 75 ? 100 : (wanted[1] > 37 ? 50 : 25);  // Grbl has these three.
    wanted[2] = std::clamp(wanted[2], kLeast, kMost);
    if (wanted[2] > 100 && options_.power_cap_percent < 100.0) {
        throw Refused("overrides: no power above 100 % on a device with a power_cap");
    }
    wanted_overrides_ = wanted;
    step_overrides();
}

namespace {

constexpr char byte_of(int code) {
    return static_cast<char>(code);
}

struct OverrideStep {
    char byte = 0;
    int reaches = 0;  // Percent
};

// What brings a percentage nearer; `first` resets it, then come +10, -10, +1, -1.
OverrideStep override_step(int now, int wanted, int first) {
    const int difference = wanted - now;
    if (wanted == 100) {
        return {byte_of(first), 100};
    }
    if (difference >= 10 || difference <= -10) {
        return difference > 0 ? OverrideStep{byte_of(first + 1), now + 10}
                              : OverrideStep{byte_of(first + 2), now - 10};
    }
    return difference > 0 ? OverrideStep{byte_of(first + 3), now + 1}
                          : OverrideStep{byte_of(first + 4), now - 1};
}

}  // namespace

// One step of each at a time: the firmware drops repeats that come before it has served the first.
// The next follows when a report shows that it was served; one that was under way already doesn't.
void GrblSession::step_overrides() {
    if (!wanted_overrides_) {
        return;
    }
    const std::array<int, 3>& now = status_.override_percent;
    const std::array<int, 3> wanted = *wanted_overrides_;
    if (now == wanted) {
        wanted_overrides_.reset();
        return;
    }
    constexpr int kFeed = 0x90;
    constexpr int kRapid = 0x95;
    constexpr int kPower = 0x99;
    expected_overrides_ = wanted;
    const auto step = [&](std::size_t which, int first) {
        if (now.at(which) != wanted.at(which)) {
            const OverrideStep next = override_step(now.at(which), wanted.at(which), first);
            send_realtime(next.byte);
            expected_overrides_.at(which) = next.reaches;
        }
    };
    step(0, kFeed);
    step(2, kPower);
    if (now[1] != wanted[1]) {
        send_realtime(byte_of(kRapid + (wanted[1] == 100 ? 0 : (wanted[1] == 50 ? 1 : 2))));
    }
    overrides_stepped_ = now_;
    poll_soon();
}

namespace {

// What a setting may be without harm; those that aren't here are the controller's own affair.
struct SettingRange {
    int first;
    int last;
    double least;
    double most;
    bool whole;
};

constexpr double kMany = 1e6;
constexpr SettingRange kRanges[] = {
    {0, 0, 3, 255, true},           // Step pulse: a shorter one loses steps.
    {1, 6, 0, 255, true},           // Idle delay, masks
    {10, 10, 0, 4095, true},        // Report mask; grblHAL has more bits.
    {11, 12, 0, 10, false},         // mm
    {13, 13, 0, 1, true},           //
    {20, 23, 0, 255, true},         // Masks in grblHAL.
    {24, 25, 1, kMany, false},      // Homing feeds
    {26, 26, 0, 10000, true},       // ms
    {27, 27, 0, 1000, false},       // mm
    {30, 30, 1, kMany, false},      // S
    {31, 31, 0, kMany, false},      //
    {32, 32, 0, 2, true},           // grblHAL: 2 is a lathe.
    {100, 105, 0.1, kMany, false},  // Steps/mm
    {110, 115, 1, kMany, false},    // mm/min
    {120, 125, 0.1, kMany, false},  // mm/s2
    {130, 135, 0.1, kMany, false}   // mm
};

// The number of "$110" or "110".
std::optional<int> setting_number(std::string_view key) {
    key.remove_prefix(!key.empty() && key[0] == '$' ? 1 : 0);
    int number = 0;
    const auto [end, fault] = std::from_chars(key.data(), key.data() + key.size(), number);
    const bool read = fault == std::errc{} && end == key.data() + key.size();
    return read ? std::optional(number) : std::nullopt;
}

void check_setting(int number, double value) {
    const auto range = std::find_if(
        std::begin(kRanges), std::end(kRanges),
        [number](const SettingRange& each) { return number >= each.first && number <= each.last; });
    if (range == std::end(kRanges)) {
        return;
    }
    if (value < range->least || value > range->most ||
        (range->whole && value != std::trunc(value))) {
        throw Refused(fmt::format("setting ${}: must be a {}number from {} to {}", number,
                                  range->whole ? "whole " : "", range->least, range->most));
    }
}

}  // namespace

std::vector<MachineSetting> GrblSession::settings() const {
    std::vector<MachineSetting> result;
    for (const auto& [number, value] : settings_) {
        result.push_back({fmt::format("${}", number), value,
                          std::string(setting_name(firmware_.kind(), number))});
    }
    return result;
}

void GrblSession::set_setting(std::string_view key, double value) {
    require_ready("settings");
    if (status_.state != MachineState::Idle && status_.state != MachineState::Alarm) {
        throw Refused(
            fmt::format("settings: the machine is not idle ({})", to_string(status_.state)));
    }
    const std::optional<int> number = setting_number(key);
    if (!number || settings_.count(*number) == 0) {
        throw Refused(fmt::format("settings: the controller has no {}", key));
    }
    if (!std::isfinite(value) || std::abs(value) > kMany) {
        throw Refused(fmt::format("setting {}: must be a number up to {}", key, kMany));
    }
    check_setting(*number, value);
    std::string text = fmt::format("{:.3f}", value);  // As fine as Grbl keeps them.
    text.erase(text.find_last_not_of('0') + 1);
    text.erase(text.find_last_not_of('.') + 1);
    submit(fmt::format("${}={}", *number, text));
}

}  // namespace leafcutter::drivers
