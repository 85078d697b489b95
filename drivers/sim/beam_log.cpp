#include "drivers/sim/beam_log.h"

#include <ostream>

#include <fmt/format.h>

namespace leafcutter::drivers {

std::string write_json(const BurntPiece& piece) {
    return fmt::format(
        R"({{"t_s":{:.4f},"x0":{:.4f},"y0":{:.4f},"x1":{:.4f},"y1":{:.4f},"s":{:.4f},"feed":{:.4f},)"
        R"("t1_s":{:.4f},"s_mean":{:.4f}}})",
        piece.t0_s, piece.x0_mm, piece.y0_mm, piece.x1_mm, piece.y1_mm, piece.s,
        piece.feed_mm_per_min, piece.t1_s, piece.s_mean);
}

void BeamLog::flush(std::ostream& out) {
    if (flushed_ == pieces_.size()) {
        return;
    }
    for (; flushed_ < pieces_.size(); ++flushed_) {
        out << write_json(pieces_[flushed_]) << '\n';
    }
    out.flush();
}

void BeamLog::forget() {
    pieces_.clear();
    flushed_ = 0;
}

}  // namespace leafcutter::drivers
