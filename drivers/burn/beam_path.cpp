#include "drivers/burn/beam_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "drivers/grbl/program.h"
#include "drivers/sim/gcode_interpreter.h"

namespace leafcutter::drivers {

namespace {

constexpr double kTinyMm = 1e-9;

bool turns_beam_on(const Program& program) {
    const auto lights = [](const GcodeWord& word) {
        return word.letter == 'M' && (word.value == 3.0 || word.value == 4.0);
    };
    return std::any_of(program.lines.begin(), program.lines.end(), [&](const ProgramLine& line) {
        const GcodeWords words = split_words(line.text);
        return std::any_of(words.words.begin(), words.words.end(), lights);
    });
}

bool homes(const std::string& stripped) {
    const GcodeWords words = split_words(stripped);
    return std::any_of(words.words.begin(), words.words.end(), [](const GcodeWord& word) {
        return word.letter == 'G' && std::floor(word.value) == 28.0;
    });
}

}  // namespace

BeamPath::BeamPath(std::string_view program_text, const Point& start_mm) : start_mm_(start_mm) {
    const Program program = read_program(program_text);
    const GcodeInterpreter::Rules rules{};
    GcodeInterpreter interpreter;
    interpreter.set_position({start_mm[0], start_mm[1], 0.0});
    if (!turns_beam_on(program)) {
        interpreter.run("M4S0", rules);  // Smoothieware: the power word alone lights the beam.
    }
    line_ends_.reserve(program.lines.size());
    for (const ProgramLine& line : program.lines) {
        const auto refuse = [&](std::string_view what) {
            throw NotTraceable(fmt::format("line {} ({}): {}", line.number, line.text, what));
        };
        const Interpretation read = interpreter.run(without_inline_word(line.text), rules);
        if (read.error != 0) {
            refuse(fmt::format("no controller takes it (error {})", read.error));
        }
        for (const Action& action : read.actions) {
            if (action.kind == Action::Kind::Offset || homes(line.text)) {
                refuse("a program that moves its own origin can't be followed");
            }
            if (action.kind == Action::Kind::Move) {
                const Move& move = action.move;
                PathPiece kind;
                kind.line = static_cast<std::uint32_t>(line_ends_.size());
                kind.feed_mm_per_min = static_cast<float>(move.feed_mm_per_min);
                kind.power_s = static_cast<float>(move.power_s);
                kind.rapid = move.rapid;
                kind.burns = !move.rapid && move.beam != BeamMode::Off && move.power_s > 0.0;
                add({move.target_mm[0], move.target_mm[1]}, kind);
            }
        }
        line_ends_.push_back(static_cast<std::uint32_t>(pieces_.size()));
    }
}

void BeamPath::add(const Point& to_mm, const PathPiece& kind) {
    const Point& from = from_mm(pieces_.size());
    const double length = std::hypot(to_mm[0] - from[0], to_mm[1] - from[1]);
    if (length < kTinyMm) {
        return;
    }
    PathPiece piece = kind;
    piece.to_mm = to_mm;
    piece.end_mm = length_mm() + length;
    piece.burnt_end_mm = burn_mm() + (kind.burns ? length : 0.0);
    pieces_.push_back(piece);
}

std::size_t BeamPath::pieces_after(std::size_t lines) const {
    const std::size_t most = std::min(lines, line_ends_.size());
    return most == 0 ? 0 : line_ends_[most - 1];
}

double BeamPath::way_after(std::size_t lines) const {
    return begin_mm(pieces_after(lines));
}

std::size_t BeamPath::piece_at(double way_mm) const {
    const auto found =
        std::lower_bound(pieces_.begin(), pieces_.end(), way_mm - kTinyMm,
                         [](const PathPiece& piece, double way) { return piece.end_mm < way; });
    const auto index = static_cast<std::size_t>(found - pieces_.begin());
    return std::min(index, pieces_.size() - 1);
}

Point BeamPath::point_at(double way_mm) const {
    if (pieces_.empty()) {
        return start_mm_;
    }
    const std::size_t index = piece_at(way_mm);
    const PathPiece& piece = pieces_[index];
    const Point& from = from_mm(index);
    const double begin = begin_mm(index);
    const double part = std::clamp((way_mm - begin) / (piece.end_mm - begin), 0.0, 1.0);
    return {from[0] + part * (piece.to_mm[0] - from[0]),
            from[1] + part * (piece.to_mm[1] - from[1])};
}

std::size_t BeamPath::line_at(double way_mm) const {
    return pieces_.empty() ? 0 : pieces_[piece_at(way_mm)].line;
}

double BeamPath::burnt_at(double way_mm) const {
    if (pieces_.empty()) {
        return 0.0;
    }
    const PathPiece& piece = pieces_[piece_at(way_mm)];
    const double left = std::max(0.0, piece.end_mm - way_mm);
    return std::max(0.0, piece.burnt_end_mm - (piece.burns ? left : 0.0));
}

double BeamPath::burnt_after(std::size_t lines) const {
    const std::size_t pieces = pieces_after(lines);
    return pieces == 0 ? 0.0 : pieces_[pieces - 1].burnt_end_mm;
}

double BeamPath::feed_after(std::size_t lines) const {
    const std::size_t next = pieces_after(lines);
    return next < pieces_.size() ? pieces_[next].feed_mm_per_min : 0.0;
}

double BeamPath::way_of_burn(double burnt_mm) const {
    const auto found = std::lower_bound(
        pieces_.begin(), pieces_.end(), burnt_mm,
        [](const PathPiece& piece, double burnt) { return piece.burnt_end_mm < burnt; });
    if (found == pieces_.end() || burnt_mm <= 0.0) {
        return burnt_mm <= 0.0 ? 0.0 : length_mm();
    }
    return found->end_mm - (found->burnt_end_mm - burnt_mm);
}

}  // namespace leafcutter::drivers
