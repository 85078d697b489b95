// What moves do to a tour: which of them precedence allows, how they are made and taken back.

#include <algorithm>

#include "fab/cut/tour_search.h"

namespace leafcutter::fab {

namespace {

std::ptrdiff_t offset(std::size_t i) {
    return static_cast<std::ptrdiff_t>(i);
}

}  // namespace

bool TourSearch::may_reverse(std::size_t first, std::size_t last) const {
    if (earlier_.empty()) {
        return true;
    }
    for (std::size_t i = first + 1; i <= last; ++i) {
        for (const std::size_t other : earlier_[order_[i]]) {
            if (position_[other] >= first) {
                return false;
            }
        }
    }
    return true;
}

// Whether [middle, high) may come before [low, middle).
bool TourSearch::may_pass(std::size_t low, std::size_t middle, std::size_t high) const {
    if (earlier_.empty()) {
        return true;
    }
    if (middle - low <= high - middle) {
        for (std::size_t i = low; i < middle; ++i) {
            for (const std::size_t other : later_[order_[i]]) {
                if (position_[other] < high) {
                    return false;
                }
            }
        }
        return true;
    }
    for (std::size_t i = middle; i < high; ++i) {
        for (const std::size_t other : earlier_[order_[i]]) {
            if (position_[other] >= low) {
                return false;
            }
        }
    }
    return true;
}

void TourSearch::choose(std::size_t place, std::size_t start) {
    if (writes_journal_) {
        journal_.push_back({0, place, 0, start_[place], false});
    }
    start_[place] = start;
    entry_[place] = problem_.places[place].starts[start].entry;
    exit_[place] = problem_.places[place].starts[start].exit;
}

void TourSearch::reverse(std::size_t first, std::size_t last) {
    if (writes_journal_) {
        journal_.push_back({first, 0, last + 1, 0, true});
    }
    turn_over(first, last);
}

void TourSearch::turn_over(std::size_t first, std::size_t last) {
    std::reverse(order_.begin() + offset(first), order_.begin() + offset(last) + 1);
    for (std::size_t i = first; i <= last; ++i) {
        const std::size_t place = order_[i];
        position_[place] = i;
        if (problem_.places[place].open) {
            start_[place] = 1 - start_[place];
            std::swap(entry_[place], exit_[place]);
        }
    }
}

void TourSearch::rotate(std::size_t low, std::size_t middle, std::size_t high) {
    if (writes_journal_) {
        journal_.push_back({low, middle, high, 0, false});
    }
    std::rotate(order_.begin() + offset(low), order_.begin() + offset(middle),
                order_.begin() + offset(high));
    for (std::size_t i = low; i < high; ++i) {
        position_[order_[i]] = i;
    }
}

void TourSearch::undo() {
    writes_journal_ = false;
    while (!journal_.empty()) {
        const Step step = journal_.back();
        journal_.pop_back();
        if (step.high == 0) {
            choose(step.middle, step.start);
        } else if (step.reversed) {
            turn_over(step.low, step.high - 1);
        } else {
            rotate(step.low, step.low + step.high - step.middle, step.high);
        }
    }
    writes_journal_ = true;
}

}  // namespace leafcutter::fab
