#include "fab/warnings.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace leafcutter::fab {

namespace {

constexpr std::size_t kNamed = 6;

struct Kind {
    std::string what;
    std::vector<std::string> who;
};

std::string line_of(const Kind& kind) {
    if (kind.who.empty()) {
        return kind.what;
    }
    const std::size_t named = std::min(kNamed, kind.who.size());
    std::string who;
    for (std::size_t i = 0; i < named; ++i) {
        who += (i == 0 ? "" : ", ") + kind.who[i];
    }
    if (named < kind.who.size()) {
        who += fmt::format(" and {} more", kind.who.size() - named);
    }
    return fmt::format("{}: {}", who, kind.what);
}

}  // namespace

std::vector<std::string> joined_warnings(const std::vector<std::string>& warnings) {
    std::vector<Kind> kinds;
    for (const std::string& warning : warnings) {
        const std::size_t colon = warning.find(": ");
        const bool named = colon != std::string::npos && warning.find(' ') > colon;
        const std::string what = named ? warning.substr(colon + 2) : warning;
        auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& known) {
            return known.what == what && known.who.empty() != named;
        });
        if (kind == kinds.end()) {
            kind = kinds.insert(kinds.end(), Kind{what, {}});
        }
        if (named) {
            kind->who.push_back(warning.substr(0, colon));
        }
    }
    std::vector<std::string> lines;
    lines.reserve(kinds.size());
    for (const Kind& kind : kinds) {
        lines.push_back(line_of(kind));
    }
    return lines;
}

}  // namespace leafcutter::fab
