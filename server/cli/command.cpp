#include "server/cli/command.h"

#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "drivers/device.h"
#include "drivers/transport.h"
#include "geometry/error.h"

namespace leafcutter::server {

namespace {

struct Outcome {
    ExitStatus status;
    std::string code;
};

// One place that knows which exception ends with which exit status.
Outcome outcome_of(const std::exception& error) {
    if (const auto* refused = dynamic_cast<const geometry::Error*>(&error)) {
        const bool ours = refused->kind() == geometry::ErrorKind::SelfCheck;
        return {ours ? kFailed : kRefused, refused->code()};
    }
    if (dynamic_cast<const UsageError*>(&error) != nullptr) {
        return {kRefused, "usage"};
    }
    if (dynamic_cast<const drivers::LinkLost*>(&error) != nullptr ||
        dynamic_cast<const drivers::Refused*>(&error) != nullptr ||
        dynamic_cast<const DeviceFailed*>(&error) != nullptr) {
        return {kDeviceFailed, "device"};
    }
    if (dynamic_cast<const geometry::Cancelled*>(&error) != nullptr) {
        return {kFailed, "cancelled"};
    }
    return {kFailed, "internal"};
}

}  // namespace

int report_error(const std::exception& error, const CommonOptions& common) {
    const Outcome outcome = outcome_of(error);
    std::string line;
    if (common.json) {
        line = nlohmann::json({{"error", error.what()}, {"code", outcome.code}})
                   .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    } else {
        line = std::string("leafcutter: ") + error.what();
    }
    for (char& letter : line) {
        if (letter == '\n') {
            letter = ' ';
        }
    }
    std::fprintf(stderr, "%s\n", line.c_str());
    return outcome.status;
}

}  // namespace leafcutter::server
