#include "fab/cut/certificate.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "fab/cut/piece_finder.h"
#include "fab/cut/piece_measure.h"
#include "fab/cut/sheet_reader.h"
#include "fab/cut/virtual_weave.h"
#include "fab/strips/unfold.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector3d;

std::size_t index(int value) {
    return static_cast<std::size_t>(value);
}

class Certifier {
public:
    Certifier(const JobResult& job, const geometry::Context& context)
        : job_(job),
          context_(context),
          finder_(job.pieces, {job.weft.kerf_mm, job.warp.kerf_mm}),
          found_(job.pieces.size()) {
        for (const Strip& strip : job.strips) {
            strips_[strip.id] = &strip;
        }
        certificate_.pieces = static_cast<int>(job.pieces.size());
        certificate_.diagonal_mm = diagonal_of(job.quads.vertices);
    }

    void add_program(const std::string& gcode) {
        BurntSheet sheet = read_sheet(gcode);
        for (BurntPiece& piece : sheet.pieces) {
            context_.check();
            read_.push_back(read_piece(std::move(piece)));
        }
        stray_lines_ += sheet.stray_lines;
    }

    Certificate result() {
        match_by_id();
        match_by_shape();
        if (stray_lines_ > 0) {
            fault(fmt::format("{} lines are burnt outside every piece", stray_lines_));
        }
        for (std::size_t i = 0; i < found_.size(); ++i) {
            context_.check();
            if (!found_[i]) {
                ++certificate_.missing;
                fault(fmt::format("{}: no sheet holds it", job_.pieces[i].id));
                continue;
            }
            check_outline(*found_[i]);
            measure(*found_[i]);
        }
        weave();
        conclude();
        return std::move(certificate_);
    }

private:
    void fault(std::string words) { faults_.push_back(std::move(words)); }

    void match_by_id() {
        for (std::size_t i = 0; i < read_.size(); ++i) {
            context_.check();
            const ReadPiece& read = read_[i];
            const auto piece = read.id.empty() ? std::nullopt : finder_.named(read.id);
            if (!piece) {
                certificate_.unread += read.id.empty() ? 1 : 0;
                if (!read.id.empty()) {
                    fault(fmt::format("{} is engraved on a piece, but there is none", read.id));
                }
                nameless_.push_back(i);
                continue;
            }
            auto laid = finder_.lay(read, *piece);
            if (!laid) {
                nameless_.push_back(i);
                continue;
            }
            std::optional<FoundPiece>& found = found_[*piece];
            if (found) {
                ++certificate_.duplicates;
                fault(fmt::format("{}: two contours bear its id", read.id));
            } else {
                ++certificate_.matched_by_id;
            }
            if (!found || laid->miss_mm < found->registration.miss_mm) {
                found = FoundPiece{i, *piece, true, std::move(*laid)};
            }
        }
    }

    void match_by_shape() {
        std::vector<char> free(found_.size());
        for (std::size_t i = 0; i < found_.size(); ++i) {
            free[i] = found_[i] ? 0 : 1;
        }
        for (const std::size_t i : nameless_) {
            context_.check();
            auto found = finder_.by_shape(read_[i], free);
            if (!found && read_[i].burnt.in_net && read_[i].burnt.marks.empty()) {
                --certificate_.unread;
                continue;  // Waste between pieces.
            }
            if (!found) {
                ++certificate_.extra_contours;
                fault(fmt::format("a contour of {} corners is no piece of this job",
                                  read_[i].burnt.contour.size()));
                continue;
            }
            ++certificate_.matched_by_shape;
            found->read = i;
            free[found->piece] = 0;
            found_[found->piece] = std::move(*found);
        }
    }

    // What is wrong with a contour that is not its piece's outline.
    void check_outline(const FoundPiece& found) {
        const Piece& piece = job_.pieces[found.piece];
        const ReadPiece& read = read_[found.read];
        const int passes = std::max(1, job_.material_of(piece.family).cut.passes);
        if (read.burnt.times > passes) {
            ++certificate_.duplicates;
            fault(fmt::format("{}: is cut {} times in one place", piece.id, read.burnt.times));
        }
        const double miss = found.registration.miss_mm;
        certificate_.largest_outline_error_mm =
            std::max(certificate_.largest_outline_error_mm, miss);
        if (miss <= kLargestOutlineMm) {
            return;
        }
        const auto turned = finder_.lay_mirrored(read, found.piece);
        if (turned && turned->miss_mm <= kLargestOutlineMm) {
            ++certificate_.mirrored;
            fault(fmt::format("{}: its contour is mirrored", piece.id));
            return;
        }
        const std::vector<char> all(found_.size(), 1);
        const auto other = finder_.by_shape(read, all);
        fault(other ? fmt::format("{}: is engraved on the contour of {}", piece.id,
                                  job_.pieces[other->piece].id)
                    : fmt::format("{}: its contour is off by {:.3f} mm", piece.id, miss));
    }

    void measure(const FoundPiece& found) {
        const Piece& piece = job_.pieces[found.piece];
        std::vector<BurntSegment> marks = read_[found.read].reading.rest;
        for (BurntSegment& mark : marks) {
            mark.from = found.registration.motion.apply(mark.from);
            mark.to = found.registration.motion.apply(mark.to);
        }
        const MeasuredPiece measured =
            measure_piece(piece, finder_.edge(found.piece), found.registration.contour, marks);
        certificate_.filled_notches += measured.filled_notches;
        check_ticks(piece, measured);
        const std::vector<WalkedCell> cells = walk_cells(job_.quads, *strips_.at(piece.strip));
        for (std::size_t i = 0; i < measured.cells.size(); ++i) {
            const WalkedCell& cell = cells[(index(piece.first_cell) + i) % cells.size()];
            const CellLengths& lengths = measured.cells[i];
            const bool rises = piece.fold_rises[i] != 0;
            if (i == 0) {
                lengths_.push_back({cell.l0, cell.r0, lengths.first_rung, piece.family});
            }
            lengths_.push_back({cell.l1, cell.r1, lengths.last_rung, piece.family});
            lengths_.push_back({cell.l0, cell.l1, lengths.left, piece.family});
            lengths_.push_back({cell.r0, cell.r1, lengths.right, piece.family});
            lengths_.push_back(
                {rises ? cell.r0 : cell.l0, rises ? cell.l1 : cell.r1, lengths.fold, piece.family});
        }
    }

    void check_ticks(const Piece& piece, const MeasuredPiece& measured) {
        certificate_.ticks += measured.ticks;
        certificate_.largest_tick_error_mm =
            std::max(certificate_.largest_tick_error_mm, measured.largest_tick_miss_mm);
        if (measured.largest_tick_miss_mm > kLargestTickMm) {
            fault(fmt::format("{}: a tick is off by {:.3f} mm", piece.id,
                              measured.largest_tick_miss_mm));
        }
        certificate_.ticks_missing += measured.ticks_missing;
        if (measured.ticks_missing > 0) {
            fault(fmt::format("{}: {} ticks are missing", piece.id, measured.ticks_missing));
        }
    }

    void weave() {
        const std::vector<Vector3d>& plan = job_.quads.vertices;
        for (const MeasuredLength& length : lengths_) {
            const double planned = (plan[index(length.from)] - plan[index(length.to)]).norm();
            certificate_.largest_length_error_mm =
                std::max(certificate_.largest_length_error_mm, std::abs(length.mm - planned));
        }
        certificate_.edges_compared = static_cast<int>(lengths_.size());
        certificate_.largest_disagreement_mm = largest_disagreement_mm(lengths_);
        const std::vector<Vector3d> woven = weave_virtually(job_.quads, lengths_, context_);
        for (std::size_t i = 0; i < plan.size(); ++i) {
            certificate_.largest_deviation_mm =
                std::max(certificate_.largest_deviation_mm, (woven[i] - plan[i]).norm());
        }
    }

    void conclude() {
        Certificate& result = certificate_;
        const bool whole = result.missing == 0 && result.diagonal_mm > 0.0;
        result.largest_deviation_relative =
            whole ? result.largest_deviation_mm / result.diagonal_mm : 1.0;
        if (whole && result.largest_deviation_relative > kLargestDeviation) {
            fault(fmt::format("the surface comes out {:.2g} of its diagonal off",
                              result.largest_deviation_relative));
        }
        const bool ids = result.matched_by_id > 0;
        const bool shapes = result.matched_by_shape > 0;
        result.matched_by = ids      ? (shapes ? "ids and shapes" : "ids")
                            : shapes ? "shapes"
                                     : "nothing";
        result.holds = faults_.empty();
        const std::size_t told = std::min(faults_.size(), kMostFaults);
        result.faults.assign(faults_.begin(), faults_.begin() + static_cast<std::ptrdiff_t>(told));
        if (told < faults_.size()) {
            result.faults.push_back(fmt::format("and {} more", faults_.size() - told));
        }
    }

    const JobResult& job_;
    const geometry::Context& context_;
    PieceFinder finder_;
    std::map<std::string_view, const Strip*> strips_;
    std::vector<ReadPiece> read_;
    std::vector<std::size_t> nameless_;
    std::vector<std::optional<FoundPiece>> found_;  // Per piece.
    std::vector<MeasuredLength> lengths_;
    std::vector<std::string> faults_;
    int stray_lines_ = 0;
    Certificate certificate_;
};

}  // namespace

Certificate certify(const JobResult& job,
                    std::span<const std::string> gcode,
                    const geometry::Context& context) {
    Certifier certifier(job, context);
    for (const std::string& program : gcode) {
        certifier.add_program(program);
    }
    return certifier.result();
}

}  // namespace leafcutter::fab
