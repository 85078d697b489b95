// A controller's protocol as its sender sees it: pure, bytes and time in, bytes out. Opens nothing.
// One for each family of controllers; SessionDevice puts it on a transport.

#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device.h"

namespace leafcutter::drivers {

class Session {
public:
    using Time = std::chrono::steady_clock::time_point;

    virtual ~Session() = default;

    virtual void receive(std::string_view bytes, Time now) = 0;

    // Lets what is due happen. Throws LinkLost when the controller has fallen silent.
    virtual void tick(Time now) = 0;

    // The bytes to write now.
    virtual std::string take_output() = 0;

    // Lines received since the last call, for a console view.
    virtual std::vector<std::string> take_lines() = 0;

    // The controller has said who it is and what state it is in.
    virtual bool attached() const = 0;

    // Nothing of ours burns or moves: the link may be closed.
    virtual bool may_close() const = 0;

    // The commands of Device. Throw Refused.
    virtual void start(std::string_view program) = 0;
    virtual void hold() = 0;
    virtual void resume() = 0;
    virtual void cancel() = 0;
    virtual void stop() = 0;
    virtual void home() = 0;
    virtual void unlock() = 0;
    virtual void jog(const Jog& jog) = 0;
    virtual void jog_cancel() = 0;
    virtual void console(std::string_view line) = 0;
    virtual void set_overrides(const std::array<int, 3>& /*percent*/) {
        throw Refused("overrides: this machine has none");
    }

    virtual std::vector<MachineSetting> settings() const { return {}; }
    virtual void set_setting(std::string_view /*key*/, double /*value*/) {
        throw Refused("settings: this machine has none");
    }

    // The link is gone: a running job ends as LinkLost.
    virtual void lose_link(const std::string& reason) = 0;

    // What is written to a controller that has fallen silent but may still hear: its beam must not
    // outlive us.
    virtual std::string_view last_words() const = 0;

    virtual const DeviceStatus& status() const = 0;
    virtual const JobProgress& progress() const = 0;

    // Of a program's lines, no more than so many are sent.
    void allow_lines(std::size_t lines) { lines_allowed_ = lines; }

protected:
    bool may_send_line(std::size_t lines_sent) const { return lines_sent < lines_allowed_; }

private:
    std::size_t lines_allowed_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace leafcutter::drivers
