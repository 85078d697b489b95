#include "server/log_format.h"

#include <cerrno>
#include <cstddef>
#include <memory>
#include <mutex>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <unistd.h>

#include <climits>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace leafcutter::server {

namespace {

// %*: the message as a JSON string; it may hold whatever a client once sent.
class JsonMessage : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message,
                const std::tm&,
                spdlog::memory_buf_t& out) override {
        const nlohmann::json text(std::string(message.payload.data(), message.payload.size()));
        const std::string quoted =
            text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        out.append(quoted.data(), quoted.data() + quoted.size());
    }
    std::unique_ptr<custom_flag_formatter> clone() const override {
        return std::make_unique<JsonMessage>();
    }
};

// Standard error without ever waiting for whoever reads it: a thread that feeds a laser writes
// here, too. What finds no room is lost, and counted.
class PatientSink : public spdlog::sinks::base_sink<std::mutex> {
protected:
    void sink_it_(const spdlog::details::log_msg& message) override {
        if (lost_ > 0) {
            const std::string words = fmt::format("{} lines lost: nobody read them", lost_);
            const spdlog::details::log_msg told(message.logger_name, spdlog::level::warn, words);
            if (!write(told)) {
                ++lost_;
                return;
            }
            lost_ = 0;
        }
        lost_ += write(message) ? 0 : 1;
    }
    void flush_() override {}

private:
    // False: it is lost.
    bool write(const spdlog::details::log_msg& message) {
        if (!write_rest()) {
            return false;
        }
        spdlog::memory_buf_t text;
        formatter_->format(message, text);
        rest_.assign(text.data(), text.size());
        write_rest();
        return true;
    }

    // No line is torn: its end is kept for the next time.
    bool write_rest() {
        while (!rest_.empty()) {
            pollfd wanted{STDERR_FILENO, POLLOUT, 0};
            const bool has_room = ::poll(&wanted, 1, 0) > 0 && (wanted.revents & POLLOUT) != 0;
            const ssize_t sent = has_room ? send(rest_) : -1;
            if (sent <= 0) {
                return false;
            }
            rest_.erase(0, static_cast<std::size_t>(sent));
        }
        return true;
    }

    // A pipe that says it can be written has room for PIPE_BUF bytes.
    static ssize_t send(std::string_view text) {
        text = text.substr(0, PIPE_BUF);
        const ssize_t sent =
            ::send(STDERR_FILENO, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        return sent < 0 && errno == ENOTSOCK ? ::write(STDERR_FILENO, text.data(), text.size())
                                             : sent;
    }

    std::string rest_;  // At most one line.
    std::size_t lost_ = 0;
};

}  // namespace

void begin_log(LogFormat format) {
    if (format == LogFormat::Text && ::isatty(STDERR_FILENO) != 0) {
        spdlog::set_default_logger(spdlog::stderr_color_mt("leafcutter"));
    } else {
        spdlog::set_default_logger(
            std::make_shared<spdlog::logger>("leafcutter", std::make_shared<PatientSink>()));
    }
    if (format == LogFormat::Text) {
        spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
        return;
    }
    auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
    formatter->add_flag<JsonMessage>('*').set_pattern(
        R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l","message":%*})");
    spdlog::set_formatter(std::move(formatter));
}

}  // namespace leafcutter::server
