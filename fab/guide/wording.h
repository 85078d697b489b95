// Lists of strips and crossings in few words.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::fab::guide {

// "W1–W5, W7": ids that count up or down by one are put together.
std::string id_ranges(const std::vector<std::string>& ids);

// "W1, W2 and 7 more" if there are more than `most`.
std::string first_of(const std::vector<std::string>& items, std::size_t most);

struct NamedCrossing {
    std::string id;     // Of the strip that is crossed.
    bool over = false;  // Whether the strip whose way this is lies over it.
};

// The way of a strip, in order: "over P1, under P2, and so on by turns to P42; then under P1".
// Runs that repeat are told once.
std::string crossing_text(const std::vector<NamedCrossing>& way);

// "1 strip", "3 strips"
std::string counted(std::size_t count, const std::string& what);

}  // namespace leafcutter::fab::guide
