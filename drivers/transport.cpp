#include "drivers/transport.h"

#include <charconv>

#include "drivers/serial_port.h"
#include "drivers/tcp_socket.h"

namespace leafcutter::drivers {

namespace {

constexpr unsigned kDefaultBaud = 115200;
constexpr std::string_view kTcp = "tcp://";

unsigned read_baud(std::string_view address, std::string_view query) {
    constexpr std::string_view kKey = "baud=";
    unsigned baud = 0;
    const char* const last = query.data() + query.size();
    if (query.substr(0, kKey.size()) == kKey) {
        const auto [end, error] = std::from_chars(query.data() + kKey.size(), last, baud);
        if (error == std::errc{} && end == last && baud >= 50) {
            return baud;
        }
    }
    throw std::invalid_argument("device \"" + std::string(address) +
                                "\": after the ? only baud=NUMBER (50 or more) is known");
}

}  // namespace

std::unique_ptr<Transport> open_transport(std::string_view address) {
    if (address.substr(0, kTcp.size()) == kTcp) {
        std::string_view place = address.substr(kTcp.size());
        const std::size_t colon = place.rfind(':');
        if (colon == std::string_view::npos || colon == 0 || colon + 1 == place.size()) {
            throw std::invalid_argument("device \"" + std::string(address) +
                                        "\": must be tcp://host:port");
        }
        const bool bracketed = place[0] == '[' && place[colon - 1] == ']';
        const std::string_view host =
            bracketed ? place.substr(1, colon - 2) : place.substr(0, colon);
        return open_tcp_socket(std::string(host), std::string(place.substr(colon + 1)));
    }
    const std::size_t question = address.find('?');
    const std::string path(address.substr(0, question));
    if (path.empty()) {
        throw std::invalid_argument("device: no port is named");
    }
    const unsigned baud = question == std::string_view::npos
                              ? kDefaultBaud
                              : read_baud(address, address.substr(question + 1));
    return open_serial_port(path, baud);
}

}  // namespace leafcutter::drivers
