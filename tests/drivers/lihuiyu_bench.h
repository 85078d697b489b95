// A Lihuiyu session against the simulated board, both stepped by a clock of the test: no threads,
// no waiting, every run the same.

#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "drivers/lihuiyu/session.h"
#include "drivers/sim/lihuiyu_machine.h"

namespace leafcutter::drivers {

class LihuiyuBench {
public:
    using Time = Session::Time;

    explicit LihuiyuBench(const LihuiyuMachineOptions& machine = {},
                          const EncoderOptions& encoder = {})
        : machine_(machine), session_(encoder, now_) {}

    LihuiyuSession& session() { return session_; }
    LihuiyuMachine& machine() { return machine_; }

    // What the session says reaches the board at once, what that answers one turn later.
    void step(double seconds = 0.002) {
        now_ += std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds));
        std::string said = session_.take_output();
        if (to_board) {
            said = to_board(said);
        }
        std::string answer = machine_.feed(said);
        if (to_host) {
            answer = to_host(answer);
        }
        machine_.advance(seconds);
        session_.receive(answer, now_);
        session_.tick(now_);
    }

    // Returns whether `done` came true within `seconds` of the machine's time.
    bool run_until(const std::function<bool()>& done, double seconds = 600.0) {
        const double end = machine_.now_s() + seconds;
        while (!done()) {
            if (machine_.now_s() > end) {
                return false;
            }
            step();
        }
        return true;
    }

    bool attach() {
        return run_until([this] { return session_.attached(); }, 5.0);
    }

    bool home() {
        if (!attach()) {
            return false;
        }
        session_.home();
        return run_until([this] { return session_.homed(); }, 60.0);
    }

    JobOutcome finish_job(double seconds = 600.0) {
        run_until([this] { return session_.progress().outcome != JobOutcome::Running; }, seconds);
        return session_.progress().outcome;
    }

    // Both directions can be disturbed.
    std::function<std::string(std::string)> to_board;
    std::function<std::string(std::string)> to_host;

private:
    Time now_{std::chrono::hours(1)};
    LihuiyuMachine machine_;
    LihuiyuSession session_;
};

}  // namespace leafcutter::drivers
