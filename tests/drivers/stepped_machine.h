// A session of the driver against a simulated machine, both stepped by a clock of the test: no
// threads, no waiting, every run the same.

#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <string>
#include <utility>

#include "drivers/grbl/session.h"
#include "drivers/sim/faulty_machine.h"

namespace leafcutter::drivers {

class SteppedMachine {
public:
    using Time = GrblSession::Time;

    explicit SteppedMachine(const GrblMachineOptions& options = {},
                            std::vector<Fault> faults = {},
                            const GrblOptions& session = {})
        : machine_(options, std::move(faults)), session_(now_, session) {}

    GrblSession& session() { return session_; }
    GrblMachine& machine() { return machine_.machine(); }
    FaultyMachine& link() { return machine_; }

    // One turn: what the session says reaches the machine, what that answers reaches the session
    // `delay` turns later.
    void step(double seconds = 0.005) {
        now_ += std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds));
        std::string answer = machine_.feed(session_.take_output());
        answer += machine_.advance(seconds);
        if (noise && !answer.empty()) {
            noise(answer);
        }
        ++turn_;
        due_ = std::max(due_, turn_ + (delay ? delay() : 0));
        on_the_way_.emplace_back(std::move(answer), due_);
        std::string arrived;
        while (!on_the_way_.empty() && on_the_way_.front().second <= turn_) {
            arrived += on_the_way_.front().first;
            on_the_way_.pop_front();
        }
        most_rx_in_flight_ = std::max(most_rx_in_flight_, in_flight());
        session_.receive(arrived, now_);
        if (watch != nullptr) {
            session_.allow_lines(watch->lines_allowed(session_.progress(), session_.status()));
        }
        session_.tick(now_);
        most_rx_in_flight_ = std::max(most_rx_in_flight_, in_flight());
    }

    // Returns whether `done` came true within `seconds` of the machine's time.
    bool run_until(const std::function<bool()>& done, double seconds = 600.0) {
        const Time end = now_ + std::chrono::duration_cast<Time::duration>(
                                    std::chrono::duration<double>(seconds));
        while (!done()) {
            if (now_ > end) {
                return false;
            }
            step();
        }
        return true;
    }

    bool attach() {
        return run_until([this] { return session_.attached(); }, 10.0);
    }

    bool finish_job(double seconds = 600.0) {
        return run_until([this] { return session_.progress().outcome != JobOutcome::Running; },
                         seconds);
    }

    double now_s() { return machine().now_s(); }
    std::size_t most_bytes_in_flight() const { return most_rx_in_flight_; }

    std::function<int()> delay;                      // In turns; empty: none.
    std::function<void(std::string& answer)> noise;  // On the way from the machine.
    JobWatch* watch = nullptr;

private:
    std::size_t in_flight() const { return session_.bytes_in_flight(); }

    Time now_{std::chrono::hours(1)};
    FaultyMachine machine_;
    GrblSession session_;
    std::deque<std::pair<std::string, int>> on_the_way_;
    int turn_ = 0;
    int due_ = 0;  // The turn at which the last answer arrives: none overtakes another.
    std::size_t most_rx_in_flight_ = 0;
};

}  // namespace leafcutter::drivers
