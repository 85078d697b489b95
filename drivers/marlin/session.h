// A Marlin or Smoothieware controller as its sender sees it: pure, bytes and time in, bytes out.
//
// One line at a time is under way, four where the controller counts its buffers (ADVANCED_OK).
// What it asks for again is sent again. An answer that never came is found by the next numbered
// line: the controller takes it, or asks for the one it misses.
//
// What this family cannot do, and says: there is no feed hold, so a hold ends with the moves that
// are planned already (up to about twenty), and an emergency stop (M112) reaches a controller that
// was built without its emergency parser only behind them. Smoothieware has '!', '~' and Ctrl-X.

#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/grbl/program.h"
#include "drivers/marlin/protocol.h"
#include "drivers/session.h"

namespace leafcutter::drivers {

class MarlinSession final : public Session {
public:
    enum class Firmware { Marlin, Smoothie };

    MarlinSession(Firmware firmware, Time now);

    void receive(std::string_view bytes, Time now) override;
    void tick(Time now) override;
    std::string take_output() override;
    std::vector<std::string> take_lines() override;
    bool attached() const override { return phase_ == Phase::Ready && positioned_; }
    bool may_close() const override;

    void start(std::string_view program) override;
    void hold() override;
    void resume() override;
    void cancel() override;
    void stop() override;
    void home() override;
    void unlock() override;
    void jog(const Jog& jog) override;
    void jog_cancel() override;
    void console(std::string_view line) override;
    void lose_link(const std::string& reason) override;
    std::string_view last_words() const override;

    const DeviceStatus& status() const override { return status_; }
    const JobProgress& progress() const override { return progress_; }

    std::size_t resends() const { return resends_; }

private:
    enum class Phase { Greeting, Asking, Numbering, Ready, Killed, Gone };
    enum class Origin { Job, Frame, Command, Poll, Nudge };

    struct Pending {
        Origin origin = Origin::Command;
        std::string text;
        std::size_t line = 0;    // In the program's file.
        std::size_t number = 0;  // On the link; 0: not yet sent.
    };

    bool smoothie() const { return firmware_ == Firmware::Smoothie; }
    bool job_runs() const { return progress_.outcome == JobOutcome::Running; }
    void require_ready(std::string_view what) const;
    void submit(std::string line);
    void command_state(MachineState state);

    // Sending.
    void fill();
    bool may_send() const;
    void send(Pending line);
    void poll();
    void nudge();

    // Events.
    void handle(const MarlinEvent& event);
    void handle_ack(const MarlinEvent& event);
    void handle_resend(std::size_t number);
    void handle_error(const std::string& text);
    void handle_halt(const std::string& text);
    void handle_restart();
    void take_position(const std::string& text);
    std::size_t answered_by(const std::string& ok);
    void answered(const Pending& line);
    void set_resting_state();

    void watch_attach();
    void watch_silence() const;
    void end_job(JobOutcome outcome, std::string reason);
    void forget_lines();

    Firmware firmware_;
    Time now_;
    Phase phase_ = Phase::Greeting;
    Time phase_since_;
    Time heard_;
    Time sent_at_;
    Time polled_;
    Time quiet_until_;  // After a resend: stray answers come until then.
    bool positioned_ = false;
    std::size_t positions_heard_ = 0;  // Since the last answer.
    bool holding_ = false;
    bool cancelling_ = false;
    bool emergency_parser_ = false;
    std::size_t window_ = 1;
    std::size_t next_number_ = 1;
    std::size_t resends_ = 0;
    std::size_t asked_again_ = 0;  // In a row, for the same line.
    std::size_t last_asked_ = 0;

    MarlinProtocol protocol_;
    std::string output_;
    std::vector<std::string> lines_;
    std::deque<Pending> pending_;   // Sent, not yet answered; oldest first.
    std::deque<Pending> history_;   // Sent, newest last.
    std::deque<Pending> again_;     // To be sent again under their old numbers.
    std::deque<Pending> commands_;  // By hand, not yet sent.
    std::deque<Pending> job_;

    DeviceStatus status_;
    JobProgress progress_;
    std::string last_error_;
};

}  // namespace leafcutter::drivers
