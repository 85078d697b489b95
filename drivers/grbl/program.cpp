#include "drivers/grbl/program.h"

#include <algorithm>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/grbl/protocol.h"

namespace leafcutter::drivers {

namespace {

[[noreturn]] void refuse(std::size_t line, std::string_view what) {
    throw ProgramRefused(fmt::format("line {}: {}", line, what));
}

// G10, G28.1, G30.1 write the EEPROM, which stops Grbl from receiving; G28, G30, G54 to G59 read
// it.
bool touches_eeprom(const GcodeWord& word) {
    const double code = word.letter == 'G' ? word.value : 0.0;
    return code == 10.0 || code == 28.0 || code == 28.1 || code == 30.0 || code == 30.1 ||
           (code >= 54.0 && code <= 59.0);
}

ProgramLine read_line(std::string stripped, std::size_t number, std::size_t longest) {
    ProgramLine line{std::move(stripped), number};
    if (std::any_of(line.text.begin(), line.text.end(), is_realtime_byte)) {
        refuse(number, "holds a byte that Grbl takes for a real-time command (? ! ~, or no ASCII)");
    }
    if (line.text[0] == '$') {
        refuse(number, "$ commands don't belong into a program; use the console");
    }
    if (line.text.size() > longest) {
        refuse(number,
               fmt::format("is {} characters long, Grbl takes {}", line.text.size(), longest));
    }
    const GcodeWords words = split_words(line.text);
    if (words.fault) {
        refuse(number, "\"" + line.text + "\" is no G-code");
    }
    bool dwell = false;
    double p = 0.0;
    for (const GcodeWord& word : words.words) {
        line.alone = line.alone || touches_eeprom(word);
        dwell = dwell || (word.letter == 'G' && word.value == 4.0);
        p = word.letter == 'P' ? word.value : p;
    }
    line.dwell_s = dwell ? p : 0.0;
    return line;
}

}  // namespace

Program read_program(std::string_view text, std::size_t longest_line) {
    Program program;
    std::size_t number = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        const std::string_view raw = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        ++number;
        std::string stripped = strip_gcode(raw);
        if (!stripped.empty() && stripped != "%") {
            program.lines.push_back(read_line(std::move(stripped), number, longest_line));
        }
    }
    if (program.lines.empty()) {
        throw ProgramRefused("the program is empty");
    }
    return program;
}

}  // namespace leafcutter::drivers
