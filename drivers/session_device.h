// A controller on a transport, as a Device.

#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "drivers/device.h"
#include "drivers/session.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

class SessionDevice final : public Device {
public:
    using Clock = std::function<Session::Time()>;

    using MakeSession = std::function<std::unique_ptr<Session>(Session::Time now)>;

    SessionDevice(std::string uri,
                  std::unique_ptr<Transport> transport,
                  const MakeSession& make_session,
                  Clock clock = std::chrono::steady_clock::now);
    SessionDevice(const SessionDevice&) = delete;
    SessionDevice& operator=(const SessionDevice&) = delete;

    // A running job is stopped with the beam off, as far as the link still carries it.
    ~SessionDevice() override;

    // Works until the controller has answered who it is. Throws LinkLost if it doesn't.
    void attach();

    std::string uri() const override { return uri_; }
    DeviceStatus status() const override;
    JobProgress progress() const override;
    void start(std::string program) override;
    void hold() override;
    void resume() override;
    void cancel() override;
    void stop() override;
    void home() override;
    void unlock() override;
    void jog(const Jog& jog) override;
    void jog_cancel() override;
    void console(std::string line) override;
    void set_overrides(const std::array<int, 3>& percent) override;
    std::vector<MachineSetting> settings() const override;
    void set_setting(std::string_view key, double value) override;
    void run_once(std::chrono::milliseconds slice) override;

private:
    void turn(std::chrono::milliseconds wait);
    void write_output();
    void close();
    [[noreturn]] void end_link(std::string reason);

    std::string uri_;
    std::unique_ptr<Transport> transport_;  // Of the owner thread alone.
    Clock clock_;
    mutable std::mutex mutex_;  // Guards *session_; never held while waiting.
    std::unique_ptr<Session> session_;
    bool gone_ = false;  // Of the owner thread alone.
};

}  // namespace leafcutter::drivers
