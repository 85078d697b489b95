// A Grbl controller as its sender sees it: pure, bytes and time in, bytes out. Opens nothing.
//
// Attaches (banner, $I, $$), streams a program by character counting, polls '?' at 5 Hz whatever
// the stream does (twice as often for the moments of a halt or a resume), and ends every job it
// can't finish with the beam off: feed hold, wait for Hold:0, reset.

#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device.h"
#include "drivers/grbl/firmware.h"
#include "drivers/grbl/program.h"
#include "drivers/grbl/protocol.h"
#include "drivers/grbl/status_report.h"
#include "drivers/session.h"

namespace leafcutter::drivers {

struct GrblOptions {
    double power_cap_percent = 100.0;  // Programs of a higher S than this part of $30 are refused.
    // Between two status queries. After a power cut, where the beam stopped is known to half of
    // what it burns in that time.
    std::chrono::milliseconds poll_interval{200};
};

class GrblSession final : public Session {
public:
    explicit GrblSession(Time now, const GrblOptions& options = {});

    void receive(std::string_view bytes, Time now) override;
    void tick(Time now) override;
    std::string take_output() override;
    std::vector<std::string> take_lines() override;

    GrblFirmware firmware() const { return firmware_.kind(); }

    // Attached, settings known, no halt under way.
    bool ready() const { return phase_ == Phase::Ready && halt_ == Halt::None; }
    bool attached() const override { return ready() && reported_; }

    std::size_t bytes_in_flight() const { return protocol_.bytes_in_flight(); }

    // Answers that noise on the link had swallowed or doubled, put right without a stop.
    std::size_t answers_healed() const { return answers_healed_; }

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
    void set_overrides(const std::array<int, 3>& percent) override;

    std::vector<MachineSetting> settings() const override;
    void set_setting(std::string_view key, double value) override;
    void lose_link(const std::string& reason) override;
    std::string_view last_words() const override { return "\x18"; }

    const DeviceStatus& status() const override { return status_; }
    const JobProgress& progress() const override { return progress_; }

private:
    enum class Phase { Greeting, Resetting, AskingVersion, AskingSettings, Ready, Gone };
    enum class Halt { None, Holding, Resetting };
    enum class Origin { Job, Frame, Command };  // Frame: our own lines around a job.

    struct Pending {
        Origin origin = Origin::Command;
        std::string text;
        std::size_t number = 0;  // In the program's file.
        bool alone = false;
        double dwell_s = 0.0;
    };

    // It reads a line only when it has done with the one before, so that what it has received and
    // not read can be held against what it was sent.
    bool reads_line_by_line() const { return firmware_.kind() == GrblFirmware::Grbl; }
    bool job_runs() const { return progress_.outcome == JobOutcome::Running; }
    double settings_value(int number, double otherwise) const;
    MachineFacts facts() const;
    void require_ready(std::string_view what) const;
    void submit(std::string line);

    // Sending.
    void fill();
    bool send_line(const Pending& line);
    void send_realtime(char byte) { output_ += byte; }
    void poll();
    void poll_soon() { polled_ = Time{}; }
    std::chrono::milliseconds poll_interval() const;

    // Events: session_events.cpp
    void handle(const GrblEvent& event);
    void handle_answer(const GrblEvent& event);
    void handle_alarm(const GrblEvent& event);
    void handle_banner(const GrblEvent& event);
    void handle_setting(const std::string& text);
    void handle_message(const GrblEvent& event);
    void handle_status(const StatusReport& report);
    void take_positions(const StatusReport& report);
    void attach_by(const StatusReport& report);
    void halt_by(const StatusReport& report);

    void step_overrides();
    void handle_garbled(const GrblEvent& event);
    void resolve_oldest();

    // Watching: session_watch.cpp
    void watch_buffer(const StatusReport& report);
    void heal_or_fail(const std::string& what);
    void watch_silence() const;
    void watch_attach();
    void watch_halt();
    void watch_lost_answer(const StatusReport& report);
    void watch_standing_beam(const StatusReport& report);
    double pending_dwell_s() const;

    // Ending.
    void end_job(JobOutcome outcome, std::string reason);
    void begin_halt();
    void begin_reset();
    void forget_lines();

    Time now_;
    Phase phase_ = Phase::Greeting;
    Halt halt_ = Halt::None;
    Time phase_since_;
    Time halt_since_;
    Time heard_;
    Time polled_;
    int unanswered_polls_ = 0;
    std::optional<Time> standing_since_;     // Idle with lines unanswered.
    std::optional<Time> beam_stands_since_;  // Idle or Hold:0 with S > 0 in FS.
    Time line_sent_;                         // When the last line was sent.
    int short_reports_ = 0;                  // In a row, that show fewer bytes than are unanswered.
    std::size_t garbled_oks_ = 0;            // Each stands for an answer that was not counted.
    std::size_t answers_healed_ = 0;
    std::size_t rx_capacity_ = 0;  // As its reports show it when empty.
    bool resume_wanted_ = false;
    bool reported_ = false;  // Since it became ready.
    bool critical_alarm_ = false;

    GrblProtocol protocol_;
    std::string output_;
    std::vector<std::string> lines_;
    std::deque<Pending> pending_;   // Sent, not yet answered; oldest first.
    std::deque<Pending> commands_;  // By hand, not yet sent.

    std::deque<Pending> job_;  // Lines still to send.
    bool finishing_ = false;   // Every line is answered; the machine has still to stand.
    bool cancelling_ = false;

    DeviceStatus status_;
    JobProgress progress_;
    GrblOptions options_;
    std::optional<std::array<int, 3>> wanted_overrides_;
    std::array<int, 3> expected_overrides_{};  // Once the last step is served.
    Time overrides_stepped_;
    std::optional<int> sub_state_;
    std::map<int, double> settings_;
    FirmwareSigns firmware_;
    std::optional<std::array<double, 3>> work_offset_;
};

}  // namespace leafcutter::drivers
