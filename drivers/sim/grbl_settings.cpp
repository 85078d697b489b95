#include "drivers/sim/grbl_settings.h"

#include <cmath>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr int kNegativeValue = 4;
constexpr int kUnknownSetting = 3;
constexpr int kShortStepPulse = 6;
constexpr int kSoftLimitsNeedHoming = 10;

bool is_real(int number) {
    return number == 11 || number == 12 || number == 24 || number == 25 || number == 27 ||
           number >= 100;
}

bool is_power(int number) {
    return number == 30 || number == 31;
}

bool is_switch(int number) {
    return (number >= 4 && number <= 6) || number == 13 || (number >= 20 && number <= 22) ||
           number == 32;
}

// As it is kept: one byte, unless it is a real number.
double stored(int number, double value) {
    if (is_real(number) || is_power(number)) {
        return value;
    }
    const double whole = std::trunc(value);
    if (is_switch(number)) {
        return whole != 0.0 ? 1.0 : 0.0;
    }
    constexpr double kByte = 256.0;
    return std::fmod(whole, kByte);
}

}  // namespace

GrblSettings::GrblSettings()
    : values_{{0, 10},    {1, 25},     {2, 0},      {3, 0},      {4, 0},     {5, 0},
              {6, 0},     {10, 1},     {11, 0.010}, {12, 0.002}, {13, 0},    {20, 0},
              {21, 0},    {22, 0},     {23, 0},     {24, 25},    {25, 500},  {26, 250},
              {27, 1},    {30, 1000},  {31, 0},     {32, 1},     {100, 250}, {101, 250},
              {102, 250}, {110, 6000}, {111, 6000}, {112, 500},  {120, 500}, {121, 500},
              {122, 50},  {130, 600},  {131, 400},  {132, 50}} {}

double GrblSettings::get(int number) const {
    return values_.at(number);
}

int GrblSettings::set(int number, double value) {
    const auto found = values_.find(number);
    if (found == values_.end()) {
        return kUnknownSetting;
    }
    if (value < 0.0) {
        return kNegativeValue;
    }
    if (number == 0 && value < 3.0) {
        return kShortStepPulse;
    }
    if (number == 20 && value != 0.0 && !is_on(22)) {
        return kSoftLimitsNeedHoming;
    }
    found->second = stored(number, value);
    if (number == 22 && value == 0.0) {
        values_[20] = 0.0;
    }
    return 0;
}

std::array<double, 3> GrblSettings::axes(int first_number) const {
    return {get(first_number), get(first_number + 1), get(first_number + 2)};
}

std::string GrblSettings::dump() const {
    std::string text;
    for (const auto& [number, value] : values_) {
        text += is_real(number) ? fmt::format("${}={:.3f}\r\n", number, value)
                                : fmt::format("${}={:.0f}\r\n", number, value);
    }
    return text;
}

}  // namespace leafcutter::drivers
