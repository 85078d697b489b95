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

// A command's number as Grbl reads it: hundredths behind the point are told apart, no more.
struct CommandNumber {
    int whole = 0;
    int hundredths = 0;
};

CommandNumber split_number(double value) {
    const double whole = std::trunc(value);
    return {whole_part(whole), whole_part(std::round(100.0 * (value - whole)))};
}

std::optional<Group> group_of_g(int whole) {
    switch (whole) {
        case 4:
        case 10:
        case 28:
        case 30:
        case 53:
        case 92:
            return Group::NonModal;
        case 0:
        case 1:
        case 2:
        case 3:
        case 80:
            return Group::Motion;
        case 17:
        case 18:
        case 19:
            return Group::Plane;
        case 90:
        case 91:
            return Group::Distance;
        case 93:
        case 94:
            return Group::FeedMode;
        case 20:
        case 21:
            return Group::Units;
        case 40:
            return Group::CutterCompensation;
        case 43:
        case 49:
            return Group::ToolLength;
        case 54:
        case 55:
        case 56:
        case 57:
        case 58:
        case 59:
            return Group::Coordinates;
        case 61:
            return Group::Control;
        default:
            return std::nullopt;
    }
}

// What a fraction behind a G number makes of it: Grbl's error, 0 where it belongs there.
int fraction_error(const CommandNumber& number) {
    switch (number.whole) {
        case 28:
        case 30:
        case 92:
            return number.hundredths == 0 || number.hundredths == 10 ? 0 : grbl_error::kUnsupported;
        case 43:
            return number.hundredths == 10 ? 0 : grbl_error::kUnsupported;
        case 49:
            return 0;
        case 91:
            return number.hundredths == 0 || number.hundredths == 10 ? 0 : grbl_error::kUnsupported;
        case 61:
        case 90:
            return number.hundredths == 0 ? 0 : grbl_error::kUnsupported;
        default:
            return number.hundredths > 0 ? grbl_error::kNotInteger : 0;
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

void apply_g(const CommandNumber& number, Group group, GcodeInterpreter::Block& block) {
    const int whole = number.whole;
    switch (group) {
        case Group::NonModal:
            block.non_modal = number.hundredths == 0 ? whole : whole * 10 + 1;
            break;
        case Group::Motion:
            block.modal.motion = static_cast<GcodeInterpreter::Motion>(whole);
            block.motion_word = block.modal.motion;
            break;
        case Group::Plane:
            block.modal.plane = whole;
            break;
        case Group::Distance:
            block.modal.relative = whole == 91;
            break;
        case Group::FeedMode:
            block.modal.inverse_time = whole == 93;
            break;
        case Group::Units:
            block.modal.inches = whole == 20;
            break;
        case Group::ToolLength:
            block.tool_offset = whole;
            break;
        case Group::Coordinates:
            block.modal.coordinates = whole;
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

bool may_be_negative(char letter) {
    return letter == 'L' || letter == 'R';
}

int apply_value(const GcodeWord& word, GcodeInterpreter::Block& block) {
    const char letter = word.letter;
    constexpr double kMostTools = 255.0;
    if (letter == 'T' && word.value > kMostTools) {
        return grbl_error::kToolNumber;
    }
    if (std::optional<double>* slot = value_slot(letter, block)) {
        if (*slot) {
            return grbl_error::kWordRepeated;
        }
        *slot = word.value;
        return word.value < 0.0 && !may_be_negative(letter) ? grbl_error::kNegative : 0;
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

// Commands of which a line may hold only one, as each could take the axis words.
bool uses_axes(const CommandNumber& number, Group group) {
    const bool whole = number.hundredths == 0;
    return (group == Group::Motion && number.whole != 80) || group == Group::ToolLength ||
           (group == Group::NonModal && whole && number.whole != 4 && number.whole != 53);
}

struct GroupsUsed {
    std::set<Group> groups;
    bool axes_claimed = false;
};

// A G word. Returns Grbl's error, 0 for none.
int apply_general(double value, GcodeInterpreter::Block& block, GroupsUsed& used) {
    const CommandNumber number = split_number(value);
    const std::optional<Group> group = group_of_g(number.whole);
    if (!group || value < 0.0) {
        return grbl_error::kUnsupported;
    }
    if (uses_axes(number, *group)) {
        if (used.axes_claimed) {
            return grbl_error::kAxisConflict;
        }
        used.axes_claimed = true;
    }
    if (const int error = fraction_error(number)) {
        return error;
    }
    const bool arc_distance = number.whole == 91 && number.hundredths != 0;
    if (!used.groups.insert(arc_distance ? Group::ArcDistance : *group).second) {
        return grbl_error::kModalGroup;
    }
    block.not_for_jog =
        block.not_for_jog || arc_distance ||
        (*group != Group::NonModal && *group != Group::Distance && *group != Group::Units);
    if (!arc_distance) {
        apply_g(number, *group, block);
    }
    return 0;
}

// An M word. Returns Grbl's error, 0 for none.
int apply_machine(double value, GcodeInterpreter::Block& block, GroupsUsed& used) {
    const CommandNumber number = split_number(value);
    if (number.hundredths > 0) {
        return grbl_error::kNotInteger;
    }
    const std::optional<Group> group = group_of_m(number.whole);
    if (!group || value < 0.0) {
        return grbl_error::kUnsupported;
    }
    if (!used.groups.insert(*group).second) {
        return grbl_error::kModalGroup;
    }
    block.not_for_jog = true;
    apply_m(number.whole, *group, block);
    return 0;
}

int apply_word(const GcodeWord& word, GcodeInterpreter::Block& block, GroupsUsed& used) {
    switch (word.letter) {
        case 'G':
            return apply_general(word.value, block, used);
        case 'M':
            return apply_machine(word.value, block, used);
        default:
            return apply_value(word, block);
    }
}

}  // namespace

int GcodeInterpreter::read_words(std::string_view stripped, Block& block) const {
    block.modal = modal_;
    if (block.jog) {
        block.modal.motion = Motion::Linear;
        block.modal.inverse_time = false;
    }
    const GcodeWords words = split_words(stripped);
    GroupsUsed used;
    for (const GcodeWord& word : words.words) {
        if (const int error = apply_word(word, block, used)) {
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
