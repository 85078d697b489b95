#include "drivers/session_device.h"

#include <algorithm>
#include <limits>
#include <thread>
#include <utility>

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

// The longest that a command from another thread, a stop above all, waits for its turn on the wire.
constexpr milliseconds kTurn{10};
constexpr milliseconds kAttachTime{12000};
constexpr milliseconds kCloseTime{2500};

}  // namespace

SessionDevice::SessionDevice(std::string uri,
                             std::unique_ptr<Transport> transport,
                             const MakeSession& make_session,
                             Clock clock)
    : uri_(std::move(uri)),
      transport_(std::move(transport)),
      clock_(std::move(clock)),
      session_(make_session(clock_())) {}

SessionDevice::~SessionDevice() {
    // Whoever lets go of a machine is often half taken down itself.
    on_line = nullptr;
    watch = nullptr;
    try {
        close();
    } catch (const std::exception&) {
        // The link is gone: there is nobody left to be told to stop.
        gone_ = true;
    }
}

void SessionDevice::close() {
    const auto end = clock_() + kCloseTime;
    const auto at_rest = [this] {
        const std::lock_guard lock(mutex_);
        return session_->may_close();
    };
    if (gone_ || at_rest()) {
        return;
    }
    cancel();
    while (!at_rest() && clock_() < end) {
        turn(kTurn);
    }
    if (!at_rest()) {
        stop();
        write_output();
    }
}

void SessionDevice::attach() {
    const auto end = clock_() + kAttachTime;
    const auto ready = [this] {
        const std::lock_guard lock(mutex_);
        return session_->attached();
    };
    while (!ready()) {
        if (clock_() > end) {
            throw LinkLost(transport_->description() + ": the controller doesn't say who it is");
        }
        run_once(kTurn);
    }
}

DeviceStatus SessionDevice::status() const {
    const std::lock_guard lock(mutex_);
    return session_->status();
}

JobProgress SessionDevice::progress() const {
    const std::lock_guard lock(mutex_);
    return session_->progress();
}

void SessionDevice::start(std::string program) {
    const std::lock_guard lock(mutex_);
    session_->allow_lines(watch ? 0 : std::numeric_limits<std::size_t>::max());
    session_->start(program);
}

void SessionDevice::hold() {
    const std::lock_guard lock(mutex_);
    session_->hold();
}

void SessionDevice::resume() {
    const std::lock_guard lock(mutex_);
    session_->resume();
}

void SessionDevice::cancel() {
    const std::lock_guard lock(mutex_);
    session_->cancel();
}

void SessionDevice::stop() {
    const std::lock_guard lock(mutex_);
    session_->stop();
}

void SessionDevice::home() {
    const std::lock_guard lock(mutex_);
    session_->home();
}

void SessionDevice::unlock() {
    const std::lock_guard lock(mutex_);
    session_->unlock();
}

void SessionDevice::jog(const Jog& jog) {
    const std::lock_guard lock(mutex_);
    session_->jog(jog);
}

void SessionDevice::jog_cancel() {
    const std::lock_guard lock(mutex_);
    session_->jog_cancel();
}

void SessionDevice::console(std::string line) {
    const std::lock_guard lock(mutex_);
    session_->console(line);
}

void SessionDevice::set_overrides(const std::array<int, 3>& percent) {
    const std::lock_guard lock(mutex_);
    session_->set_overrides(percent);
}

std::vector<MachineSetting> SessionDevice::settings() const {
    const std::lock_guard lock(mutex_);
    return session_->settings();
}

void SessionDevice::set_setting(std::string_view key, double value) {
    const std::lock_guard lock(mutex_);
    session_->set_setting(key, value);
}

void SessionDevice::write_output() {
    std::string output;
    {
        const std::lock_guard lock(mutex_);
        output = session_->take_output();
    }
    if (!output.empty()) {
        transport_->write_all(output);
    }
}

void SessionDevice::turn(milliseconds wait) {
    write_output();
    const std::string bytes = transport_->read_some(wait);
    std::vector<std::string> lines;
    {
        const std::lock_guard lock(mutex_);
        session_->receive(bytes, clock_());
        if (watch) {
            session_->allow_lines(watch->lines_allowed(session_->progress(), session_->status()));
        }
        session_->tick(clock_());
        lines = session_->take_lines();
    }
    write_output();
    if (on_line) {
        for (const std::string& line : lines) {
            on_line(line);
        }
    }
}

void SessionDevice::run_once(milliseconds slice) {
    if (gone_) {
        std::this_thread::sleep_for(slice);
        return;
    }
    const auto end = clock_() + slice;
    try {
        do {
            const auto left = std::chrono::duration_cast<milliseconds>(end - clock_());
            turn(std::clamp(left, milliseconds(0), kTurn));
        } while (clock_() < end);
    } catch (const LinkLost& lost) {
        end_link(lost.what());
    }
}

void SessionDevice::end_link(std::string reason) {
    gone_ = true;
    try {
        // A controller that only fell silent may still hear; its beam must not outlive us.
        transport_->write_all(session_->last_words());
    } catch (const LinkLost&) {
        gone_ = true;  // Nobody hears any more.
    }
    const std::string link = transport_->description();
    if (reason.find(link) == std::string::npos) {
        reason = link + ": " + reason;
    }
    {
        const std::lock_guard lock(mutex_);
        session_->lose_link(reason);
    }
    throw LinkLost(reason);
}

}  // namespace leafcutter::drivers
