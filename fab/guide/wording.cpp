#include "fab/guide/wording.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace leafcutter::fab::guide {

namespace {

constexpr std::size_t kLongestPeriod = 10;
constexpr const char* kDash = "\xe2\x80\x93";

// "W12" as "W" and 12; nothing if it doesn't end in a number.
std::optional<std::pair<std::string_view, int>> parted(std::string_view id) {
    const std::size_t at = id.find_last_not_of("0123456789") + 1;
    int number = 0;
    const auto [end, error] = std::from_chars(id.data() + at, id.data() + id.size(), number);
    if (error != std::errc() || at == id.size()) {
        return std::nullopt;
    }
    return std::pair(id.substr(0, at), number);
}

// By how much the number grows from one id to the next, if that is 1 or -1; else 0.
int step_between(const std::string& id, const std::string& next) {
    const auto one = parted(id);
    const auto other = parted(next);
    if (!one || !other || one->first != other->first) {
        return 0;
    }
    const int step = other->second - one->second;
    return step == 1 || step == -1 ? step : 0;
}

// How far from `begin` on the way repeats itself after `period` crossings.
std::size_t repeats_until(const std::vector<NamedCrossing>& way,
                          std::size_t begin,
                          std::size_t period) {
    std::size_t end = begin + period;
    while (end < way.size() && way[end].over == way[end - period].over) {
        ++end;
    }
    return std::min(end, way.size());
}

struct Stretch {
    std::size_t period = 1;
    std::size_t end = 0;
};

// The longest stretch from `begin` that repeats; shorter periods are preferred.
Stretch best_stretch(const std::vector<NamedCrossing>& way, std::size_t begin) {
    Stretch best{1, repeats_until(way, begin, 1)};
    for (std::size_t period = 2; period <= kLongestPeriod; ++period) {
        const std::size_t end = repeats_until(way, begin, period);
        const bool repeats = end >= begin + 2 * period;
        // A longer way of saying it must gain more than it costs.
        if (repeats && end > best.end + period) {
            best = {period, end};
        }
    }
    return best;
}

// "over P1, under P2–P3": the runs of a stretch of the way.
std::string runs_text(const std::vector<NamedCrossing>& way, std::size_t begin, std::size_t end) {
    std::string text;
    while (begin < end) {
        std::vector<std::string> ids;
        const bool over = way[begin].over;
        while (begin < end && way[begin].over == over) {
            ids.push_back(way[begin++].id);
        }
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", over ? "over" : "under",
                            id_ranges(ids));
    }
    return text;
}

std::string stretch_text(const std::vector<NamedCrossing>& way,
                         std::size_t begin,
                         const Stretch& stretch) {
    if (stretch.period == 1 || stretch.end - begin <= stretch.period + 1) {
        return runs_text(way, begin, stretch.end);
    }
    const char* again = stretch.period == 2 ? ", and so on by turns" : ", and so on like this";
    return fmt::format("{}{} to {}", runs_text(way, begin, begin + stretch.period), again,
                       way[stretch.end - 1].id);
}

}  // namespace

std::string id_ranges(const std::vector<std::string>& ids) {
    std::string text;
    for (std::size_t i = 0; i < ids.size();) {
        std::size_t last = i;
        const int step = i + 1 < ids.size() ? step_between(ids[i], ids[i + 1]) : 0;
        while (step != 0 && last + 1 < ids.size() &&
               step_between(ids[last], ids[last + 1]) == step) {
            ++last;
        }
        text += text.empty() ? "" : ", ";
        text += ids[i];
        if (last == i + 1) {
            last = i;  // Two are two, not a range.
        } else if (last > i) {
            text += fmt::format("{}{}", kDash, ids[last]);
        }
        i = last + 1;
    }
    return text;
}

std::string first_of(const std::vector<std::string>& items, std::size_t most) {
    std::string text;
    const std::size_t count = items.size() <= most ? items.size() : most;
    for (std::size_t i = 0; i < count; ++i) {
        text += fmt::format("{}{}", i > 0 ? ", " : "", items[i]);
    }
    return count < items.size() ? fmt::format("{} and {} more", text, items.size() - count) : text;
}

std::string crossing_text(const std::vector<NamedCrossing>& way) {
    std::string text;
    for (std::size_t begin = 0; begin < way.size();) {
        const Stretch stretch = best_stretch(way, begin);
        text += text.empty() ? "" : "; then ";
        text += stretch_text(way, begin, stretch);
        begin = stretch.end;
    }
    return text;
}

std::string counted(std::size_t count, const std::string& what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace leafcutter::fab::guide
