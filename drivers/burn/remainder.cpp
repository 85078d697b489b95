#include "drivers/burn/remainder.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "drivers/grbl/program.h"
#include "drivers/sim/gcode_interpreter.h"

namespace leafcutter::drivers {

namespace {

using Modal = GcodeInterpreter::Modal;
using Motion = GcodeInterpreter::Motion;

constexpr double kTinyMm = 1e-6;

// The modes in force once the first lines are done.
struct Modes {
    Modal modal;
    std::string beam_word;  // As the program writes it, "M4" or Marlin's "M4 I1"; empty: none.
};

std::string beam_word_of(const GcodeWords& line, const std::string& before) {
    std::string beam = before;
    std::string inline_word;
    for (const GcodeWord& word : line.words) {
        if (word.letter == 'M' && word.value >= 3.0 && word.value <= 5.0) {
            beam = word.value == 5.0 ? "" : fmt::format("M{:.0f}", word.value);
        } else if (word.letter == 'I') {
            inline_word = fmt::format(" I{:.0f}", word.value);
        }
    }
    return beam.empty() || beam == before ? beam : beam + inline_word;
}

Modes modes_after(const Program& program, std::size_t lines) {
    Modes modes;
    GcodeInterpreter interpreter;
    for (std::size_t i = 0; i < lines; ++i) {
        const std::string& text = program.lines[i].text;
        interpreter.run(without_inline_word(text), {});
        modes.beam_word = beam_word_of(split_words(text), modes.beam_word);
    }
    modes.modal = interpreter.modal();
    if (modes.modal.inverse_time) {
        throw NotTraceable("a program in inverse time (G93) can't be taken up in its middle");
    }
    return modes;
}

// The modes that the seam itself was not written in.
std::string modes_of_program(const Modal& modal) {
    std::string text;
    text += modal.plane == 17 ? "" : fmt::format("G{}\n", modal.plane);
    text += modal.inches ? "G20\n" : "";
    text += modal.relative ? "G91\n" : "";
    return text;
}

// The lines behind the seam; the first that relies on the motion word of one before it gets it.
std::string lines_from(const Program& program, std::size_t first, Motion motion) {
    std::string text;
    bool open = motion != Motion::Linear && motion != Motion::None;
    for (std::size_t i = first; i < program.lines.size(); ++i) {
        const std::string& line = program.lines[i].text;
        if (open) {
            bool axis = false;
            bool says = false;
            for (const GcodeWord& word : split_words(line).words) {
                says = says || (word.letter == 'G' && word.value < 4.0);
                axis = axis || word.letter == 'X' || word.letter == 'Y' || word.letter == 'Z';
            }
            text += axis && !says ? fmt::format("G{}", static_cast<int>(motion)) : "";
            open = !axis && !says;
        }
        text += line;
        text += '\n';
    }
    return text;
}

// The piece in which more than that is burnt.
std::size_t piece_of_burn(const BeamPath& path, double burnt_mm) {
    const auto found = std::upper_bound(
        path.pieces().begin(), path.pieces().end(), burnt_mm + kTinyMm,
        [](double burnt, const PathPiece& piece) { return burnt < piece.burnt_end_mm; });
    return static_cast<std::size_t>(found - path.pieces().begin());
}

// Back by the overlap, to the beginning of the stroke at most.
double seam(const BeamPath& path, double burnt_mm, double overlap_mm) {
    std::size_t piece = piece_of_burn(path, burnt_mm);
    const double way = path.pieces()[piece].end_mm - path.pieces()[piece].burnt_end_mm + burnt_mm;
    while (piece > 0 && path.pieces()[piece - 1].burns && path.begin_mm(piece) > way - overlap_mm) {
        --piece;
    }
    return std::max(way - overlap_mm, path.begin_mm(piece));
}

// The rest of the line that the seam lies in, in absolute millimetres.
std::string rest_of_line(const BeamPath& path, std::size_t first) {
    std::string text;
    const std::size_t line = path.pieces()[first].line;
    for (std::size_t i = first; i < path.pieces().size() && path.pieces()[i].line == line; ++i) {
        const PathPiece& piece = path.pieces()[i];
        fmt::format_to(std::back_inserter(text), "G1 X{:.4f} Y{:.4f}", piece.to_mm[0],
                       piece.to_mm[1]);
        if (i == first) {
            fmt::format_to(std::back_inserter(text), " S{:g} F{:g}", piece.power_s,
                           piece.feed_mm_per_min);
        }
        text += '\n';
    }
    return text;
}

}  // namespace

std::string remainder_program(std::string_view program_text,
                              double burnt_mm,
                              const RemainderOptions& options) {
    const BeamPath path(program_text, options.start_mm);
    burnt_mm = std::max(0.0, burnt_mm);
    if (burnt_mm + kTinyMm >= path.burn_mm()) {
        return {};
    }
    const Program program = read_program(program_text);
    const double way = seam(path, burnt_mm, options.overlap_mm);
    const std::size_t piece = path.piece_at(way + kTinyMm);
    const std::size_t line = path.pieces()[piece].line;
    const Modes modes = modes_after(program, line + 1);
    const Point start = path.point_at(way);
    std::string text = fmt::format(
        "; Leafcutter: the rest from line {} on, {:.1f} of {:.1f} mm are burnt\n"
        "G21\nG90\n{}{}G0 X{:.4f} Y{:.4f} S0\n",
        program.lines[line].number, burnt_mm, path.burn_mm(),
        // A program without a beam word is Smoothieware's, whose laser goes with the moves alone.
        modes.beam_word.empty() ? "" : "M5 S0\n", modes.modal.flood ? "M8\n" : "", start[0],
        start[1]);
    if (!modes.beam_word.empty()) {
        text += modes.beam_word + " S0\n";
    }
    text += rest_of_line(path, piece);
    text += modes_of_program(modes.modal);
    text += lines_from(program, line + 1, modes.modal.motion);
    return text;
}

}  // namespace leafcutter::drivers
