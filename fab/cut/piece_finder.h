// Which piece each burnt contour is: by the id engraved on it, else by its shape.

#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fab/cut/registration.h"
#include "fab/cut/sheet_reader.h"
#include "fab/cut/text_reader.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// A contour with what is written in it.
struct ReadPiece {
    BurntPiece burnt;
    Reading reading;
    std::string id;  // Empty: none could be read.
};

ReadPiece read_piece(BurntPiece burnt);

// The piece's own id among the texts on it, empty if there is none: "W12.1", of several the one
// that is there most often, then the tallest.
std::string own_id(const std::vector<ReadText>& texts);

// A contour laid onto a piece.
struct FoundPiece {
    std::size_t read = 0;   // Into the contours.
    std::size_t piece = 0;  // Into the pieces.
    bool by_id = true;
    Registration registration;
};

class PieceFinder {
public:
    // `pieces` outlives the finder. `kerf_mm` of weft and warp.
    PieceFinder(std::span<const Piece> pieces, std::array<double, 2> kerf_mm);

    // The piece of that id.
    std::optional<std::size_t> named(const std::string& id) const;

    // Its outline with the notches filled that the beam can't open.
    const Ring& edge(std::size_t piece) const { return outlines_[piece]; }

    // Lays the contour onto the piece; texts on it tell how, or else its shape. None if nothing is
    // left of it without the kerf.
    std::optional<Registration> lay(const ReadPiece& read, std::size_t piece) const;

    // The same for the contour turned over.
    std::optional<Registration> lay_mirrored(const ReadPiece& read, std::size_t piece) const;

    // Among the pieces for which `free` holds, the one whose outline the contour is.
    std::optional<FoundPiece> by_shape(const ReadPiece& read, const std::vector<char>& free) const;

private:
    double kerf_of(std::size_t piece) const;

    std::span<const Piece> pieces_;
    std::array<double, 2> kerf_mm_;
    std::map<std::string, std::size_t, std::less<>> by_id_;
    std::vector<Ring> outlines_;  // As burnt.
    std::vector<ShapeKey> keys_;
    std::vector<std::size_t> by_area_;
};

}  // namespace leafcutter::fab
