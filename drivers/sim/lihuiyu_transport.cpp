#include "drivers/sim/lihuiyu_transport.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "drivers/lihuiyu/address.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

class SimUsbPipe final : public UsbPipe {
public:
    explicit SimUsbPipe(const SimLihuiyuOptions& options)
        : machine_(options.machine),
          speed_(options.host.speed),
          before_(Clock::now()),
          burn_file_(open_burn_file(options.host.burn_path)) {}
    SimUsbPipe(const SimUsbPipe&) = delete;
    SimUsbPipe& operator=(const SimUsbPipe&) = delete;
    ~SimUsbPipe() override {
        if (burn_file_.is_open()) {
            machine_.beam_log().flush(burn_file_);
        }
    }

    void control_out(std::uint8_t /*request*/, std::uint16_t /*value*/) override { look(); }

    std::size_t bulk_write(std::string_view bytes, milliseconds /*timeout*/) override {
        look();
        answers_ += machine_.feed(bytes);
        return bytes.size();
    }

    std::string bulk_read(std::size_t most, milliseconds timeout) override {
        look();
        if (answers_.empty()) {
            std::this_thread::sleep_for(timeout);
        }
        std::string bytes = answers_.substr(0, most);
        answers_.erase(0, bytes.size());
        return bytes;
    }

    // The machine waits for questions.
    void rest(milliseconds time) override { std::this_thread::sleep_for(time); }

    std::string description() const override { return "simulated Lihuiyu board"; }

private:
    void look() {
        if (machine_.unplugged()) {
            throw LinkLost(description() + ": unplugged");
        }
        const Clock::time_point now = Clock::now();
        const double passed_s = std::chrono::duration<double>(now - before_).count();
        before_ = now;
        if (speed_ > 0.0) {
            machine_.advance(passed_s * speed_);
        } else {
            machine_.hurry();
        }
        if (!machine_.violations().empty()) {
            const Violation& first = machine_.violations().front();
            throw LinkLost(
                fmt::format("{}: at {:.3f} s: {}", description(), first.t_s, first.text));
        }
    }

    LihuiyuMachine machine_;
    double speed_;
    Clock::time_point before_;
    std::string answers_;
    std::ofstream burn_file_;
};

}  // namespace

SimLihuiyuOptions parse_simulated_lihuiyu(std::string_view query) {
    SimLihuiyuOptions options;
    while (!query.empty()) {
        const std::size_t end = std::min(query.find('&'), query.size());
        const std::string_view pair = query.substr(0, end);
        query.remove_prefix(std::min(end + 1, query.size()));
        const std::size_t equals = std::min(pair.find('='), pair.size());
        const std::string_view key = pair.substr(0, equals);
        const std::string_view value = pair.substr(std::min(equals + 1, pair.size()));
        if (key == "burn") {
            options.host.burn_path = value;
        } else if (key == "fault") {
            options.machine.fault = parse_lihuiyu_fault(value);
        } else if (key == "speed") {
            const char* const last = value.data() + value.size();
            const auto [stop, error] = std::from_chars(value.data(), last, options.host.speed);
            if (error != std::errc{} || stop != last || !(options.host.speed >= 0.0)) {
                throw std::invalid_argument("sim:lihuiyu: speed must be a number of 0 or more");
            }
        } else if (!set_lihuiyu_option(key, value, options.encoder)) {
            throw std::invalid_argument(fmt::format(
                "sim:lihuiyu: unknown setting \"{}\"; known are burn, speed, fault, board, width, "
                "height, x, down, dpi, slope",
                key));
        }
    }
    options.machine.bed = options.encoder.bed;
    options.machine.speed = options.encoder.speed;
    return options;
}

std::unique_ptr<UsbPipe> open_simulated_lihuiyu(const SimLihuiyuOptions& options) {
    return std::make_unique<SimUsbPipe>(options);
}

}  // namespace leafcutter::drivers
