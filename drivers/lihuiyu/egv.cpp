#include "drivers/lihuiyu/egv.h"

#include <algorithm>

#include <fmt/format.h>

#include "drivers/device.h"
#include "drivers/lihuiyu/interpreter.h"

namespace leafcutter::drivers {

namespace {

constexpr std::string_view kFirstLine = "Document type : LHYMICRO-GL file";
constexpr std::string_view kHeader =
    "Document type : LHYMICRO-GL file\n"
    "File version: 1.0.01\n"
    "Copyright: none\n"
    "Creator-Software: Leafcutter\n"
    "\n"
    "%0%0%0%0%";

// What comes behind the fifth %.
std::string_view body_of(std::string_view text) {
    for (int percent = 0; percent < 5; ++percent) {
        const std::size_t found = text.find('%');
        if (found == std::string_view::npos) {
            throw ProgramRefused("EGV: the line %0%0%0%0% before the program is missing");
        }
        text.remove_prefix(found + 1);
    }
    return text;
}

class EgvReader {
public:
    EgvReader(const SpeedModel& model, const LihuiyuBed& bed) : interpreter_(model), bed_(bed) {}

    void read(std::string_view body) {
        for (std::size_t i = 0; i < body.size(); ++i) {
            const bool layout = body[i] == '\n' || body[i] == '\r' || body[i] == '-';
            if (layout) {
                continue;
            }
            for (const BoardAction& action : interpreter_.take(body[i])) {
                perform(action, i);
            }
        }
        if (interpreter_.in_program()) {
            throw ProgramRefused("EGV: the program doesn't end (no FNSE)");
        }
    }

    std::vector<CutMove> take_moves() { return std::move(moves_); }

private:
    void perform(const BoardAction& action, std::size_t at) {
        switch (action.kind) {
            case BoardAction::Kind::Violation:
                if (!action.forgiven) {
                    throw ProgramRefused(
                        fmt::format("EGV: {} (byte {} of the program)", action.text, at + 1));
                }
                break;
            case BoardAction::Kind::Home:
                place_ = {};
                add(false, 0.0);
                break;
            case BoardAction::Kind::Cut:
            case BoardAction::Kind::Rapid:
                place_.x += action.dx;
                place_.y += action.dy;
                add(action.beam, action.beam ? action.speed.mm_per_s : 0.0);
                break;
            case BoardAction::Kind::Finish:
            case BoardAction::Kind::ReleaseRails:
                break;
        }
    }

    void add(bool beam, double speed) {
        const PlaceMm place = to_program_mm(bed_, place_);
        moves_.push_back({place.x_mm, place.y_mm, beam, speed, 0});
    }

    LihuiyuInterpreter interpreter_;
    LihuiyuBed bed_;
    StepPlace place_;
    std::vector<CutMove> moves_;
};

}  // namespace

bool is_egv(std::string_view text) {
    return text.substr(0, kFirstLine.size()) == kFirstLine;
}

std::string write_egv(const EncodedJob& job) {
    return std::string(kHeader) + job.stream() + "\n";
}

std::vector<CutMove> read_program_moves(std::string_view program, const EncoderOptions& options) {
    return is_egv(program) ? read_egv(program, options.speed, options.bed)
                           : read_cut_moves(program);
}

std::string convert_to_egv(std::string_view program, const EncoderOptions& options) {
    return write_egv(encode_job(read_program_moves(program, options), {}, options));
}

std::vector<CutMove> read_egv(std::string_view text,
                              const SpeedModel& model,
                              const LihuiyuBed& bed) {
    if (!is_egv(text)) {
        throw ProgramRefused(fmt::format("EGV: the file must begin with \"{}\"", kFirstLine));
    }
    EgvReader reader(model, bed);
    reader.read(body_of(text));
    return reader.take_moves();
}

}  // namespace leafcutter::drivers
