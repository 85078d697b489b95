#include "drivers/lihuiyu/packet.h"

#include <algorithm>
#include <cassert>

namespace leafcutter::drivers {

std::uint8_t crc8(std::string_view bytes) {
    constexpr unsigned kReflectedPolynomial = 0x8C;
    unsigned crc = 0;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
        }
    }
    return static_cast<std::uint8_t>(crc);
}

Payload make_payload(std::string_view text) {
    assert(text.size() <= kPayloadBytes);
    Payload payload;
    payload.fill('F');
    std::copy(text.begin(), text.end(), payload.begin());
    return payload;
}

std::string wire_bytes(const Payload& payload) {
    std::string bytes;
    bytes.reserve(kWirePacketBytes);
    bytes += kWriteData;
    bytes += '\0';
    bytes += view(payload);
    bytes += kWriteData;
    bytes += static_cast<char>(crc8(view(payload)));
    return bytes;
}

}  // namespace leafcutter::drivers
