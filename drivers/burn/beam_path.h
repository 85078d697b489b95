// The way that a program's head goes, as one line from its start to its end: the measure of how far
// a cut got. Pure.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace leafcutter::drivers {

// The program does what can't be followed from outside: it moves its own origin, homes, or holds a
// line that no controller takes.
class NotTraceable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

using Point = std::array<double, 2>;  // X and Y in work mm.

// A straight piece of the way; begins where the one before it ends.
struct PathPiece {
    Point to_mm{};
    double end_mm = 0.0;        // Way of the head up to its end.
    double burnt_end_mm = 0.0;  // Of that, with the beam on.
    float feed_mm_per_min = 0.0F;
    float power_s = 0.0F;
    std::uint32_t line = 0;  // From 0, as JobProgress counts the lines of a program.
    bool burns = false;
    bool rapid = false;
};

class BeamPath {
public:
    // `start_mm`: where the head stands before the first line. Throws ProgramRefused, NotTraceable.
    explicit BeamPath(std::string_view program, const Point& start_mm = {});

    const std::vector<PathPiece>& pieces() const { return pieces_; }
    std::size_t lines() const { return line_ends_.size(); }
    double length_mm() const { return pieces_.empty() ? 0.0 : pieces_.back().end_mm; }
    double burn_mm() const { return pieces_.empty() ? 0.0 : pieces_.back().burnt_end_mm; }

    // Where a piece begins.
    const Point& from_mm(std::size_t piece) const {
        return piece == 0 ? start_mm_ : pieces_[piece - 1].to_mm;
    }
    double begin_mm(std::size_t piece) const {
        return piece == 0 ? 0.0 : pieces_[piece - 1].end_mm;
    }

    // The way once the first `lines` lines are done.
    double way_after(std::size_t lines) const;

    // The piece that `way_mm` lies on, the earlier one at a corner. Needs at least one piece.
    std::size_t piece_at(double way_mm) const;
    Point point_at(double way_mm) const;
    std::size_t line_at(double way_mm) const;

    double burnt_at(double way_mm) const;
    double burnt_after(std::size_t lines) const;

    // The feed of the first move behind so many lines; 0: there is none.
    double feed_after(std::size_t lines) const;

    // The first place where that much is burnt; the inverse of burnt_at().
    double way_of_burn(double burnt_mm) const;

private:
    void add(const Point& to_mm, const PathPiece& kind);
    std::size_t pieces_after(std::size_t lines) const;

    Point start_mm_;
    std::vector<PathPiece> pieces_;
    std::vector<std::uint32_t> line_ends_;  // Pieces once that line is done.
};

}  // namespace leafcutter::drivers
