// A wire cuts bytes into pieces wherever it likes. A dialogue of each protocol is recorded, with a
// job, a hold and a cancel in it, and played again to both of its sides: cut in two at every byte,
// and byte by byte. Nothing may change.

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/grbl/session.h"
#include "drivers/lihuiyu/session.h"
#include "drivers/marlin/session.h"
#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/lihuiyu_machine.h"
#include "drivers/sim/marlin_machine.h"
#include "drivers/sim/smoothie_machine.h"

namespace leafcutter::drivers {
namespace {

constexpr double kTurnS = 0.02;
constexpr std::size_t kMostTurns = 6000;
constexpr Session::Time kBegin{std::chrono::hours(1)};

using Command = std::function<void(Session&)>;

struct Family {
    std::function<std::unique_ptr<Session>()> make_session;
    std::function<std::unique_ptr<SimMachine>()> make_machine;
    std::string program;
    bool homes = false;
};

struct Dialogue {
    std::vector<std::string> heard;  // By the session, turn by turn.
    std::vector<std::string> said;
    std::map<std::size_t, Command> commands;
    std::vector<std::string> lines;
};

// Cuts what passes in two at byte `at` of all that passes, or, with 0, everywhere.
class Cutter {
public:
    explicit Cutter(std::size_t at) : at_(at) {}

    std::vector<std::string_view> pieces(std::string_view bytes) {
        std::vector<std::string_view> pieces;
        if (at_ == 0) {
            for (std::size_t i = 0; i < bytes.size(); ++i) {
                pieces.push_back(bytes.substr(i, 1));
            }
        } else if (at_ > passed_ && at_ < passed_ + bytes.size()) {
            pieces = {bytes.substr(0, at_ - passed_), bytes.substr(at_ - passed_)};
        } else {
            pieces.push_back(bytes);
        }
        passed_ += bytes.size();
        return pieces;
    }

private:
    std::size_t at_;
    std::size_t passed_ = 0;
};

std::size_t bytes_of(const std::vector<std::string>& turns) {
    std::size_t count = 0;
    for (const std::string& turn : turns) {
        count += turn.size();
    }
    return count;
}

Session::Time time_of(std::size_t turn) {
    return kBegin + std::chrono::milliseconds(20) * (static_cast<long>(turn) + 1);
}

struct Step {
    std::function<bool(const Session&)> when;
    Command command;
};

bool is_idle(const Session& session) {
    return session.attached() && session.status().state == MachineState::Idle;
}

// Attaches, homes where that is needed, runs the program with a hold in the middle, runs it again
// and cancels.
std::vector<Step> steps_of(const Family& family) {
    const auto acknowledged = [](std::size_t count) {
        return [count](const Session& session) {
            return session.progress().lines_acknowledged >= count;
        };
    };
    std::vector<Step> steps;
    if (family.homes) {
        steps.push_back({[](const Session& session) { return session.attached(); },
                         [](Session& session) { session.home(); }});
    }
    const Command start = [&family](Session& session) { session.start(family.program); };
    steps.push_back({is_idle, start});
    steps.push_back({acknowledged(3), [](Session& session) { session.hold(); }});
    steps.push_back({[waited = 0](const Session& /*session*/) mutable { return ++waited > 100; },
                     [](Session& session) { session.resume(); }});
    steps.push_back({[](const Session& session) {
                         return session.progress().outcome == JobOutcome::Done && is_idle(session);
                     },
                     start});
    steps.push_back({acknowledged(4), [](Session& session) { session.cancel(); }});
    steps.push_back({[waited = 0](const Session& /*session*/) mutable { return ++waited > 100; },
                     [](Session& /*session*/) {}});
    return steps;
}

Dialogue record(const Family& family) {
    Dialogue dialogue;
    const auto session = family.make_session();
    const auto machine = family.make_machine();
    std::vector<Step> steps = steps_of(family);
    std::size_t next = 0;
    for (std::size_t turn = 0; turn < kMostTurns && next < steps.size(); ++turn) {
        if (steps[next].when(*session)) {
            dialogue.commands[turn] = steps[next].command;
            steps[next++].command(*session);
        }
        dialogue.said.push_back(session->take_output());
        std::string answer = machine->feed(dialogue.said.back());
        answer += machine->advance(kTurnS);
        dialogue.heard.push_back(answer);
        session->receive(answer, time_of(turn));
        session->tick(time_of(turn));
        for (std::string& line : session->take_lines()) {
            dialogue.lines.push_back(std::move(line));
        }
    }
    EXPECT_EQ(next, steps.size()) << "the dialogue got stuck";
    return dialogue;
}

// Returns the first turn at which the session did anything else, or how many turns there are.
std::size_t replay_to_session(const Family& family, const Dialogue& dialogue, std::size_t cut_at) {
    const auto session = family.make_session();
    Cutter cutter(cut_at);
    std::vector<std::string> lines;
    for (std::size_t turn = 0; turn < dialogue.heard.size(); ++turn) {
        const auto command = dialogue.commands.find(turn);
        if (command != dialogue.commands.end()) {
            command->second(*session);
        }
        if (session->take_output() != dialogue.said[turn]) {
            return turn;
        }
        for (const std::string_view piece : cutter.pieces(dialogue.heard[turn])) {
            session->receive(piece, time_of(turn));
        }
        session->tick(time_of(turn));
        for (std::string& line : session->take_lines()) {
            lines.push_back(std::move(line));
        }
    }
    return lines == dialogue.lines ? dialogue.heard.size() : 0;
}

// Likewise for the machine.
std::size_t replay_to_machine(const Family& family, const Dialogue& dialogue, std::size_t cut_at) {
    const auto machine = family.make_machine();
    Cutter cutter(cut_at);
    for (std::size_t turn = 0; turn < dialogue.said.size(); ++turn) {
        std::string answer = machine->feed({});
        for (const std::string_view piece : cutter.pieces(dialogue.said[turn])) {
            answer += machine->feed(piece);
        }
        answer += machine->advance(kTurnS);
        if (answer != dialogue.heard[turn]) {
            return turn;
        }
    }
    return dialogue.said.size();
}

void expect_the_same_however_cut(const Family& family) {
    const Dialogue dialogue = record(family);
    const std::size_t turns = dialogue.heard.size();
    EXPECT_GT(bytes_of(dialogue.said), 200U);
    for (std::size_t at = 0; at < bytes_of(dialogue.heard); ++at) {
        ASSERT_EQ(replay_to_session(family, dialogue, at), turns) << "heard, cut at byte " << at;
    }
    for (std::size_t at = 0; at < bytes_of(dialogue.said); ++at) {
        ASSERT_EQ(replay_to_machine(family, dialogue, at), turns) << "said, cut at byte " << at;
    }
}

std::string program(const std::string& beam) {
    return "; job\nG21\nG90\n" + beam +
           "G0 X20 Y20 S0\nG1 X40 Y20 S0.5 F2400\nG1 X40 Y40\nG1 X20 Y40\nG1 X20 Y20\nM5 S0\n"
           "G0 X5 Y5 S0\n";
}

std::unique_ptr<Session> line_session(MarlinSession::Firmware firmware) {
    return std::make_unique<MarlinSession>(firmware, kBegin);
}

TEST(Fragmentation, ChangesNothingForGrbl) {
    expect_the_same_however_cut(
        {[] { return std::make_unique<GrblSession>(kBegin); },
         [] { return std::make_unique<FaultyMachine>(GrblMachineOptions()); }, program("M4 S0\n")});
}

TEST(Fragmentation, ChangesNothingForMarlin) {
    expect_the_same_however_cut({[] { return line_session(MarlinSession::Firmware::Marlin); },
                                 [] { return std::make_unique<MarlinMachine>(); },
                                 program("M4 I1 S0\n")});
}

TEST(Fragmentation, ChangesNothingForMarlinThatCountsItsBuffers) {
    MarlinMachineOptions options;
    options.advanced_ok = true;
    expect_the_same_however_cut({[] { return line_session(MarlinSession::Firmware::Marlin); },
                                 [options] { return std::make_unique<MarlinMachine>(options); },
                                 program("M4 I1 S0\n")});
}

TEST(Fragmentation, ChangesNothingForSmoothieware) {
    expect_the_same_however_cut({[] { return line_session(MarlinSession::Firmware::Smoothie); },
                                 [] { return std::make_unique<SmoothieMachine>(); }, program("")});
}

TEST(Fragmentation, ChangesNothingForALihuiyuBoard) {
    expect_the_same_however_cut(
        {[] { return std::make_unique<LihuiyuSession>(EncoderOptions(), kBegin); },
         [] { return std::make_unique<LihuiyuMachine>(); }, program("M4 S0\n"), true});
}

}  // namespace
}  // namespace leafcutter::drivers
