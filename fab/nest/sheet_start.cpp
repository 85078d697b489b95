#include "fab/nest/sheet_start.h"

#include <algorithm>
#include <numeric>

#include "fab/nest/heap_start.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

constexpr std::size_t kMostSheets = 10'000;
constexpr std::int64_t kMostSamples = 1000;

// Of what a new sheet is worth for its area: a remnant that is hardly filled had better stay whole.
constexpr double kWorthOfRemnant = 0.5;

}  // namespace

bool is_better(const SheetTrial& a, const SheetTrial& b) {
    if (a.unplaced != b.unplaced) {
        return a.unplaced < b.unplaced;
    }
    if (a.cost != b.cost) {
        return a.cost < b.cost;
    }
    return a.taken < b.taken;
}

// What still waits for its place.
struct SheetStart::Rest {
    std::vector<std::size_t> items;
    const geometry::Context& context;
};

SheetStart::SheetStart(const SheetProblem& problem, const CompactionOptions& options)
    : problem_(problem), seed_(options.seed) {
    // Trying more places for an item than for all later on would be out of proportion.
    const auto items = static_cast<std::int64_t>(problem.part_of.size());
    samples_ = static_cast<int>(
        std::clamp<std::int64_t>(options.max_evaluations / (10 * items + 1), 40, kMostSamples));
    std::size_t bands = 0;
    for (const std::size_t part : problem.part_of) {
        bands += problem.parts[part].is_band() ? 1 : 0;
    }
    banded_ = 2 * bands > problem.part_of.size();
    const std::vector<std::vector<NestPart>> taken = taken_parts(problem);
    frames_.emplace_back(problem, taken, 0);
    frames_.emplace_back(problem, taken, 1);
    for (const SheetKind& kind : problem.kinds) {
        // A part that only just fits may not once its corners are rounded.
        const double slack = 1e-6 * std::max(kind.width, kind.height);
        std::vector<char> fits;
        for (const NestPart& part : problem.parts) {
            const bool fine =
                fitting_angle(make_shape(part.outline), {kind.width - slack, kind.height - slack},
                              part.allowed_deg)
                    .has_value();
            fits.push_back(fine ? 1 : 0);
        }
        fits_.push_back(std::move(fits));
    }
}

void SheetStart::sum_up(SheetTrial& trial) const {
    std::vector<int> bin_of(trial.kinds.size(), -1);
    for (const Position& at : trial.positions) {
        if (at.bin >= 0) {
            bin_of[static_cast<std::size_t>(at.bin)] = 0;
        }
    }
    std::vector<std::size_t> kinds;
    for (std::size_t bin = 0; bin < bin_of.size(); ++bin) {
        if (bin_of[bin] == 0) {
            bin_of[bin] = static_cast<int>(kinds.size());
            kinds.push_back(trial.kinds[bin]);
        }
    }
    trial.kinds = std::move(kinds);
    trial.unplaced = 0;
    trial.last_width = 0.0;
    const int last = static_cast<int>(trial.kinds.size()) - 1;
    TurnedPart turned;
    for (std::size_t item = 0; item < trial.positions.size(); ++item) {
        Position& at = trial.positions[item];
        at.bin = at.bin >= 0 ? bin_of[static_cast<std::size_t>(at.bin)] : -1;
        trial.unplaced += at.bin < 0 ? 1 : 0;
        if (at.bin >= 0 && at.bin == last) {
            turn_part(frame(trial.quarters).part(item), at.angle_deg, turned);
            trial.last_width = std::max(trial.last_width, at.x + turned.high_x);
        }
    }
    trial.cost = 0.0;
    trial.taken = 0.0;
    for (std::size_t bin = 0; bin < trial.kinds.size(); ++bin) {
        const SheetKind& kind = problem_.kinds[trial.kinds[bin]];
        trial.cost += kind.cost;
        const double share = static_cast<int>(bin) == last
                                 ? trial.last_width / frame(trial.quarters).width(trial.kinds[bin])
                                 : 1.0;
        trial.taken += share * kind.area * (kind.cost > 0.0 ? 1.0 : kWorthOfRemnant);
    }
}

void SheetStart::lay_heaps(const SheetRun& run,
                           std::int64_t rows,
                           Rest& rest,
                           SheetTrial& trial) const {
    std::vector<std::size_t> items;
    std::vector<std::size_t> others;
    for (const std::size_t item : rest.items) {
        (may_fit(item, run.kind) ? items : others).push_back(item);
    }
    if (items.empty()) {
        return;
    }
    const std::size_t one[] = {run.kind};
    const BoardPlan plan = frame(trial.quarters).plan(items, one);
    const HeapStart start = heap_start(plan, rows, seed_, rest.context);
    trial.evaluations += start.rows;
    const int room = run.count.value_or(static_cast<int>(kMostSheets));
    const int first = static_cast<int>(trial.kinds.size());
    trial.kinds.insert(trial.kinds.end(),
                       static_cast<std::size_t>(std::min(room, start.packing.extent.bins)),
                       run.kind);
    for (std::size_t i = 0; i < items.size(); ++i) {
        Position at = start.packing.positions[i];
        if (at.bin >= room) {
            others.push_back(items[i]);
            continue;
        }
        if (at.bin < 0) {
            others.push_back(items[i]);
            continue;
        }
        at.bin += first;
        trial.positions[items[i]] = at;
    }
    std::sort(others.begin(), others.end());
    rest.items = std::move(others);
}

void SheetStart::lay_one_by_one(std::span<const SheetRun> runs,
                                Rest& rest,
                                SheetTrial& trial) const {
    std::vector<std::size_t> kinds;
    for (const SheetRun& run : runs) {
        const std::size_t most = std::min(kMostSheets, rest.items.size());
        const auto count = static_cast<std::size_t>(run.count.value_or(static_cast<int>(most)));
        kinds.insert(kinds.end(), std::min(count, most), run.kind);
    }
    if (kinds.empty() || rest.items.empty()) {
        return;
    }
    const BoardPlan plan = frame(trial.quarters).plan(rest.items, kinds);
    const Packing packing = first_packing(plan, {seed_, samples_}, rest.context);
    trial.evaluations += static_cast<std::int64_t>(rest.items.size());
    const int first = static_cast<int>(trial.kinds.size());
    trial.kinds.insert(trial.kinds.end(), kinds.begin(), kinds.end());
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < rest.items.size(); ++i) {
        Position at = packing.positions[i];
        if (at.bin < 0) {
            others.push_back(rest.items[i]);
            continue;
        }
        at.bin += first;
        trial.positions[rest.items[i]] = at;
    }
    rest.items = std::move(others);
}

std::vector<SheetRun> SheetStart::unused(std::span<const SheetRun> runs,
                                         const SheetTrial& trial) const {
    std::vector<SheetRun> left;
    for (SheetRun run : runs) {
        if (run.count) {
            *run.count -=
                static_cast<int>(std::count(trial.kinds.begin(), trial.kinds.end(), run.kind));
        }
        if (run.count.value_or(1) > 0) {
            left.push_back(run);
        }
    }
    return left;
}

SheetTrial SheetStart::lay(std::span<const SheetRun> runs,
                           int quarters,
                           std::int64_t rows,
                           const geometry::Context& context) const {
    SheetTrial trial;
    trial.quarters = quarters;
    trial.positions.resize(problem_.part_of.size());
    for (Position& at : trial.positions) {
        at.bin = -1;
    }
    Rest rest{std::vector<std::size_t>(problem_.part_of.size()), context};
    std::iota(rest.items.begin(), rest.items.end(), std::size_t{0});
    for (std::size_t i = 0; i < runs.size() && !rest.items.empty();) {
        context.check();
        if (heaps_suit(problem_.kinds[runs[i].kind])) {
            lay_heaps(runs[i], rows, rest, trial);
            ++i;
            continue;
        }
        std::size_t end = i;
        while (end < runs.size() && !heaps_suit(problem_.kinds[runs[end].kind])) {
            ++end;
        }
        lay_one_by_one(runs.subspan(i, end - i), rest, trial);
        i = end;
    }
    lay_one_by_one(unused(runs, trial), rest, trial);
    sum_up(trial);
    return trial;
}

}  // namespace leafcutter::fab
