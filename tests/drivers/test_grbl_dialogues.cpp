// The simulated controller gives the answers that the real Grbl 1.1h gave (grbl_dialogues.txt).

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {
namespace {

constexpr double kQuiet = 0.12;  // Seconds without an answer after which nothing more is awaited.

struct Exchange {
    std::string directive;
    std::string argument;
    std::vector<std::string> answers;
};

struct Dialogue {
    std::string name;
    std::vector<Exchange> exchanges;
};

void PrintTo(const Dialogue& dialogue, std::ostream* out) {
    *out << dialogue.name;
}

std::vector<Dialogue> read_dialogues() {
    std::ifstream file(GRBL_DIALOGUES);
    std::vector<Dialogue> dialogues;
    std::string line;
    while (std::getline(file, line)) {
        if (line.substr(0, 3) == "== ") {
            dialogues.push_back({line.substr(3), {}});
        } else if (dialogues.empty() || line.empty()) {
            continue;
        } else if (line.substr(0, 2) == "< ") {
            dialogues.back().exchanges.back().answers.push_back(line.substr(2));
        } else {
            const std::size_t blank = std::min(line.find(' '), line.size());
            dialogues.back().exchanges.push_back(
                {line.substr(0, blank), line.substr(std::min(blank + 1, line.size())), {}});
        }
    }
    return dialogues;
}

// "\x18", "\n" and "\r" become the bytes they name.
std::string unescape(const std::string& text) {
    std::string bytes;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\') {
            bytes += text[i];
        } else if (text[++i] == 'x') {
            bytes += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            bytes += text[i] == 'n' ? '\n' : '\r';
        }
    }
    return bytes;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::string line;
    for (const char letter : text) {
        if (letter != '\n' && letter != '\r') {
            line += letter;
        } else if (!line.empty()) {
            lines.push_back(line);
            line.clear();
        }
    }
    return lines;
}

std::vector<std::string> play(GrblMachine& machine, const Exchange& exchange) {
    if (exchange.directive == "wait") {
        return lines_of(machine.advance(std::stod(exchange.argument)));
    }
    std::string text = machine.feed(exchange.directive == ">" ? exchange.argument + "\n"
                                                              : unescape(exchange.argument));
    std::string more;
    do {
        more = machine.advance(kQuiet);
        text += more;
    } while (!more.empty());
    return lines_of(text);
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) {
        parts.push_back(part);
    }
    return parts;
}

// Numbers that differ by rounding to a step at most; a number that isn't one is compared as text.
bool same_values(const std::string& a, const std::string& b, double slack) {
    const auto ours = split(a, ',');
    const auto theirs = split(b, ',');
    bool same = ours.size() == theirs.size();
    for (std::size_t i = 0; same && i < ours.size(); ++i) {
        char* end = nullptr;
        const double value = std::strtod(ours[i].c_str(), &end);
        same = *end == 0 && !ours[i].empty()
                   ? std::abs(value - std::strtod(theirs[i].c_str(), nullptr)) <= slack
                   : ours[i] == theirs[i];
    }
    return same;
}

// Equal, but for what depends on the moment at which a moving machine was asked.
bool same(const std::string& a, const std::string& b) {
    if (a.front() != '<' || b.front() != '<') {
        return a == b;
    }
    const auto ours = split(a.substr(1, a.size() - 2), '|');
    const auto theirs = split(b.substr(1, b.size() - 2), '|');
    if (ours.size() != theirs.size() || ours[0] != theirs[0]) {
        return false;
    }
    const bool moving = ours[0] == "Run" || ours[0] == "Jog" || ours[0] == "Hold:1";
    const bool stopped_somewhere = ours[0] == "Hold:0" || ours[0] == "Door:0";
    for (std::size_t i = 1; i < ours.size(); ++i) {
        const auto one = split(ours[i], ':');
        const auto other = split(theirs[i], ':');
        const bool place = one[0] == "MPos" || one[0] == "WPos";
        const bool fleeting =
            moving ? place || one[0] == "FS" || one[0] == "Bf" : stopped_somewhere && place;
        const double slack = fleeting ? 1e9 : (one[0] == "FS" ? 1.01 : 0.0041);
        if (one[0] != other[0] || !same_values(one[1], other[1], slack)) {
            return false;
        }
    }
    return true;
}

class GrblDialogue : public testing::TestWithParam<Dialogue> {};

TEST_P(GrblDialogue, GoesAsWithTheRealFirmware) {
    GrblMachine machine;
    machine.feed("");
    for (const Exchange& exchange : GetParam().exchanges) {
        const std::vector<std::string> answers = play(machine, exchange);
        EXPECT_TRUE(std::equal(answers.begin(), answers.end(), exchange.answers.begin(),
                               exchange.answers.end(), same))
            << fmt::format("{} {}\n  ours:  {}\n  Grbl:  {}", exchange.directive, exchange.argument,
                           fmt::join(answers, " / "), fmt::join(exchange.answers, " / "));
    }
}

INSTANTIATE_TEST_SUITE_P(Recorded,
                         GrblDialogue,
                         testing::ValuesIn(read_dialogues()),
                         [](const auto& dialogue) {
                             std::string name = dialogue.param.name;
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                         });

}  // namespace
}  // namespace leafcutter::drivers
