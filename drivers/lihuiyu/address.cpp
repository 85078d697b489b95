#include "drivers/lihuiyu/address.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

#include "drivers/lihuiyu/ch341_transport.h"
#include "drivers/lihuiyu/session.h"
#include "drivers/session_device.h"
#include "drivers/sim/lihuiyu_transport.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

constexpr std::string_view kScheme = "lihuiyu:";
constexpr std::string_view kSimulated = "sim:lihuiyu";
constexpr double kInchMm = 25.4;

template <typename Number>
Number read_number(std::string_view key, std::string_view value) {
    Number number{};
    const char* const last = value.data() + value.size();
    const auto [end, error] = std::from_chars(value.data(), last, number);
    if (error != std::errc{} || end != last || !(number >= 0)) {
        throw std::invalid_argument(
            fmt::format("lihuiyu: {} must be a number of 0 or more, not \"{}\"", key, value));
    }
    return number;
}

double read_positive(std::string_view key, std::string_view value) {
    const auto number = read_number<double>(key, value);
    if (!(number > 0.0) || number > 1e6) {
        throw std::invalid_argument(fmt::format("lihuiyu: {} must be above 0, not {}", key, value));
    }
    return number;
}

void set_usb_option(std::string_view key, std::string_view value, LihuiyuAddress& address) {
    const bool usb = address.link.empty();
    if (usb && key == "bus") {
        address.usb.bus = read_number<unsigned>(key, value);
    } else if (usb && key == "address") {
        address.usb.address = read_number<unsigned>(key, value);
    } else if (usb && key == "port") {
        address.usb.port = value;
    } else if (!set_lihuiyu_option(key, value, address.encoder)) {
        throw std::invalid_argument(
            fmt::format("lihuiyu: unknown setting \"{}\"; known are {}board, width, height, x, "
                        "down, dpi, slope",
                        key, usb ? "bus, address, port, " : ""));
    }
}

std::unique_ptr<Device> attached(std::string_view uri,
                                 std::unique_ptr<Transport> transport,
                                 const EncoderOptions& options) {
    auto device = std::make_unique<SessionDevice>(
        std::string(uri), std::move(transport),
        [&options](Session::Time now) { return std::make_unique<LihuiyuSession>(options, now); });
    device->attach();
    return device;
}

}  // namespace

bool set_lihuiyu_option(std::string_view key, std::string_view value, EncoderOptions& options) {
    LihuiyuBed& bed = options.bed;
    if (key == "board") {
        options.speed.board = parse_lihuiyu_board(value);
    } else if (key == "slope") {
        options.speed.slope = read_positive(key, value);
    } else if (key == "width") {
        bed.width_mm = read_positive(key, value);
    } else if (key == "height") {
        // The origin stays in the lower left corner, unless it was put elsewhere.
        const bool in_corner = bed.origin_down_mm == bed.height_mm;
        bed.height_mm = read_positive(key, value);
        bed.origin_down_mm = in_corner ? bed.height_mm : bed.origin_down_mm;
    } else if (key == "x") {
        bed.origin_x_mm = read_number<double>(key, value);
    } else if (key == "down") {
        bed.origin_down_mm = read_number<double>(key, value);
    } else if (key == "dpi") {
        bed.steps_per_mm = read_positive(key, value) / kInchMm;
    } else {
        return false;
    }
    return true;
}

LihuiyuAddress parse_lihuiyu_address(std::string_view text) {
    const std::size_t question = std::min(text.find('?'), text.size());
    const std::string_view place = text.substr(0, question);
    LihuiyuAddress address;
    address.usb.vendor = kLihuiyuVendor;
    address.usb.product = kLihuiyuProduct;
    const bool link = place.substr(0, 6) == "tcp://" || place.substr(0, 1) == "/";
    if (!link && place != "usb") {
        throw std::invalid_argument(fmt::format(
            "device \"lihuiyu:{}\": must be lihuiyu:usb?bus=N&address=N, lihuiyu:tcp://host:port "
            "or lihuiyu:/dev/PORT",
            text));
    }
    address.link = link ? place : std::string_view();
    std::string_view query = text.substr(std::min(question + 1, text.size()));
    while (!query.empty()) {
        const std::size_t end = std::min(query.find('&'), query.size());
        const std::string_view pair = query.substr(0, end);
        query.remove_prefix(std::min(end + 1, query.size()));
        const std::size_t equals = std::min(pair.find('='), pair.size());
        set_usb_option(pair.substr(0, equals), pair.substr(std::min(equals + 1, pair.size())),
                       address);
    }
    return address;
}

std::unique_ptr<Device> open_lihuiyu(std::string_view uri) {
    if (uri.substr(0, kScheme.size()) == kScheme) {
        const LihuiyuAddress address = parse_lihuiyu_address(uri.substr(kScheme.size()));
        return attached(uri,
                        address.link.empty() ? open_ch341(open_usb_pipe(address.usb))
                                             : open_transport(address.link),
                        address.encoder);
    }
    SimLihuiyuOptions options =
        parse_simulated_lihuiyu(uri.substr(std::min(kSimulated.size() + 1, uri.size())));
    return attached(uri, open_ch341(open_simulated_lihuiyu(options)), options.encoder);
}

}  // namespace leafcutter::drivers
