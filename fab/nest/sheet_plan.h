// Items and kinds of sheets, and the boards on which a search lays the ones onto the others. Any
// unit of length.

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/part.h"

namespace leafcutter::fab {

// Part of a sheet that is taken.
struct FixedRing {
    Ring ring;
    int quality = 0;
    bool solid = true;  // Else it binds only parts that want a higher quality.
};

// Sheets all alike; their bounds start at the origin.
struct SheetKind {
    double width = 0.0;
    double height = 0.0;
    std::vector<FixedRing> fixed;  // What surrounds an irregular outline, too.
    std::optional<int> quantity;   // None: as many as wanted.
    double cost = 0.0;
    double area = 0.0;  // Of what is not taken.

    bool is_plain() const { return fixed.empty(); }
};

struct SheetProblem {
    std::vector<NestPart> parts;
    std::vector<std::size_t> part_of;  // [item]
    std::vector<SheetKind> kinds;
};

// Where the items lie. A sheet's x axis points away from the edge that it is filled from.
struct SheetPacking {
    std::vector<std::size_t> kinds;   // [sheet]
    std::vector<Position> positions;  // [item]; bin: a sheet, -1: not laid.
};

// What is taken of each kind of sheet, as parts.
std::vector<std::vector<NestPart>> taken_parts(const SheetProblem& problem);

// The problem with every sheet turned clockwise by some quarters: a search fills sheets from the
// left, so that a quarter turn fills them from below.
class SheetFrame {
public:
    // `taken`: taken_parts(problem).
    SheetFrame(const SheetProblem& problem,
               const std::vector<std::vector<NestPart>>& taken,
               int quarters);

    // A board for these items, in that order, on such sheets.
    BoardPlan plan(std::span<const std::size_t> items, std::span<const std::size_t> kinds) const;

    // From the frame to the sheet as it is.
    Position on_sheet(const Position& position, std::size_t kind) const;

    const NestPart& part(std::size_t item) const { return parts_[problem_.part_of[item]]; }
    double width(std::size_t kind) const;
    double height(std::size_t kind) const;

private:
    std::vector<BoardPlan::Fixed> fixed_of(const SheetKind& kind,
                                           const std::vector<NestPart>& parts) const;

    const SheetProblem& problem_;
    int quarters_;
    std::vector<NestPart> parts_;
    std::vector<std::vector<TurnedPart>> turned_;       // [part][rotation]
    std::vector<std::vector<BoardPlan::Fixed>> fixed_;  // [kind]
};

}  // namespace leafcutter::fab
