// A Marlin or Smoothieware controller as its sender sees it: pure, bytes and time in, bytes out.
//
// One line at a time is under way, four where the controller counts its buffers (ADVANCED_OK).
// What it asks for again is sent again. An answer that never came, came garbled or came twice is
// found by a numbered M114: the controller takes it, or asks for the line that it misses, and its
// position shows which answers came before.
//
// What this family cannot do, and says: there is no feed hold (Smoothieware's '!' holds only what
// isn't planned yet), so a hold ends with the moves that are planned already (up to about thirty),
// then the beam is put out. Marlin's M410 empties the planner at once, but a line that waits for
// room there would then burn from a wrong place: a cancel sends it when no line waits. An emergency
// stop (M112) reaches a Marlin that was built without its emergency parser only behind what it has
// read. Smoothieware has Ctrl-X, which stops the motors dead: home it then. Silence is noticed
// within 2 s, but not that of a Marlin built without HOST_KEEPALIVE_FEATURE: while a long move is
// under way it hears nothing and says nothing, whatever it is asked; it gets 20 s.

#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/grbl/program.h"
#include "drivers/marlin/protocol.h"
#include "drivers/session.h"

namespace leafcutter::drivers {

struct MarlinOptions {
    std::optional<double> s_max;       // S of full power; none: 255, of Smoothieware 1.
    double power_cap_percent = 100.0;  // Of s_max; programs of a higher S are refused.
    // From the home corner, where the controller doesn't say it (Marlin's M115 does); 0: unknown.
    std::array<double, 2> bed_mm{};
};

class MarlinSession final : public Session {
public:
    enum class Firmware { Marlin, Smoothie };

    // What the controller says about itself goes before `firmware`.
    MarlinSession(Firmware firmware, Time now, const MarlinOptions& options = {});

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
    enum class Phase { Greeting, Unlocking, Asking, Numbering, Ready, Killed, Gone };
    enum class Origin { Job, Frame, Command, Poll, Nudge };

    struct Pending {
        Origin origin = Origin::Command;
        std::string text;
        std::size_t line = 0;    // In the program's file.
        std::size_t number = 0;  // On the link; 0: not yet sent, or without one.

        bool asks_position() const { return text == "M114"; }
    };

    // What the answers to M114.1 to M114.5 begin with, and the word that Marlin is to repeat.
    static constexpr std::array<std::string_view, 5> kSmoothieNudges{
        "ok WCS:", "ok MCS:", "ok APOS:", "ok MP:", "ok CMP:"};
    static constexpr std::string_view kMarlinNudge = "lc";

    bool smoothie() const { return firmware_ == Firmware::Smoothie; }
    bool job_runs() const { return progress_.outcome == JobOutcome::Running; }
    void require_ready(std::string_view what) const;
    void submit(std::string line);
    void console_shell(std::string_view line);
    MachineFacts facts() const;

    // Sending.
    void fill();
    bool may_send() const;
    void send(Pending line);
    void remember_beam(std::string_view line);
    void send_unnumbered(std::string text);
    void put_under_way(Pending line);
    void poll();
    void nudge();
    std::string nudge_text();
    void quick_stop();
    void put_beam_out();
    void restore_beam();

    // Events.
    void handle(const MarlinEvent& event);
    void handle_ack(const MarlinEvent& event);
    void handle_resend(std::size_t number);
    void handle_error(const std::string& text);
    void handle_halt(const std::string& text);
    void handle_restart();
    void handle_unknown(const std::string& text);
    void hear_nudge(std::string_view text);
    void take_firmware(const std::string& text);
    void take_area(std::string_view text);
    void take_status(const std::string& text);
    void take_position(const std::string& text);
    std::size_t answered_by(const std::string& ok);
    std::size_t answered_by_nudge(const std::string& ok);
    void answered(const Pending& line);
    void set_resting_state();

    void watch_attach();
    void watch_silence() const;
    void begin_asking();
    void end_job(JobOutcome outcome, std::string reason);
    void forget_lines();

    // Where the head can go, in the coordinates of a program.
    struct Area {
        std::array<double, 2> least_mm{};
        std::array<double, 2> size_mm{};
    };

    Firmware firmware_;
    MarlinOptions options_;
    std::optional<Area> area_;
    bool origin_moved_ = false;  // By hand.
    Time now_;
    Phase phase_ = Phase::Greeting;
    Time phase_since_;
    Time heard_;     // Anything.
    Time answered_;  // A word about the lines under way.
    Time sent_at_;
    Time waits_since_;  // For the oldest line under way.
    Time polled_;
    Time quiet_until_;  // After a resend: stray answers come until then.
    Time asked_report_;
    Time reported_;             // Smoothieware answered '?'.
    bool reports_ = false;      // It ever did.
    bool named_ = false;        // M115 was answered.
    bool foreign_ = false;      // It is no controller of this family.
    bool grbl_mode_ = false;    // Of Smoothieware: homes with G28.2.
    bool keeps_alive_ = false;  // It says busy every second while a line takes long.
    bool idle_told_ = false;    // It says that it waits, while a line is under way.
    bool positioned_ = false;
    std::size_t positions_heard_ = 0;  // Since the last answer.
    std::size_t positions_owed_ = 0;   // Of M114 that counted as answered before theirs came.
    bool holding_ = false;
    bool cancelling_ = false;
    bool quick_stop_due_ = false;  // M410, once no line waits to be planned.
    std::string beam_line_;        // The program's last M3 or M4.
    std::string power_word_;       // Its last S.
    bool emergency_parser_ = false;
    std::size_t window_ = 1;
    std::size_t next_number_ = 1;
    std::size_t nudges_sent_ = 0;
    std::size_t nudge_heard_ = 0;  // Number of the line whose word came; 0: none.
    bool unknown_heard_ = false;   // Since the last answer.
    std::size_t resends_ = 0;
    std::size_t asked_again_ = 0;  // In a row, for the same line.
    std::size_t last_asked_ = 0;
    std::size_t counted_to_ = 0;  // Lines up to that number are counted as acknowledged.

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
