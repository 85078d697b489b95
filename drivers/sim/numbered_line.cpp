#include "drivers/sim/numbered_line.h"

#include <algorithm>
#include <charconv>

namespace leafcutter::drivers {

namespace {

std::size_t number_at(std::string_view text) {
    std::size_t number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

}  // namespace

NumberedLine read_numbered_line(std::string_view line) {
    NumberedLine read;
    if (line.empty() || line.front() != 'N') {
        read.text = line;
        return read;
    }
    const std::size_t star = std::min(line.rfind('*'), line.size());
    read.number = number_at(line.substr(1));
    read.sets_number = line.find("M110") != std::string_view::npos;
    read.has_sum = star < line.size();
    unsigned sum = 0;
    for (const char byte : line.substr(0, star)) {
        sum ^= static_cast<unsigned char>(byte);
    }
    read.sum_holds = read.has_sum && number_at(line.substr(star + 1)) == sum;
    const std::size_t begin = std::min(line.find_first_not_of("N0123456789 "), star);
    read.text = line.substr(begin, star - begin);
    return read;
}

}  // namespace leafcutter::drivers
