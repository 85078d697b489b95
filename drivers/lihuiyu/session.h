// A Lihuiyu board as its sender sees it: packets one at a time, each confirmed by the board's
// status before the next. Wire bytes as in packet.h.
//
// After a packet the status is asked until it says 206 (taken), 207 (bad: the same again) or 238
// (its buffer is full: wait, for as long as the work that it holds can take). Nothing is waited for
// without an end: a board that stays busy, rejects a packet again and again, has no power or says
// nothing ends the job, with the beam off as far as it still hears.
//
// The board tells no place. It is known after homing, and from then on by counting; a stop, a
// cancel, freed rails or an error end that knowledge, and no job starts without it. There is no
// control of power: S words only say whether the beam is on.
//
// Hold (PN) takes effect at once, once the board takes a packet again, which is within the half
// second that a packet burns. Stop and cancel (I) ask nobody.

#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/lihuiyu/encoder.h"
#include "drivers/session.h"

namespace leafcutter::drivers {

class LihuiyuSession final : public Session {
public:
    LihuiyuSession(const EncoderOptions& options, Time now);

    void receive(std::string_view bytes, Time now) override;
    void tick(Time now) override;
    std::string take_output() override;
    std::vector<std::string> take_lines() override;
    bool attached() const override { return attached_; }
    bool may_close() const override;

    // G-code or EGV text.
    void start(std::string_view program) override;
    void hold() override;
    void resume() override;
    void cancel() override;
    void stop() override;
    void home() override;
    void unlock() override;  // Lets the rails go: the head can be moved by hand.
    void jog(const Jog& jog) override;
    void jog_cancel() override;
    void console(std::string_view line) override;  // IPP, IS1P and IS2P alone.

    void lose_link(const std::string& reason) override;
    std::string_view last_words() const override;
    const DeviceStatus& status() const override { return status_; }
    const JobProgress& progress() const override { return progress_; }

    bool homed() const { return homed_; }

private:
    enum class Purpose { Job, Hold, Resume, Stop, Home, Rails, Jog };

    struct Outgoing {
        Payload payload{};
        Purpose purpose = Purpose::Job;
        double seconds = 0.0;
        std::optional<StepPlace> end;
    };

    bool job_runs() const { return progress_.outcome == JobOutcome::Running; }
    void require_connected(std::string_view what) const;
    void require_idle(std::string_view what) const;
    void require_homed(std::string_view what) const;
    void queue(const Payload& payload, Purpose purpose);

    // Wire: session_events.cpp
    void ask();
    void send_next();
    std::optional<Outgoing> next_packet();
    void write(const Outgoing& packet);
    void answer(std::uint8_t status);
    void answer_stop(std::uint8_t status);
    void confirm();
    void reject();

    // Watching: session_events.cpp
    void watch_answers();
    void watch_status();
    void watch_busy();
    void watch_stop();
    void watch_home();
    void watch_end();
    void fail(const std::string& reason);
    bool status_is(BoardStatus status) const;
    std::chrono::milliseconds ask_interval() const;

    // Ending.
    void begin_stop(const std::string& reason, JobOutcome outcome);
    void end_job(JobOutcome outcome, const std::string& reason);
    void show_state();

    EncoderOptions options_;
    Time now_;
    bool attached_ = false;
    bool gone_ = false;
    std::string output_;
    std::string reply_;  // Of a status not yet whole.
    std::vector<std::string> lines_;

    // Statuses asked for and received; those asked before a packet say nothing about it.
    std::size_t asked_ = 0;
    std::size_t answered_ = 0;
    std::size_t asked_at_packet_ = 0;
    Time asked_at_;
    Time quiet_until_;  // After a lost answer: what comes now is too late to be told apart.
    int unanswered_ = 0;
    std::uint8_t last_status_ = 0;
    Time status_since_;
    bool ready_ = false;     // The board takes a packet.
    bool doubtful_ = false;  // A status was lost since the packet: one 207 proves nothing.

    std::deque<Outgoing> packets_;
    std::optional<Outgoing> in_flight_;
    Time sent_at_;
    int resends_ = 0;

    Time motion_end_;           // When the board can have done all that it has taken.
    bool finishing_ = false;    // Every packet is taken.
    bool finish_told_ = false;  // By the board, maybe while the last packet was under way.
    bool holding_ = false;      // Wanted.
    bool held_ = false;         // Had.
    bool board_holds_ = false;  // By PN; without it the job hadn't begun.
    Time held_since_;
    bool stopping_ = false;
    Time stopping_since_;
    bool moving_by_hand_ = false;  // Homing or jogging.
    bool homing_ = false;
    std::optional<Time> homing_since_;  // When the board took the command.
    bool was_busy_ = false;             // Since the last packet.
    bool homed_ = false;
    StepPlace place_;

    DeviceStatus status_;
    JobProgress progress_;
};

}  // namespace leafcutter::drivers
