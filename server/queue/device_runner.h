// One thread per machine, the only one that drives it: connects, follows its state, takes armed
// cuts up, and writes down what became of them. The beam is at-most-once: a cut's intent is on disk
// before its first line is sent, and a cut whose link or daemon went away is never sent again.

#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "drivers/device.h"
#include "server/queue/cut_beam.h"
#include "server/store/store.h"

namespace leafcutter::server {

// What becomes of a cut in work when the daemon stops. Finish waits for the end of its sheet before
// the runners are stopped (set_appetite()); a runner that is stopped all the same pauses.
enum class StopPolicy { Pause, Finish, Abort };

struct DeviceHooks {
    // Opens a machine; throws LinkLost or std::invalid_argument.
    std::function<std::unique_ptr<drivers::Device>(std::string_view uri)> open;
    std::function<void(const std::string& device)> on_device;  // Its status changed; <= 5 Hz.
    std::function<void(const std::string& cut)> on_cut;        // Its progress or actions changed.
    StopPolicy stop_policy = StopPolicy::Pause;
};

// Whether the machine's link may be opened at once, or only after an operator looked at it: opening
// a serial port resets many controllers, and a cut may still be draining from one.
enum class FirstContact { AtOnce, AfterReset };

class DeviceRunner {
public:
    DeviceRunner(DeviceRecord record, Store& store, DeviceHooks hooks, FirstContact contact);

    // A running cut is held, then cancelled with the beam off, and becomes interrupted.
    ~DeviceRunner();
    DeviceRunner(const DeviceRunner&) = delete;
    DeviceRunner& operator=(const DeviceRunner&) = delete;

    const DeviceRecord& record() const { return record_; }
    drivers::DeviceStatus status() const;
    std::vector<std::string> console_lines() const;

    // The cut in work, and how far it is.
    std::optional<std::string> current_cut() const;
    std::optional<CutRecord> cut_in_work() const;  // Begun for certain.
    std::optional<CutProgress> live_progress(const std::string& cut) const;

    // The machine is idle and nothing is in work: a cut may start. Both wait where the end of a cut
    // is just being written down: who reads there that it is over finds the machine free.
    bool is_ready() const;
    bool is_cutting() const;

    // There may be an armed cut.
    void wake();

    // Whether anything new is begun; the sheet in work goes on.
    enum class Appetite { TakesMore, TakesNoMore };
    void set_appetite(Appetite appetite) { closing_ = appetite == Appetite::TakesNoMore; }

    // Something was plugged in: its machine may be back.
    void look_for_machine();

    // None of these waits for the machine or the database. Those for a cut return false if it is
    // not in work.
    bool pause(const std::string& cut);
    bool resume(const std::string& cut);
    bool abort(const std::string& cut);
    void hold();
    void resume();
    void stop();

    // Also lets a disconnected machine connect again, and one that starts cuts of itself go on
    // after a cut that ended early.
    void reset();

    // Percent of feed, rapid and power; what isn't given stays. Throws drivers::Refused without a
    // link, or where the machine has none.
    void set_overrides(const std::array<std::optional<int>, 3>& percent);

    // What the machine's controller keeps of itself. Throws drivers::Refused without a link.
    std::vector<drivers::MachineSetting> settings() const;

    // Throw drivers::Refused while a cut is in work or without a link.
    void set_setting(std::string_view key, double value);
    void home();
    void unlock();
    void jog(const drivers::Jog& jog);
    void console(const std::string& line);

    // Traces the bounding box of the next cut's sheet with the beam off. Throws drivers::Refused.
    void frame();

    // The SHA-256 of the program whose sheet was traced last since the daemon began; empty: none.
    std::string framed() const;

private:
    using Clock = std::chrono::steady_clock;

    void loop(const std::stop_token& stop);
    void connect(const std::stop_token& stop);
    void lose_link(const std::string& why);
    void settle_lost(const std::stop_token& stop);
    void disarm();
    void look_at_place(const drivers::DeviceStatus& status);
    void step();
    void follow_cut();
    void settle(const drivers::JobProgress& progress);
    void close_beam(const drivers::JobProgress& progress);
    void write_outcome(const CutRecord& cut, const drivers::JobProgress& progress);
    void take_up_next();
    void take_up(const CutRecord& cut);
    void start_next_of(const std::vector<CutRecord>& open);
    bool waits_for_word() const;
    void fire(const CutRecord& cut);
    void start_program(const CutRecord& cut, const std::string& program);
    void start_frame(const std::string& program);
    void publish();
    std::uint64_t lines_heard() const;
    void wind_down();

    std::shared_ptr<drivers::Device> device() const;
    std::shared_ptr<drivers::Device> connected_device() const;
    std::shared_ptr<drivers::Device> device_for_hand_work() const;
    void keep_line(std::string_view line);
    void say(const std::string& message);

    const DeviceRecord record_;
    Store& store_;
    const DeviceHooks hooks_;
    std::atomic<bool> look_at_queue_{true};
    std::atomic<bool> queue_changed_{false};  // What its cuts allow may have changed with it.
    std::atomic<bool> framing_{false};
    std::atomic<bool> closing_{false};
    std::atomic<bool> word_given_{false};  // By a reset since the last cut began.

    mutable std::mutex settling_;  // Held from before a cut's end is on disk until it is let go.
    mutable std::mutex mutex_;     // Guards the members up to the next blank line.
    std::condition_variable_any nudged_;
    // Shared: a caller may be inside the device while the runner drops it.
    std::shared_ptr<drivers::Device> device_;
    std::optional<CutRecord> current_;
    CutProgress progress_;
    bool abort_wanted_ = false;
    bool may_connect_ = true;
    bool plugged_in_ = false;
    std::optional<std::string> frame_program_;
    std::string framed_;   // The program that frame_program_, or the last one, was made of.
    std::string message_;  // Why there is no link.
    std::deque<std::string> lines_;
    std::uint64_t lines_heard_ = 0;  // Ever: those that left the console count, too.

    // Of the runner's thread alone.
    std::optional<drivers::JobProgress> lost_;  // Of the cut whose link is gone, not yet on disk.
    std::unique_ptr<CutBeam> beam_;             // Of the cut in work, if it can be followed.
    std::optional<BeamRecord> ended_beam_;      // Its end, not yet on disk.
    std::string trouble_;                       // Why the runner itself stopped the cut.
    Clock::time_point next_record_{};
    Clock::time_point next_store_try_{};
    Clock::time_point next_publish_{};
    Clock::time_point next_queue_look_{};
    std::string published_;
    std::string published_freedom_;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
