// What a controller says, to the session of each family: nothing but LinkLost comes out of it, and
// however the bytes are cut into pieces, the session ends up the same.

#include <chrono>
#include <memory>

#include "drivers/grbl/session.h"
#include "drivers/lihuiyu/session.h"
#include "drivers/marlin/session.h"
#include "drivers/transport.h"
#include "parts.h"

namespace {

using namespace leafcutter::drivers;
using namespace leafcutter::fuzz;
using Time = Session::Time;

constexpr char kProgram[] =
    "G21\nG90\nG0 X1 Y1 S0\nM4 I1 S0\nG1 X9 Y1 S100 F600\nG1 X9 Y9\nG1 X1 Y1\nM5 S0\nG0 X0 Y0 S0\n";

std::unique_ptr<Session> make_session(unsigned choice, Time now) {
    switch (choice % 4) {
        case 0:
            return std::make_unique<GrblSession>(now);
        case 1:
            return std::make_unique<MarlinSession>(MarlinSession::Firmware::Marlin, now);
        case 2:
            return std::make_unique<MarlinSession>(MarlinSession::Firmware::Smoothie, now);
        default:
            return std::make_unique<LihuiyuSession>(EncoderOptions(), now);
    }
}

// Whoever holds the machine in hand: starts what can be started, holds, goes on, cancels.
void command(Session& session, std::size_t turn) {
    try {
        switch (turn % 8) {
            case 3:
                session.start(kProgram);
                break;
            case 5:
                session.hold();
                break;
            case 6:
                session.resume();
                break;
            case 7:
                turn % 3 == 0 ? session.cancel() : session.home();
                break;
            default:
                break;
        }
    } catch (const Refused&) {
        return;  // As it should.
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Script script = read_script(data, size);
    Time now{std::chrono::hours(1)};
    const auto whole = make_session(script.choice, now);
    const auto cut = make_session(script.choice, now);
    try {
        std::size_t turn = 0;
        for (const std::string_view part : script.parts) {
            now += std::chrono::milliseconds(100);
            whole->receive(part, now);
            cut->receive({}, now);
            for (std::size_t i = 0; i < part.size(); ++i) {
                cut->receive(part.substr(i, 1), now);
            }
            command(*whole, turn);
            command(*cut, turn++);
            whole->tick(now);
            cut->tick(now);
            require(whole->take_output() == cut->take_output());
            require(whole->take_lines() == cut->take_lines());
            require(whole->status().state == cut->status().state);
            const JobProgress& progress = whole->progress();
            require(progress.lines_acknowledged <= progress.lines_sent &&
                    progress.lines_sent <= progress.lines_total);
        }
    } catch (const LinkLost&) {
        return 0;
    }
    return 0;
}
