#include "drivers/lihuiyu/encoder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "drivers/device.h"
#include "drivers/lihuiyu/packer.h"
#include "drivers/lihuiyu/runs.h"

namespace leafcutter::drivers {

namespace {

constexpr long kMostStepsOfRun = 6L * 255;  // Of one token: it has to fit into a packet.
constexpr long kShortTravel = 100;          // Steps: not worth a rapid move.
constexpr double kSpeedWithoutCutMmPerS = 20.0;

class Encoder {
public:
    Encoder(const StepPlace& start, const EncoderOptions& options)
        : options_(options),
          packer_(options.longest_burn_s),
          at_(start),
          goal_(start),
          written_(start) {}

    void add(const CutMove& move) {
        const StepPlace to = checked(move);
        if (!move.beam) {
            goal_ = to;
            return;
        }
        arrive(move);
        draw(to, true);
        goal_ = to;
    }

    EncodedJob finish() {
        if (!speed_ || !(at_ == goal_)) {
            flush_run();
            begin_section(speed_.value_or(kSpeedWithoutCutMmPerS), 0);
        }
        flush_run();
        EncodedJob job = packer_.finish();
        job.burn_mm = burnt_steps_ / options_.bed.steps_per_mm;
        return job;
    }

private:
    StepPlace checked(const CutMove& move) const {
        const LihuiyuBed& bed = options_.bed;
        const StepPlace place = to_steps(bed, move.x_mm, move.y_mm);
        const StepPlace corner{std::lround(bed.width_mm * bed.steps_per_mm),
                               std::lround(bed.height_mm * bed.steps_per_mm)};
        const bool inside =
            place.x >= 0 && place.y >= 0 && place.x <= corner.x && place.y <= corner.y;
        if (!std::isfinite(move.x_mm) || !std::isfinite(move.y_mm) || !inside) {
            throw ProgramRefused(
                fmt::format("line {}: X{:.3f} Y{:.3f} is off the bed ({:g} x {:g} mm, the "
                            "program's origin {:g} "
                            "mm right of and {:g} mm below the home corner)",
                            move.line, move.x_mm, move.y_mm, bed.width_mm, bed.height_mm,
                            bed.origin_x_mm, bed.origin_down_mm));
        }
        return place;
    }

    // To where a burning move begins, at its speed.
    void arrive(const CutMove& move) {
        const bool same_speed = speed_ && *speed_ == move.speed_mm_per_s;
        const long way = std::max(std::labs(goal_.x - at_.x), std::labs(goal_.y - at_.y));
        if (same_speed && way <= kShortTravel) {
            draw(goal_, false);
            return;
        }
        flush_run();
        begin_section(move.speed_mm_per_s, move.line);
    }

    void begin_section(double mm_per_s, std::size_t line) {
        std::string head = speed_ ? "@NSE" : "I";
        try {
            head += encode_speed(options_.speed, mm_per_s);
        } catch (const std::invalid_argument& error) {
            throw ProgramRefused(fmt::format("line {}: {}", line, error.what()));
        }
        head += encode_way({goal_.x - at_.x, goal_.y - at_.y});
        packer_.dark(head);
        const double way =
            static_cast<double>(std::max(std::labs(goal_.x - at_.x), std::labs(goal_.y - at_.y)));
        packer_.passed(way / options_.bed.steps_per_mm / options_.rapid_mm_per_s, goal_);
        packer_.dark("NRBS1E");
        at_ = written_ = goal_;
        speed_ = mm_per_s;
        x_letter_ = 'B';
        y_letter_ = 'R';
        // T of speed_code.h, whatever the step really is: the board counts steps, not mm.
        step_s_ = 0.0254 / mm_per_s;
    }

    void draw(const StepPlace& to, bool beam) {
        for (const Run& run : runs_of_line({to.x - at_.x, to.y - at_.y})) {
            const bool goes_on =
                run_.length > 0 && run_beam_ == beam && run_.dx == run.dx && run_.dy == run.dy;
            if (goes_on) {
                run_.length += run.length;
                continue;
            }
            flush_run();
            run_ = run;
            run_beam_ = beam;
        }
        at_ = to;
    }

    // Writes the run collected so far, in pieces that fit.
    void flush_run() {
        const bool diagonal = run_.dx != 0 && run_.dy != 0;
        const double step_s = step_s_ * (diagonal ? std::sqrt(2.0) : 1.0);
        const double most = std::max(std::floor(options_.longest_burn_s / step_s), 1.0);
        const long piece_most = run_beam_
                                    ? static_cast<long>(std::min<double>(most, kMostStepsOfRun))
                                    : kMostStepsOfRun;
        StepPlace place = written_;
        while (run_.length > 0) {
            const long piece = std::min(run_.length, piece_most);
            place.x += run_.dx * piece;
            place.y += run_.dy * piece;
            write_piece(piece, step_s * static_cast<double>(piece), place);
            run_.length -= piece;
        }
    }

    void write_piece(long steps, double seconds, const StepPlace& end) {
        const std::string token = letters() + encode_distance(steps);
        if (run_beam_) {
            packer_.lit(token, seconds);
            const double length = run_.dx != 0 && run_.dy != 0 ? std::sqrt(2.0) : 1.0;
            burnt_steps_ += length * static_cast<double>(steps);
        } else {
            packer_.dark(token);
        }
        packer_.passed(seconds, end);
        written_ = end;
    }

    std::string letters() {
        const char x = run_.dx < 0 ? 'T' : 'B';
        const char y = run_.dy < 0 ? 'L' : 'R';
        if (run_.dy == 0) {
            x_letter_ = x;
            return {x};
        }
        if (run_.dx == 0) {
            y_letter_ = y;
            return {y};
        }
        std::string text;
        if (x != x_letter_) {
            text += x_letter_ = x;
        }
        if (y != y_letter_) {
            text += y_letter_ = y;
        }
        return text + 'M';
    }

    EncoderOptions options_;
    Packer packer_;
    StepPlace at_;    // The end of what was drawn.
    StepPlace goal_;  // Where the moves have come to; ahead of at_ after moves with the beam off.
    StepPlace written_;  // The end of what is in packets.
    std::optional<double> speed_;
    double step_s_ = 1.0;
    Run run_;
    bool run_beam_ = false;
    char x_letter_ = 'B';
    char y_letter_ = 'R';
    double burnt_steps_ = 0.0;
};

}  // namespace

StepPlace to_steps(const LihuiyuBed& bed, double x_mm, double y_mm) {
    return {std::lround((bed.origin_x_mm + x_mm) * bed.steps_per_mm),
            std::lround((bed.origin_down_mm - y_mm) * bed.steps_per_mm)};
}

PlaceMm to_program_mm(const LihuiyuBed& bed, const StepPlace& place) {
    return {static_cast<double>(place.x) / bed.steps_per_mm - bed.origin_x_mm,
            bed.origin_down_mm - static_cast<double>(place.y) / bed.steps_per_mm};
}

EncodedJob encode_job(const std::vector<CutMove>& moves,
                      const StepPlace& start,
                      const EncoderOptions& options) {
    Encoder encoder(start, options);
    for (const CutMove& move : moves) {
        encoder.add(move);
    }
    return encoder.finish();
}

std::vector<Payload> encode_rapid(const StepPlace& from, const StepPlace& to) {
    const std::string text = fmt::format("I{}S1P", encode_way({to.x - from.x, to.y - from.y}));
    std::vector<Payload> packets;
    for (std::size_t at = 0; at < text.size(); at += kPayloadBytes) {
        packets.push_back(make_payload(std::string_view(text).substr(at, kPayloadBytes)));
    }
    // An M3 misreads a packet that ends in P.
    if (text.size() % kPayloadBytes == 0) {
        packets.push_back(make_payload("F"));
    }
    return packets;
}

}  // namespace leafcutter::drivers
