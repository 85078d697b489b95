// Packets to a Lihuiyu board: 30 bytes of LHYMICRO-GL, short ones filled up with F, and a checksum.
//
// On the wire, a USB bulk pipe or a byte stream that stands in for it, the CH341 in EPP mode wants
// A6 ("write data") before every 31 bytes:
//
//   host:  A6 00 <30 bytes>   A6 <checksum>      34 bytes: one packet, two USB transfers
//   host:  A0                                    asks for the status
//   board: FF <status> 6F 08 13 00               6 bytes; only the second counts
//
// The checksum is CRC-8 of Dallas/Maxim (x^8 + x^5 + x^4 + 1, reflected, from 0) over the 30 bytes.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

inline constexpr std::size_t kPayloadBytes = 30;
inline constexpr std::size_t kWirePacketBytes = 34;
inline constexpr std::size_t kFirstTransferBytes = 32;
inline constexpr std::size_t kStatusBytes = 6;
inline constexpr char kWriteData = '\xA6';
inline constexpr char kAskStatus = '\xA0';

using Payload = std::array<char, kPayloadBytes>;

std::uint8_t crc8(std::string_view bytes);

// `text` has at most 30 bytes; the rest becomes F.
Payload make_payload(std::string_view text);

inline std::string_view view(const Payload& payload) {
    return {payload.data(), payload.size()};
}

std::string wire_bytes(const Payload& payload);

// What the board says. Others were never seen.
enum class BoardStatus : std::uint8_t {
    SerialOk = 204,  // On an M3 also: finished.
    Ok = 206,        // The last packet was good; the next may come.
    CrcError = 207,  // The last packet was not taken.
    Finished = 236,
    Busy = 238,  // Its buffer is full.
    Power = 239  // Not initialised, or the laser's supply is off.
};

// Bit 2 is low while the board says that it has finished: 236 and 204 are such.
inline bool says_finished(std::uint8_t status) {
    return (status & 0x02U) == 0;
}

}  // namespace leafcutter::drivers
