#include "fab/cut/cut_contours.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "fab/cut/common_edges.h"
#include "fab/cut/cut_order.h"
#include "fab/cut/lead_in.h"
#include "fab/cut/micro_tabs.h"
#include "fab/cut/path_walk.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

constexpr double kFromTabMm = 1.0;  // No contour starts nearer to a tab.

// Lead-ins are made shorter where there is no room; those that would become too short to pierce in
// are left out.
constexpr std::array<double, 5> kLeadParts{1.0, 0.7, 0.5, 0.35, 0.25};
constexpr double kLeastLeadMm = 0.2;

class CutPlanner {
public:
    CutPlanner(const Sheet& sheet,
               CutContours contours,
               const CutWishes& wishes,
               const geometry::Context& context)
        : contours_(std::move(contours)),
          wishes_(wishes),
          context_(context),
          room_(sheet, contours_.outlines, wishes.kerf_mm) {}

    PlannedCuts plan() {
        part_contours();
        add_bridges();
        // Inner paths come behind the others, so that those keep their numbers.
        paths_ = shared_.paths;
        paths_.insert(paths_.end(), contours_.inner.begin(), contours_.inner.end());
        rules_.before = shared_.before;
        inner_first();
        rules_.heat = wishes_.params.heat;
        rules_.cooling = wishes_.cooling;
        rules_.starts_mm.resize(paths_.size());
        lead_mm_.assign(paths_.size(), 0.0);
        for (std::size_t i = 0; i < paths_.size(); ++i) {
            context_.check();
            choose_starts(i);
        }
        for (const OrderedPath& place : find_order(paths_, wishes_.from, rules_, context_)) {
            result_.paths.push_back(finished(place));
        }
        return std::move(result_);
    }

private:
    void part_contours() {
        if (wishes_.params.common_edges) {
            shared_ = share_edges(contours_.outer);
        } else {
            shared_.paths = contours_.outer;
            for (std::size_t i = 0; i < contours_.outer.size(); ++i) {
                shared_.owners.emplace_back(i, i);
            }
        }
        result_.facts.common_edges_mm = shared_.common_mm;
    }

    void add_bridges() {
        if (wishes_.params.tabs == 0) {
            return;
        }
        std::vector<std::vector<CutPath*>> own(contours_.outer.size());
        for (std::size_t i = 0; i < shared_.paths.size(); ++i) {
            if (!is_common(i)) {
                own[shared_.owners[i].first].push_back(&shared_.paths[i]);
            }
        }
        const TabOptions options{wishes_.params.tabs, wishes_.params.tab_mm};
        for (std::size_t c = 0; c < own.size(); ++c) {
            const CutPath& contour = contours_.outer[c];
            const int found = add_tabs(contour.points, own[c], kept_from_tabs(c), options);
            result_.facts.tabs += found;
            result_.facts.tabs_dropped += options.count - found;
        }
        for (const CutPath& path : shared_.paths) {
            const std::vector<double> stations = stations_mm(path.points);
            for (const DarkStretch& tab : path.tabs) {
                room_.keep_from({point_at(path.points, stations, tab.from_mm),
                                 point_at(path.points, stations, tab.to_mm)});
            }
        }
    }

    // Marks of the piece, and contours of others: a tab that a neighbour's cut runs along holds
    // nothing.
    std::vector<Segment> kept_from_tabs(std::size_t contour) {
        constexpr double kNearMm = 2.0;
        std::vector<Segment> lines = contours_.marks[contours_.outer[contour].piece];
        const Box box = bounds(contours_.outer[contour].points);
        for (std::size_t i = 0; i < contours_.outer.size(); ++i) {
            const Polyline& other = contours_.outer[i].points;
            if (i == contour || !box.near(bounds(other), kNearMm)) {
                continue;
            }
            for (std::size_t k = 1; k < other.size(); ++k) {
                lines.push_back({other[k - 1], other[k]});
            }
        }
        return lines;
    }

    bool is_outer(std::size_t path) const { return path < shared_.paths.size(); }
    bool is_common(std::size_t path) const {
        return is_outer(path) && shared_.owners[path].first != shared_.owners[path].second;
    }

    // Of closed contours find_order sees it for itself.
    void inner_first() {
        std::map<std::string_view, std::vector<std::size_t>> parts;
        for (std::size_t i = 0; i < shared_.paths.size(); ++i) {
            if (!is_closed(shared_.paths[i])) {
                parts[shared_.paths[i].piece].push_back(i);
                if (is_common(i)) {
                    parts[shared_.paths[i].other_piece].push_back(i);
                }
            }
        }
        for (std::size_t i = shared_.paths.size(); i < paths_.size(); ++i) {
            for (const std::size_t part : parts[paths_[i].piece]) {
                rules_.before.emplace_back(i, part);
            }
        }
    }

    void choose_starts(std::size_t path) {
        if (!is_closed(paths_[path])) {
            return;
        }
        std::vector<double> places = start_places(paths_[path]);
        std::erase_if(places, [&](double at) {
            const auto near = [&](const DarkStretch& tab) {
                return at > tab.from_mm - kFromTabMm && at < tab.to_mm + kFromTabMm;
            };
            const std::vector<DarkStretch>& tabs = paths_[path].tabs;
            return std::any_of(tabs.begin(), tabs.end(), near);
        });
        if (places.empty()) {
            places.push_back(0.0);  // Tabs keep away from there.
        }
        if (is_outer(path) && wishes_.params.lead_in_mm > 0.0) {
            places = with_lead_in(path, places);
        }
        rules_.starts_mm[path] = std::move(places);
    }

    // Those of the places that have room for a lead-in as long as any of them has.
    std::vector<double> with_lead_in(std::size_t path, const std::vector<double>& places) {
        for (const double part : kLeadParts) {
            const double length = part * wishes_.params.lead_in_mm;
            if (length < kLeastLeadMm && part < 1.0) {
                break;
            }
            std::vector<double> free;
            for (const double at : places) {
                if (room_.begin(paths_[path].points, at, length)) {
                    free.push_back(at);
                }
            }
            if (!free.empty()) {
                lead_mm_[path] = length;
                return free;
            }
        }
        return places;
    }

    CutPath finished(const OrderedPath& place) {
        const CutPath& drawn = paths_[place.path];
        CutPath path = as_ordered(drawn, place);
        if (is_outer(place.path) && !is_common(place.path) && wishes_.params.lead_in_mm > 0.0) {
            path.lead_in = lead_into(place);
        }
        if (is_closed(path)) {
            path.over_cut_mm = std::min(wishes_.over_cut_mm, length_mm(path.points) / 4.0);
            if (!path.tabs.empty()) {
                path.over_cut_mm = std::min(path.over_cut_mm, path.tabs.front().from_mm);
            }
        }
        return path;
    }

    std::optional<Eigen::Vector2d> lead_into(const OrderedPath& place) {
        const Polyline& points = paths_[place.path].points;
        const bool closed = is_closed(paths_[place.path]);
        const double at = !closed && place.backward ? length_mm(points) : place.start_mm;
        for (const double part : kLeadParts) {
            const double length = part * wishes_.params.lead_in_mm;
            const bool other = closed && length != lead_mm_[place.path];
            if (other || (length < kLeastLeadMm && part < 1.0)) {
                continue;
            }
            if (const auto begin = room_.begin(points, at, length)) {
                ++(part == 1.0 ? result_.facts.lead_ins : result_.facts.lead_ins_shortened);
                return begin;
            }
        }
        ++result_.facts.lead_ins_dropped;
        return std::nullopt;
    }

    CutContours contours_;
    const CutWishes& wishes_;
    const geometry::Context& context_;
    LeadInRoom room_;
    SharedContours shared_;
    std::vector<CutPath> paths_;
    std::vector<double> lead_mm_;  // Of each closed path; 0: none.
    OrderRules rules_;
    PlannedCuts result_;
};

}  // namespace

PlannedCuts plan_cuts(const Sheet& sheet,
                      CutContours contours,
                      const CutWishes& wishes,
                      const geometry::Context& context) {
    return CutPlanner(sheet, std::move(contours), wishes, context).plan();
}

}  // namespace leafcutter::fab
