// The first half of Grbl's gc_execute_line(): words into a block, modal groups held apart.

#include <cmath>
#include <set>

#include "drivers/sim/gcode_block.h"

namespace leafcutter::drivers {

namespace {

enum class Group {
    NonModal,
    Motion,
    Plane,
    Distance,
    ArcDistance,
    FeedMode,
    Units,
    CutterCompensation,
    ToolLength,
    Coordinates,
    Control,
    Stop,
    Spindle,
    Coolant
};

// A command's number in tenths, so that G28.1 is 281.
int tenths(double value) {
    return static_cast<int>(std::lround(value * 10.0));
}

bool has_known_fraction(double value) {
    return std::abs(value * 10.0 - tenths(value)) < 1e-6;
}

std::optional<Group> group_of_g(int code) {
    switch (code) {
        case 40:
        case 100:
        case 280:
        case 281:
        case 300:
        case 301:
        case 530:
        case 920:
        case 921:
            return Group::NonModal;
        case 0:
        case 10:
        case 20:
        case 30:
        case 800:
            return Group::Motion;
        case 170:
        case 180:
        case 190:
            return Group::Plane;
        case 900:
        case 910:
            return Group::Distance;
        case 911:
            return Group::ArcDistance;
        case 930:
        case 940:
            return Group::FeedMode;
        case 200:
        case 210:
            return Group::Units;
        case 400:
            return Group::CutterCompensation;
        case 431:
        case 490:
            return Group::ToolLength;
        case 540:
        case 550:
        case 560:
        case 570:
        case 580:
        case 590:
            return Group::Coordinates;
        case 610:
            return Group::Control;
        default:
            return std::nullopt;
    }
}

std::optional<Group> group_of_m(int code) {
    switch (code) {
        case 0:
        case 1:
        case 2:
        case 30:
            return Group::Stop;
        case 3:
        case 4:
        case 5:
            return Group::Spindle;
        case 8:
        case 9:
            return Group::Coolant;
        default:
            return std::nullopt;
    }
}

BeamMode beam_of(int code) {
    if (code == 5) {
        return BeamMode::Off;
    }
    return code == 3 ? BeamMode::Constant : BeamMode::Dynamic;
}

void apply_g(int code, Group group, GcodeInterpreter::Block& block) {
    switch (group) {
        case Group::NonModal:
            block.non_modal = code % 10 == 0 ? code / 10 : code;
            break;
        case Group::Motion:
            block.modal.motion = static_cast<GcodeInterpreter::Motion>(code / 10);
            block.motion_word = block.modal.motion;
            break;
        case Group::Plane:
            block.modal.plane = code / 10;
            break;
        case Group::Distance:
            block.modal.relative = code == 910;
            break;
        case Group::FeedMode:
            block.modal.inverse_time = code == 930;
            break;
        case Group::Units:
            block.modal.inches = code == 200;
            break;
        case Group::ToolLength:
            block.tool_offset = code;
            break;
        case Group::Coordinates:
            block.modal.coordinates = code / 10;
            break;
        default:
            break;
    }
}

void apply_m(int code, Group group, GcodeInterpreter::Block& block) {
    if (group == Group::Stop) {
        block.stop = code;
    } else if (group == Group::Spindle) {
        block.beam_word = beam_of(code);
        block.modal.beam = beam_of(code);
    } else {
        block.modal.flood = code == 8;
    }
}

std::optional<double>* value_slot(char letter, GcodeInterpreter::Block& block) {
    switch (letter) {
        case 'F':
            return &block.feed;
        case 'L':
            return &block.l;
        case 'N':
            return &block.line_number;
        case 'P':
            return &block.p;
        case 'R':
            return &block.r;
        case 'S':
            return &block.s;
        case 'T':
            return &block.t;
        default:
            return nullptr;
    }
}

int apply_value(const GcodeWord& word, GcodeInterpreter::Block& block) {
    const char letter = word.letter;
    if (std::optional<double>* slot = value_slot(letter, block)) {
        if (*slot) {
            return grbl_error::kWordRepeated;
        }
        *slot = word.value;
        return word.value < 0.0 && letter != 'R' ? grbl_error::kNegative : 0;
    }
    const bool axis = letter >= 'X' && letter <= 'Z';
    if (!axis && (letter < 'I' || letter > 'K')) {
        return grbl_error::kUnsupported;
    }
    const auto index = static_cast<std::size_t>(letter - (axis ? 'X' : 'I'));
    auto& given = axis ? block.axis_given : block.offset_given;
    if (given[index]) {
        return grbl_error::kWordRepeated;
    }
    given[index] = true;
    (axis ? block.axes : block.offsets)[index] = word.value;
    return 0;
}

bool uses_axes(int g_code) {
    return g_code == 100 || g_code == 280 || g_code == 300 || g_code == 920 || g_code == 431;
}

struct GroupsUsed {
    std::set<Group> groups;
    int axis_commands = 0;
};

// A G or M word. Returns Grbl's error, 0 for none.
int apply_command(const GcodeWord& word, GcodeInterpreter::Block& block, GroupsUsed& used) {
    const bool general = word.letter == 'G';
    if (!general && word.value != std::floor(word.value)) {
        return grbl_error::kNotInteger;
    }
    if (word.value < 0.0 || !has_known_fraction(word.value)) {
        return grbl_error::kUnsupported;
    }
    const int code = general ? tenths(word.value) : static_cast<int>(word.value);
    const std::optional<Group> group = general ? group_of_g(code) : group_of_m(code);
    if (!group) {
        return grbl_error::kUnsupported;
    }
    const bool moves = *group == Group::Motion && code != 800;
    used.axis_commands += general && (uses_axes(code) || moves) ? 1 : 0;
    if (used.axis_commands > 1) {
        return grbl_error::kAxisConflict;
    }
    if (!used.groups.insert(*group).second) {
        return grbl_error::kModalGroup;
    }
    if (general) {
        apply_g(code, *group, block);
    } else {
        apply_m(code, *group, block);
    }
    return 0;
}

}  // namespace

int GcodeInterpreter::read_words(std::string_view stripped, Block& block) const {
    block.modal = modal_;
    const GcodeWords words = split_words(stripped);
    GroupsUsed used;
    for (const GcodeWord& word : words.words) {
        const bool command = word.letter == 'G' || word.letter == 'M';
        if (const int error =
                command ? apply_command(word, block, used) : apply_value(word, block)) {
            return error;
        }
    }
    if (words.fault) {
        return *words.fault == WordFault::LetterExpected ? grbl_error::kLetterExpected
                                                         : grbl_error::kBadNumber;
    }
    return 0;
}

}  // namespace leafcutter::drivers
