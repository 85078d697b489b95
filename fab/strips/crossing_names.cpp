#include "fab/strips/crossing_names.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace leafcutter::fab {

namespace {

struct Run {
    int first = 0;
    int last = 0;
};

constexpr int kReach = 3;  // How many cells inward an id at a run's end may stand.

std::vector<Run> runs_of(std::span<const int> numbers) {
    std::vector<Run> runs;
    const int count = static_cast<int>(numbers.size());
    const auto step = [&](int i) {
        return numbers[static_cast<std::size_t>(i) + 1] - numbers[static_cast<std::size_t>(i)];
    };
    for (int first = 0; first < count;) {
        int last = first;
        if (first + 1 < count && std::abs(step(first)) == 1) {
            const int way = step(first);
            while (last + 1 < count && step(last) == way) {
                ++last;
            }
        }
        runs.push_back({first, last});
        first = last + 1;
    }
    return runs;
}

NameWish wish(const CrossedCells& cells, const Run& run, std::vector<int> wanted) {
    std::erase_if(wanted, [&](int cell) { return cell < run.first || cell > run.last; });
    std::stable_partition(wanted.begin(), wanted.end(), [&](int cell) {
        return cells.under[static_cast<std::size_t>(cell)] != 0;
    });
    return wanted;
}

NameWish wish_at_end(const CrossedCells& cells, const Run& run, int end, int inward) {
    std::vector<int> wanted;
    for (int i = 0; i <= kReach; ++i) {
        wanted.push_back(end + i * inward);
    }
    return wish(cells, run, std::move(wanted));
}

}  // namespace

std::vector<NameWish> name_wishes(const CrossedCells& cells) {
    std::vector<NameWish> wishes;
    for (const Run& run : runs_of(cells.numbers)) {
        wishes.push_back(wish_at_end(cells, run, run.first, 1));
        const bool ends_piece = run.last + 1 == static_cast<int>(cells.numbers.size());
        if (ends_piece && run.last > run.first) {
            wishes.push_back(wish_at_end(cells, run, run.last, -1));
        }
        for (int i = run.first + cells.every; i + cells.every / 2 < run.last; i += cells.every) {
            wishes.push_back(wish(cells, run, {i, i + 1, i - 1}));
        }
    }
    return wishes;
}

}  // namespace leafcutter::fab
