// The $ settings of the simulated Grbl 1.1 controller.

#pragma once

#include <array>
#include <map>
#include <string>

namespace leafcutter::drivers {

class GrblSettings {
public:
    // A laser of 600 x 400 mm: Grbl's defaults but for $32=1, S 0..1000, 6000 mm/min and 500 mm/s².
    GrblSettings();

    double get(int number) const;
    bool is_on(int number) const { return get(number) != 0.0; }

    // Returns the code of Grbl's error, 0 for none.
    int set(int number, double value);

    std::array<double, 3> axes(int first_number) const;

    // All settings as `$n=value` lines with their line ends.
    std::string dump() const;

private:
    std::map<int, double> values_;
};

}  // namespace leafcutter::drivers
