#include "fab/weave/floats.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "fab/weave/pattern.h"
#include "geometry/error.h"
#include "geometry/quads/threads.h"

namespace leafcutter::fab {

namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Cells first, first + 1 … of a thread, round if it is closed, that lie on the same side.
struct Run {
    int thread = 0;
    int first = 0;
    int length = 0;
};

class Breaker {
public:
    Breaker(const geometry::QuadMesh& mesh,
            std::optional<int> limit,
            std::vector<std::uint8_t>& warp_on_top)
        : limit_(limit), top_(warp_on_top) {
        place_.fill(std::vector<std::pair<int, int>>(mesh.quads.size()));
        for (const Family family : {Family::Weft, Family::Warp}) {
            for (auto& thread :
                 geometry::trace_threads(mesh, family, geometry::ThreadEnds::Through)) {
                for (std::size_t i = 0; i < thread.quads.size(); ++i) {
                    place_[index(family)][at(thread.quads[i])] = {static_cast<int>(threads_.size()),
                                                                  static_cast<int>(i)};
                }
                threads_.push_back(std::move(thread));
            }
        }
    }

    Floats run() {
        Floats floats;
        floats.limit = limit_;
        std::tie(floats.weft_before, floats.warp_before) = measure(floats.too_long);
        const std::vector<std::uint8_t> before = top_;
        if (!floats.too_long.empty()) {
            break_all();
        }
        std::tie(floats.weft, floats.warp) = measure(floats.too_long);
        for (std::size_t quad = 0; quad < top_.size(); ++quad) {
            if (top_[quad] != before[quad]) {
                floats.flips.push_back(static_cast<int>(quad));
            }
        }
        return floats;
    }

private:
    static std::size_t index(Family family) { return family == Family::Weft ? 0 : 1; }

    int size(int thread) const { return static_cast<int>(threads_[at(thread)].quads.size()); }

    int quad(int thread, int cell) const {
        const auto& quads = threads_[at(thread)].quads;
        return quads[at(cell) % quads.size()];
    }

    std::uint8_t side(int thread, int cell) const { return top_[at(quad(thread, cell))]; }

    // The run through a cell.
    Run run_at(int thread, int cell) const {
        const bool closed = threads_[at(thread)].closed;
        const int count = size(thread);
        const std::uint8_t own = side(thread, cell);
        Run run{thread, cell, 1};
        while (run.length < count) {
            const int before = run.first > 0 ? run.first - 1 : closed ? count - 1 : -1;
            if (before < 0 || side(thread, before) != own) {
                break;
            }
            run.first = before;
            ++run.length;
        }
        while (run.length < count) {
            const int behind = run.first + run.length;
            if ((behind >= count && !closed) || side(thread, behind) != own) {
                break;
            }
            ++run.length;
        }
        return run;
    }

    std::vector<Run> runs_of(int thread) const {
        std::vector<Run> runs{run_at(thread, 0)};
        const int count = size(thread);
        int covered = runs.front().length;
        while (covered < count) {
            const Run& last = runs.back();
            runs.push_back(run_at(thread, (last.first + last.length) % count));
            covered += runs.back().length;
        }
        return runs;
    }

    bool is_too_long(const Run& run) const { return limit_ && run.length > *limit_; }

    std::pair<FamilyFloats, FamilyFloats> measure(std::vector<Float>& too_long) const {
        too_long.clear();
        std::array<FamilyFloats, 2> found;
        std::array<int, 2> runs{};
        std::array<int, 2> cells{};
        for (int thread = 0; thread < static_cast<int>(threads_.size()); ++thread) {
            const Family family = threads_[at(thread)].family;
            FamilyFloats& floats = found[index(family)];
            for (const Run& run : runs_of(thread)) {
                floats.longest = std::max(floats.longest, run.length);
                ++runs[index(family)];
                cells[index(family)] += run.length;
                if (is_too_long(run)) {
                    ++floats.over_limit;
                    too_long.push_back(as_float(run));
                }
            }
        }
        for (std::size_t i = 0; i < 2; ++i) {
            found[i].mean = runs[i] > 0 ? static_cast<double>(cells[i]) / runs[i] : 0.0;
        }
        return {found[0], found[1]};
    }

    Float as_float(const Run& run) const {
        Float result;
        result.family = threads_[at(run.thread)].family;
        result.on_top = (side(run.thread, run.first) != 0) == (result.family == Family::Warp);
        for (int i = 0; i < run.length; ++i) {
            result.quads.push_back(quad(run.thread, run.first + i));
        }
        return result;
    }

    int excess(const Run& run) const { return std::max(0, run.length - *limit_); }

    // What is above the limit on the runs at a cell of a thread and on both sides of it.
    int excess_near(int thread, int cell) const {
        const bool closed = threads_[at(thread)].closed;
        const int count = size(thread);
        const Run own = run_at(thread, cell);
        int sum = excess(own);
        if (own.length == count) {
            return sum;
        }
        const int before = own.first > 0 ? own.first - 1 : closed ? count - 1 : -1;
        const int behind = own.first + own.length;
        const Run first = before >= 0 ? run_at(thread, before) : own;
        sum += before >= 0 ? excess(first) : 0;
        if (behind < count || closed) {
            const Run last = run_at(thread, behind % count);
            sum += before >= 0 && last.first == first.first ? 0 : excess(last);
        }
        return sum;
    }

    // How much less is above the limit in both threads of a quad if it changes sides; negative
    // where a float comes to exceed it, or one that does grows.
    int gain(int quad) {
        int total = 0;
        for (const auto& places : place_) {
            const auto [thread, cell] = places[at(quad)];
            const int before = excess_near(thread, cell);
            top_[at(quad)] ^= 1U;
            const int after = excess_near(thread, cell);
            const Run merged = run_at(thread, cell);
            top_[at(quad)] ^= 1U;
            if (is_too_long(merged)) {
                return -1;
            }
            total += before - after;
        }
        return total;
    }

    // How long the runs through a quad become if it changes sides.
    int merged_length(int quad) {
        int longest = 0;
        top_[at(quad)] ^= 1U;
        for (const auto& places : place_) {
            const auto [thread, cell] = places[at(quad)];
            longest = std::max(longest, run_at(thread, cell).length);
        }
        top_[at(quad)] ^= 1U;
        return longest;
    }

    // Every flip lowers what is above the limit, so this ends.
    void break_all() {
        for (bool better = true; better;) {
            better = false;
            for (int thread = 0; thread < static_cast<int>(threads_.size()); ++thread) {
                for (const Run& run : runs_of(thread)) {
                    better = (is_too_long(run) && break_run(run)) || better;
                }
            }
        }
    }

    bool break_run(const Run& run) {
        std::tuple<int, int, int> best{0, 0, 0};  // Gain, minus the merged length, place.
        int chosen = -1;
        for (int i = 0; i < run.length; ++i) {
            const int candidate = quad(run.thread, run.first + i);
            const int gained = gain(candidate);
            if (gained <= 0) {
                continue;
            }
            const std::tuple<int, int, int> value{gained, -merged_length(candidate), -i};
            if (chosen < 0 || value > best) {
                best = value;
                chosen = candidate;
            }
        }
        if (chosen >= 0) {
            top_[at(chosen)] ^= 1U;
        }
        return chosen >= 0;
    }

    std::optional<int> limit_;
    std::vector<std::uint8_t>& top_;
    std::vector<geometry::Thread> threads_;
    std::array<std::vector<std::pair<int, int>>, 2> place_;  // Per family and quad: thread, cell.
};

// The longest run of equal values round a circle; none if they are all equal.
std::optional<int> longest_round(const std::vector<int>& values) {
    int longest = 0;
    int length = 0;
    for (std::size_t i = 0; i < 2 * values.size(); ++i) {
        const bool same =
            i > 0 && (values[i % values.size()] != 0) == (values[(i - 1) % values.size()] != 0);
        length = same ? length + 1 : 1;
        longest = std::max(longest, length);
    }
    return longest > static_cast<int>(values.size()) ? std::nullopt : std::optional(longest);
}

std::optional<int> pattern_float(const PatternMatrix& matrix) {
    int longest = 0;
    for (const std::vector<int>& row : matrix) {
        const std::optional<int> own = longest_round(row);
        if (!own) {
            return std::nullopt;
        }
        longest = std::max(longest, *own);
    }
    for (std::size_t col = 0; col < matrix.front().size(); ++col) {
        std::vector<int> values;
        for (const std::vector<int>& row : matrix) {
            values.push_back(row[col]);
        }
        const std::optional<int> own = longest_round(values);
        if (!own) {
            return std::nullopt;
        }
        longest = std::max(longest, *own);
    }
    return longest;
}

}  // namespace

std::optional<int> float_limit(const WeaveParams& params) {
    const std::optional<int> own = pattern_float(pattern_matrix(params));
    if (params.max_float && own && *params.max_float < *own) {
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "float-limit",
            fmt::format("weave.max_float: must be at least {}, as far as this pattern floats "
                        "where it is unbroken",
                        *own));
    }
    if (params.max_float) {
        return params.max_float;
    }
    return own ? std::optional(*own + 1) : std::nullopt;
}

Floats limit_floats(const geometry::QuadMesh& mesh,
                    std::optional<int> limit,
                    std::vector<std::uint8_t>& warp_on_top) {
    return Breaker(mesh, limit, warp_on_top).run();
}

}  // namespace leafcutter::fab
