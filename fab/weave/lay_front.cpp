#include "fab/weave/lay_front.h"

#include <algorithm>

namespace leafcutter::fab {

namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

std::vector<std::vector<int>> segments_of(const Strip& strip, const std::vector<int>& joints) {
    const int count = static_cast<int>(strip.quads.size());
    std::vector<int> firsts = joints;
    if (!strip.closed) {
        firsts.insert(firsts.begin(), 0);
        firsts.erase(std::unique(firsts.begin(), firsts.end()), firsts.end());
    }
    std::vector<std::vector<int>> segments;
    for (std::size_t i = 0; i < firsts.size(); ++i) {
        const bool last = i + 1 == firsts.size();
        const int end = !last ? firsts[i + 1] : strip.closed ? firsts.front() + count : count;
        segments.emplace_back();
        for (int cell = firsts[i]; cell < end; ++cell) {
            segments.back().push_back(cell % count);
        }
    }
    return segments;
}

LayFront::LayFront(const LayProblem& problem, std::span<const int> members, Family base)
    : problem_(problem), places_(problem.strips.size()) {
    for (const int strip : members) {
        if (problem.strips[at(strip)].family == base) {
            add_base(strip);
        }
    }
    clear();
}

void LayFront::clear() {
    holds_.assign(segments_, {});
    laid_.assign(segment_of_.size(), 0);
    begun_.assign(problem_.strips.size(), 0);
}

int LayFront::threaded(const std::vector<LayStep>& steps, bool backwards) {
    int count = 0;
    journal_.clear();
    for (std::size_t i = 0; i < steps.size(); ++i) {
        count += meet(steps[backwards ? steps.size() - 1 - i : i]) ? 1 : 0;
    }
    while (!journal_.empty()) {
        holds_[journal_.back().first] = journal_.back().second;
        journal_.pop_back();
    }
    return count;
}

void LayFront::lay(const std::vector<LayStep>& steps, bool backwards) {
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const LayStep& step = steps[backwards ? steps.size() - 1 - i : i];
        meet(step);
        laid_[place(step)] = 1;
        begun_[at(step.strip)] = 1;
    }
    journal_.clear();
}

bool LayFront::leaves_gap(const LayStep& step) const {
    if (begun_[at(step.strip)] == 0) {
        return false;
    }
    const std::size_t first = places_[at(step.strip)];
    const auto beside = cells_beside(step);
    return std::none_of(beside.begin(), beside.end(),
                        [&](int cell) { return cell >= 0 && laid_[first + at(cell)] != 0; });
}

std::array<int, 2> LayFront::cells_beside(const LayStep& step) const {
    const Strip& strip = problem_.strips[at(step.strip)];
    const int count = static_cast<int>(strip.quads.size());
    const int before = step.cell > 0 ? step.cell - 1 : strip.closed ? count - 1 : -1;
    const int behind = step.cell + 1 < count ? step.cell + 1 : strip.closed ? 0 : -1;
    return {before, behind};
}

void LayFront::add_base(int index) {
    const Strip& strip = problem_.strips[at(index)];
    places_[at(index)] = segment_of_.size();
    segment_of_.resize(segment_of_.size() + strip.quads.size());
    rank_.resize(segment_of_.size());
    for (const auto& segment : segments_of(strip, problem_.joints[at(index)])) {
        int rank = 0;
        for (const int cell : segment) {
            segment_of_[places_[at(index)] + at(cell)] = segments_;
            rank_[places_[at(index)] + at(cell)] = rank++;
        }
        ++segments_;
    }
}

std::size_t LayFront::place(const LayStep& step) const {
    return places_[at(step.strip)] + at(step.cell);
}

// Whether the base strip there can't be folded back though it has to be; else, if it is held from
// now on, that is noted.
bool LayFront::meet(const LayStep& step) {
    const std::size_t index = place(step);
    Holds& holds = holds_[segment_of_[index]];
    const int rank = rank_[index];
    if (step.under) {
        return holds.first < rank && rank < holds.last;
    }
    journal_.emplace_back(segment_of_[index], holds);
    holds.first = std::min(holds.first, rank);
    holds.last = std::max(holds.last, rank);
    return false;
}

}  // namespace leafcutter::fab
