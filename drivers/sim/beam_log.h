// What a simulated laser burnt: one record per piece of motion with the beam on.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace leafcutter::drivers {

// Work coordinates in mm. A beam that stands still while lit is a piece of no length with feed 0.
struct BurntPiece {
    double t0_s = 0.0;
    double t1_s = 0.0;
    double x0_mm = 0.0;
    double y0_mm = 0.0;
    double x1_mm = 0.0;
    double y1_mm = 0.0;
    double s = 0.0;                // The S word in force, after the power override.
    double s_mean = 0.0;           // The power really put out: M4 scales it with the speed.
    double feed_mm_per_min = 0.0;  // As programmed.
};

// One line of JSON, without its line end.
std::string write_json(const BurntPiece& piece);

// Pieces not yet written are kept until flush(); all of them stay readable until forget().
class BeamLog {
public:
    void add(const BurntPiece& piece) { pieces_.push_back(piece); }
    const std::vector<BurntPiece>& pieces() const { return pieces_; }

    // Appends the pieces added since the last call as JSON lines.
    void flush(std::ostream& out);

    // Drops all pieces, written or not.
    void forget();

private:
    std::vector<BurntPiece> pieces_;
    std::size_t flushed_ = 0;
};

}  // namespace leafcutter::drivers
