// A machine that cuts. One thread owns a Device and calls run_once() again and again; every other
// member may be called from any thread and never waits for the machine.

#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::drivers {

enum class MachineState {
    Disconnected,
    Idle,
    Run,
    Hold,
    Jog,
    Home,
    Alarm,
    Door,
    Check,
    Sleep,
    Unknown
};

std::string_view to_string(MachineState state);

struct DeviceStatus {
    MachineState state = MachineState::Disconnected;
    std::array<double, 3> machine_position_mm{};
    std::array<double, 3> work_position_mm{};
    double feed_mm_per_min = 0.0;
    double power_s = 0.0;
    std::array<int, 3> override_percent{100, 100, 100};  // Feed, rapid, power.
    int alarm_code = 0;                                  // 0: none.
    std::string message;                                 // Last alarm or error, with its meaning.
    std::string firmware;
    std::size_t reports = 0;         // Measured positions received so far; 0: it reports none.
    std::size_t restarts = 0;        // Times that the controller began anew unasked.
    std::size_t planner_blocks = 0;  // Moves it holds unmoved at most; 0: not known.
};

enum class JobOutcome { Running, Done, Aborted, Failed, LinkLost };

struct JobProgress {
    JobOutcome outcome = JobOutcome::Done;
    std::size_t lines_total = 0;
    std::size_t lines_sent = 0;
    std::size_t lines_acknowledged = 0;
    std::string reason;  // Why it failed, naming the line.
};

struct Jog {
    double dx_mm = 0.0;
    double dy_mm = 0.0;
    double feed_mm_per_min = 1000.0;
};

// What a controller keeps of itself: "$110" of a Grbl.
struct MachineSetting {
    std::string key;
    double value = 0.0;
    std::string name;  // "X maximum rate, mm/min"; empty: nobody knows.
};

// Refused: the machine's state or a preflight check forbids it. The message says what to do.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// The program is at fault, not the machine.
class ProgramRefused : public Refused {
public:
    using Refused::Refused;
};

// Nobody knows where the head stands: home the machine first.
class NotHomed : public Refused {
public:
    using Refused::Refused;
};

// Looks over a running program: called by the thread of run_once() before more of it is sent, and
// may not wait.
class JobWatch {
public:
    virtual ~JobWatch() = default;

    // Returns how many of the program's lines may have been sent by now.
    virtual std::size_t lines_allowed(const JobProgress& progress, const DeviceStatus& status) = 0;
};

class Device {
public:
    virtual ~Device() = default;

    virtual std::string uri() const = 0;
    virtual DeviceStatus status() const = 0;
    virtual JobProgress progress() const = 0;

    // Queues a program (G-code text). Throws Refused while one runs, in Alarm, or if preflight
    // fails.
    virtual void start(std::string program) = 0;

    virtual void hold() = 0;  // Feed hold: decelerates, beam off, can be resumed.
    virtual void resume() = 0;
    virtual void cancel() = 0;  // Hold, wait until it stands, reset: position kept, beam off.
    virtual void stop() = 0;    // Emergency: reset at once, waits for nobody.
    virtual void home() = 0;
    virtual void unlock() = 0;
    virtual void jog(const Jog& jog) = 0;
    virtual void jog_cancel() = 0;
    virtual void console(std::string line) = 0;  // One line by hand; the reply comes to on_line.

    // Feed, rapid and power in percent while a program runs, as near as the controller's steps
    // allow; DeviceStatus::override_percent shows how far it has got. Throws Refused where the
    // controller has none.
    virtual void set_overrides(const std::array<int, 3>& percent);

    // As the controller listed them when it was met, or took them since. None of one that lists
    // none.
    virtual std::vector<MachineSetting> settings() const { return {}; }

    // Sent at once; settings() shows it once the controller has taken it, status().message why it
    // hasn't. Throws Refused for a setting that it has not, for a value that would harm, and while
    // the machine is not idle.
    virtual void set_setting(std::string_view key, double value);

    // Every line received, for a console view. Set before the first run_once(); called by its
    // thread, and never by the destructor.
    std::function<void(std::string_view line)> on_line;

    // Set by the thread of run_once(), before start(); without one, every line is sent. Never asked
    // by the destructor.
    std::shared_ptr<JobWatch> watch;

    // Works for at most `slice`: reads, feeds the stream, polls status. Throws LinkLost once when
    // the link is gone; the device is Disconnected from then on.
    virtual void run_once(std::chrono::milliseconds slice) = 0;
};

// Opens the device of a URI: grbl:/dev/ttyUSB0?baud=115200, grbl:tcp://host:port, marlin: and
// smoothie: alike, lihuiyu:usb?bus=1&address=4 (lihuiyu/address.h), sim:grbl, sim:marlin,
// sim:smoothie, sim:lihuiyu. The sim: ones start a simulated machine of their own; `?burn=FILE`
// keeps its beam log. With "power_cap=PERCENT" a device refuses programs of a higher S than that
// part of full power ($30 of a Grbl; "s_max=S" of the others, else 255 of Marlin, 1 of
// Smoothieware). "poll_ms=100" to 1000: a Grbl is asked for its status more or less often than 5
// times a second. "width=MM&height=MM": the bed of a Marlin or Smoothieware, which programs must
// not leave. Throws LinkLost, or std::invalid_argument for a URI it can't read.
std::unique_ptr<Device> open_device(std::string_view uri);

// Whether a URI begins like one that open_device() takes; opens nothing.
bool is_device_uri(std::string_view uri);

}  // namespace leafcutter::drivers
