#include "drivers/lihuiyu/packer.h"

#include <utility>

namespace leafcutter::drivers {

std::string EncodedJob::stream() const {
    std::string bytes;
    bytes.reserve(packets.size() * kPayloadBytes);
    for (const JobPacket& packet : packets) {
        bytes += view(packet.payload);
    }
    return bytes;
}

void Packer::dark(std::string_view bytes) {
    put_out();
    for (const char byte : bytes) {
        fill_ += byte;
        if (fill_.size() == kPayloadBytes) {
            flush();
        }
    }
}

void Packer::lit(std::string_view token, double seconds) {
    const std::size_t needed = token.size() + (lit_ ? 0 : 1) + 1;
    const bool too_long = burn_s_ > 0.0 && burn_s_ + seconds > longest_burn_s_;
    if (fill_.size() + needed > kPayloadBytes || too_long) {
        close();
    }
    if (!lit_) {
        fill_ += 'D';
        lit_ = true;
    }
    fill_ += token;
    burn_s_ += seconds;
}

void Packer::passed(double seconds, const StepPlace& end) {
    place_ = end;
    seconds_ += seconds;
}

EncodedJob Packer::finish() {
    dark("FNSE");
    const bool full_to_the_end = fill_.empty();
    if (full_to_the_end) {
        fill_ += 'F';  // An M3 forgets a program whose data end exactly with a packet.
    }
    flush();
    return std::move(job_);
}

void Packer::put_out() {
    if (lit_) {
        fill_ += 'U';
        lit_ = false;
        if (fill_.size() == kPayloadBytes) {
            flush();
        }
    }
}

void Packer::close() {
    put_out();
    if (!fill_.empty()) {
        fill_.resize(kPayloadBytes, 'U');
        flush();
    }
}

void Packer::flush() {
    job_.packets.push_back({make_payload(fill_), seconds_, place_});
    job_.seconds += seconds_;
    fill_.clear();
    seconds_ = burn_s_ = 0.0;
}

}  // namespace leafcutter::drivers
