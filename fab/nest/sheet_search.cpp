// First fit on the cheapest sheets, room for what found none, then mixes that cost less (sheets
// whose items must find room on the others), then compaction of the dearest sheet.

#include "fab/nest/sheet_search.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "fab/nest/settle.h"
#include "fab/nest/sheet_mixes.h"
#include "fab/nest/sheet_start.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Shares of all work:
constexpr double kStartShare = 0.15;   // the first layouts;
constexpr double kBriefShare = 0.125;  // a short look at each of several sizes;
constexpr double kLeftShare = 0.2;     // room for what chance found none;
constexpr double kMixesShare = 0.4;    // cheaper mixes, where rectangles are among the sheets.
// Shares of what is left then:
constexpr double kMostMixes = 0.9;  // most for cheaper mixes,
constexpr double kLikeliest = 0.8;  // the first of them where all sheets are irregular.
constexpr int kEndless = std::numeric_limits<int>::max();
constexpr std::size_t kMostTries = 4;  // Of mixes that came to nothing.

// How densely sheets may come to be filled: hides, and rectangles by what they are filled so far.
constexpr double kDensestHides = 0.9;
constexpr double kDenserYet = 1.3;
constexpr double kDensest = 0.98;

class SheetSearch {
public:
    SheetSearch(const SheetProblem& problem,
                const CompactionOptions& options,
                const geometry::Context& context,
                const std::function<bool(const SheetPacking&)>& accept)
        : problem_(problem),
          options_(options),
          context_(context),
          accept_(accept),
          start_(problem, options) {
        hides_ = std::none_of(problem.kinds.begin(), problem.kinds.end(),
                              [](const SheetKind& kind) { return kind.is_plain(); });
        for (const std::size_t part : problem.part_of) {
            area_ += problem.parts[part].area;
        }
    }

    SheetPacking run() {
        const std::vector<std::vector<SheetRun>> offers = first_offers(problem_);
        const double starting = kStartShare / static_cast<double>(2 * offers.size());
        std::vector<SheetTrial> trials;
        trials.reserve(offers.size());
        for (const std::vector<SheetRun>& runs : offers) {
            trials.push_back(first_of(runs, starting));
        }
        done_ = hides_ ? 0.0 : kStartShare;
        choose_start(trials);
        try {
            improve();
        } catch (const geometry::Cancelled&) {
            // The best so far is a whole layout.
        }
        return packing_of(best_);
    }

private:
    void improve() {
        find_room(kLeftShare);
        if ((problem_.kinds.size() > 1 || hides_) && !best_.kinds.empty()) {
            const double most = kMostMixes * (1.0 - done_);
            find_cheaper(hides_ ? most : std::min(kMixesShare, most));
        }
        compact_best(1.0 - done_);
    }

    CompactionOptions share_of(double share) const {
        CompactionOptions out = options_;
        out.max_evaluations = std::max<std::int64_t>(
            1, static_cast<std::int64_t>(share * static_cast<double>(options_.max_evaluations)));
        out.time_s = share * options_.time_s;
        return out;
    }

    geometry::Context context_of(double share) const {
        geometry::Context out = context_;
        out.progress = [this, share](std::string_view stage, double fraction) {
            context_.report(stage, std::min(1.0, done_ + share * fraction));
        };
        return out;
    }

    // The better one of filling sheets from either side.
    SheetTrial first_of(const std::vector<SheetRun>& runs, double share) const {
        // A first layout may not take the time of all; the clock is looked at between heaps only.
        const double rows = share * static_cast<double>(options_.max_evaluations);
        const auto most = static_cast<std::int64_t>(std::min(rows, kMostRows));
        SheetTrial best = start_.lay(runs, 0, most, context_);
        SheetTrial other = start_.lay(runs, 1, most, context_);
        return is_better(other, best) ? other : best;
    }

    // Several sizes: a short search on each tells which one the whole search is worth.
    void choose_start(std::vector<SheetTrial>& trials) {
        if (trials.size() > 1) {
            const double share = std::min(kBriefShare, 0.4 / static_cast<double>(trials.size()));
            for (SheetTrial& trial : trials) {
                trial = compacted(trial, share, [](const SheetTrial&) { return true; });
                done_ += share;
            }
        }
        std::stable_sort(trials.begin(), trials.end(), is_better);
        for (const SheetTrial& trial : trials) {
            if (publish(trial)) {
                return;
            }
        }
        throw geometry::Error(geometry::ErrorKind::SelfCheck, "nest-proof",
                              "nest: the first layout is not sound");
    }

    bool publish(const SheetTrial& trial) {
        if (!accept_(packing_of(trial))) {
            return false;
        }
        best_ = trial;
        return true;
    }

    SheetPacking packing_of(const SheetTrial& trial) const {
        SheetPacking out{trial.kinds, trial.positions};
        for (Position& at : out.positions) {
            if (at.bin >= 0) {
                const std::size_t kind = trial.kinds[static_cast<std::size_t>(at.bin)];
                at = start_.frame(trial.quarters).on_sheet(at, kind);
            }
        }
        return out;
    }

    static std::vector<std::size_t> laid_items(const SheetTrial& trial) {
        std::vector<std::size_t> items;
        for (std::size_t item = 0; item < trial.positions.size(); ++item) {
            if (trial.positions[item].bin >= 0) {
                items.push_back(item);
            }
        }
        return items;
    }

    static std::vector<Position> positions_of(const SheetTrial& trial,
                                              const std::vector<std::size_t>& items) {
        std::vector<Position> out;
        out.reserve(items.size());
        for (const std::size_t item : items) {
            out.push_back(trial.positions[item]);
        }
        return out;
    }

    // `trial` with other positions of these items.
    SheetTrial with(const SheetTrial& trial,
                    const std::vector<std::size_t>& items,
                    const std::vector<Position>& positions) const {
        SheetTrial out = trial;
        for (std::size_t i = 0; i < items.size(); ++i) {
            out.positions[items[i]] = positions[i];
        }
        start_.sum_up(out);
        return out;
    }

    template <typename Accept>
    SheetTrial compacted(const SheetTrial& trial, double share, const Accept& accept) const {
        const std::vector<std::size_t> items = laid_items(trial);
        if (items.empty()) {
            return trial;
        }
        const BoardPlan plan = start_.frame(trial.quarters).plan(items, trial.kinds);
        constexpr double kRounding = 1e-6;
        Packing packing{positions_of(trial, items),
                        {static_cast<int>(trial.kinds.size()),
                         std::min(plan.rooms.back().width, trial.last_width * (1.0 + kRounding))}};
        SheetTrial best = trial;
        compact(plan, std::move(packing), share_of(share), context_of(share),
                [&](const Packing& better) {
                    const SheetTrial next = with(trial, items, better.positions);
                    const bool fine = accept(next);
                    best = fine ? next : best;
                    return fine;
                });
        return best;
    }

    // What random places did not suit, among holes and zones, may have room all the same.
    void find_room(double share) {
        const std::vector<std::size_t> left_over = left_over_parts();
        const double each = share / static_cast<double>(std::max<std::size_t>(left_over.size(), 1));
        for (const std::size_t part : left_over) {
            for (std::size_t item = 0; item < problem_.part_of.size(); ++item) {
                const bool waits = problem_.part_of[item] == part && best_.positions[item].bin < 0;
                if (waits && !try_room(item, each)) {
                    break;
                }
            }
            done_ += each;
        }
    }

    // Each part once, if it is not larger than any sheet.
    std::vector<std::size_t> left_over_parts() const {
        std::vector<std::size_t> parts;
        for (std::size_t item = 0; item < problem_.part_of.size(); ++item) {
            const std::size_t part = problem_.part_of[item];
            if (best_.positions[item].bin < 0 && may_fit_some_sheet(item) &&
                std::find(parts.begin(), parts.end(), part) == parts.end()) {
                parts.push_back(part);
            }
        }
        return parts;
    }

    bool may_fit_some_sheet(std::size_t item) const {
        for (std::size_t kind = 0; kind < problem_.kinds.size(); ++kind) {
            if (start_.may_fit(item, kind)) {
                return true;
            }
        }
        return false;
    }

    // On the sheets of the best layout, and an empty one of each kind that there is one more of.
    bool try_room(std::size_t item, double share) {
        SheetTrial wider = best_;
        for (std::size_t kind = 0; kind < problem_.kinds.size(); ++kind) {
            const auto used = std::count(best_.kinds.begin(), best_.kinds.end(), kind);
            const bool more = used < problem_.kinds[kind].quantity.value_or(kEndless);
            if (more && start_.may_fit(item, kind)) {
                wider.kinds.push_back(kind);
            }
        }
        std::vector<std::size_t> items = laid_items(best_);
        items.push_back(item);
        return try_settling(wider, items, share);
    }

    void compact_best(double share) {
        const SheetTrial from = best_;
        compacted(from, share, [this](const SheetTrial& next) {
            return !is_better(next, best_) || publish(next);
        });
    }

    double densest() const {
        if (hides_) {
            return kDensestHides;
        }
        double whole = 0.0;
        for (const std::size_t kind : best_.kinds) {
            whole += problem_.kinds[kind].area;
        }
        const SheetKind& last = problem_.kinds[best_.kinds.back()];
        const double used =
            best_.last_width / start_.frame(best_.quarters).width(best_.kinds.back());
        return std::min(kDensest, kDenserYet * area_ / (whole - (1.0 - used) * last.area));
    }

    // Mixes that cost less, the roomiest first; each that works sets a lower mark for the rest.
    void find_cheaper(double share) {
        std::vector<Mix> failed;
        double left = share;
        while (failed.size() < kMostTries) {
            const std::optional<Mix> mix = roomiest_cheaper_mix(
                problem_, best_.kinds, best_.unplaced > 0 ? area_ : area_ / densest(), failed);
            if (!mix) {
                return;
            }
            // The first one is the likeliest: of hides, which take long, by far.
            const double each = left * (hides_ ? kLikeliest : 0.5);
            if (!try_mix(*mix, each)) {
                failed.push_back(*mix);
                left -= each;
                done_ += each;
            }
        }
    }

    bool try_mix(const Mix& mix, double share) {
        SheetTrial fresh = first_of(runs_of(problem_, mix), 0.0);
        if (is_better(fresh, best_) && publish(fresh)) {
            return true;
        }
        return try_settling(moved_to(mix), laid_items(best_), share);
    }

    // These items, freed of overlaps on the sheets of `trial`.
    bool try_settling(const SheetTrial& trial,
                      const std::vector<std::size_t>& items,
                      double share) {
        const BoardPlan plan = start_.frame(trial.quarters).plan(items, trial.kinds);
        const Settled settled =
            settle(plan, positions_of(trial, items), share_of(share), context_of(share));
        if (!settled.found) {
            return false;
        }
        const SheetTrial next = with(trial, items, settled.positions);
        return is_better(next, best_) && publish(next);
    }

    // The best layout on other sheets: what lay on a sheet that is no longer there has no place.
    SheetTrial moved_to(const Mix& mix) const {
        SheetTrial moved = best_;
        moved.kinds.clear();
        std::vector<int> left = mix;
        std::vector<int> bin_of(best_.kinds.size(), -1);
        for (std::size_t bin = 0; bin < best_.kinds.size(); ++bin) {
            if (left[best_.kinds[bin]] > 0) {
                --left[best_.kinds[bin]];
                bin_of[bin] = static_cast<int>(moved.kinds.size());
                moved.kinds.push_back(best_.kinds[bin]);
            }
        }
        for (std::size_t kind = 0; kind < left.size(); ++kind) {
            moved.kinds.insert(moved.kinds.end(), static_cast<std::size_t>(left[kind]), kind);
        }
        for (Position& at : moved.positions) {
            at.bin = at.bin < 0 ? -1 : bin_of[static_cast<std::size_t>(at.bin)];
        }
        return moved;
    }

    static constexpr double kMostRows = 2e8;

    const SheetProblem& problem_;
    const CompactionOptions& options_;
    const geometry::Context& context_;
    const std::function<bool(const SheetPacking&)>& accept_;
    SheetStart start_;
    bool hides_ = false;  // All sheets are irregular.
    double area_ = 0.0;
    double done_ = 0.0;  // Share of the work.
    SheetTrial best_;
};

}  // namespace

SheetPacking search_sheets(const SheetProblem& problem,
                           const CompactionOptions& options,
                           const geometry::Context& context,
                           const std::function<bool(const SheetPacking&)>& accept) {
    return SheetSearch(problem, options, context, accept).run();
}

}  // namespace leafcutter::fab
