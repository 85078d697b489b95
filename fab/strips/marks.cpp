#include "fab/strips/marks.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "fab/strips/piece_marker.h"

namespace leafcutter::fab {

namespace {

constexpr std::size_t kMostNamed = 12;  // Strips that a warning names.

// 12 of "W12".
int number_of(std::string_view id) {
    int number = 0;
    std::from_chars(id.data() + std::min<std::size_t>(1, id.size()), id.data() + id.size(), number);
    return number;
}

class FactFinder {
public:
    FactFinder(std::span<const Strip> strips, const Crossings& crossings)
        : strips_(strips), crossings_(crossings) {
        for (std::size_t i = 0; i < strips.size(); ++i) {
            index_.emplace(strips[i].id, i);
        }
    }

    MarkFacts facts_of(const Piece& piece) const {
        MarkFacts facts;
        const std::size_t index = index_.at(piece.strip);
        const std::vector<Crossing>& crossings = crossings_[index];
        for (int i = 0; i < piece.cell_count; ++i) {
            const auto cell = static_cast<std::size_t>(piece.first_cell + i) % crossings.size();
            const std::string& id = strips_[static_cast<std::size_t>(crossings[cell].strip)].id;
            facts.crossing.emplace_back(id);
            facts.numbers.push_back(number_of(id));
            facts.under.push_back(crossings[cell].on_top ? 0 : 1);
        }
        facts.before = piece.start_tab.onto;
        facts.behind =
            piece.end_tab.onto.empty() ? follower(strips_[index], piece.id) : piece.end_tab.onto;
        return facts;
    }

private:
    // The piece that follows `id` in its strip, or else the strip that follows.
    static std::string follower(const Strip& strip, const std::string& id) {
        const auto at = std::find(strip.pieces.begin(), strip.pieces.end(), id);
        if (at != strip.pieces.end() && at + 1 != strip.pieces.end()) {
            return *(at + 1);
        }
        return strip.closed && !strip.pieces.empty() ? strip.pieces.front() : strip.next;
    }

    std::span<const Strip> strips_;
    const Crossings& crossings_;
    std::unordered_map<std::string_view, std::size_t> index_;
};

std::string listed(const std::vector<std::string>& names) {
    std::string list;
    for (std::size_t i = 0; i < std::min(kMostNamed, names.size()); ++i) {
        fmt::format_to(std::back_inserter(list), "{}{}", i == 0 ? "" : ", ", names[i]);
    }
    if (names.size() > kMostNamed) {
        fmt::format_to(std::back_inserter(list), " and {} more", names.size() - kMostNamed);
    }
    return list;
}

void tell(const MarksLeftOut& left_out, std::vector<std::string>& warnings) {
    if (!left_out.unnamed_strips.empty()) {
        warnings.push_back(fmt::format(
            "too narrow or too bent for any label, so tell them by the guide's drawings: {}",
            listed(left_out.unnamed_strips)));
    }
    if (left_out.rungs > 0) {
        warnings.push_back(fmt::format(
            "cells too short for tick marks: {} pairs of ticks are left out", left_out.rungs));
    }
    if (left_out.weave_marks > 0) {
        warnings.push_back(
            fmt::format("cells too small for a weave mark: {} bars are left out, follow the guide "
                        "there",
                        left_out.weave_marks));
    }
}

}  // namespace

MarksLeftOut mark_pieces(std::span<Piece> pieces,
                         std::span<const Strip> strips,
                         const Crossings& crossings,
                         const FitParams& fit,
                         std::vector<std::string>& warnings) {
    const FactFinder finder(strips, crossings);
    MarksLeftOut left_out;
    for (Piece& piece : pieces) {
        PieceMarks made = marks_of(piece, finder.facts_of(piece), fit);
        std::move(made.marks.begin(), made.marks.end(), std::back_inserter(piece.marks));
        left_out.rungs += made.bare_rungs;
        left_out.weave_marks += made.bare_weave_cells;
        std::vector<std::string>& unnamed = left_out.unnamed_strips;
        if (!made.is_named && (unnamed.empty() || unnamed.back() != piece.strip)) {
            unnamed.push_back(piece.strip);
        }
    }
    tell(left_out, warnings);
    return left_out;
}

}  // namespace leafcutter::fab
