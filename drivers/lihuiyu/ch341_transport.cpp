#include "drivers/lihuiyu/ch341_transport.h"

#include <algorithm>
#include <utility>

#include "drivers/lihuiyu/packet.h"

namespace leafcutter::drivers {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::uint8_t kInitParallel = 0xB1;
constexpr std::uint16_t kEpp19 = 0x0102;
constexpr milliseconds kTransferTime{200};
constexpr std::chrono::seconds kWriteTime{5};
constexpr std::size_t kCrcTransferBytes = kWirePacketBytes - kFirstTransferBytes;

class Ch341Transport final : public Transport {
public:
    explicit Ch341Transport(std::unique_ptr<UsbPipe> pipe) : pipe_(std::move(pipe)) {
        pipe_->control_out(kInitParallel, kEpp19);
    }

    // Nothing comes unless a status was asked for.
    std::string read_some(milliseconds timeout) override {
        if (asked_ == 0) {
            pipe_->rest(timeout);
            return {};
        }
        std::string bytes = pipe_->bulk_read(kFirstTransferBytes, timeout);
        if (!bytes.empty()) {
            --asked_;
        }
        return bytes;
    }

    // `bytes` are whole packets and questions.
    void write_all(std::string_view bytes) override {
        while (!bytes.empty()) {
            const bool question = bytes[0] == kAskStatus;
            if (question) {
                transfer(take(bytes, 1));
                ++asked_;
            } else {
                transfer(take(bytes, kFirstTransferBytes));
                transfer(take(bytes, kCrcTransferBytes));
            }
        }
    }

    std::string description() const override { return pipe_->description(); }

private:
    static std::string_view take(std::string_view& bytes, std::size_t count) {
        const std::string_view taken = bytes.substr(0, count);
        bytes.remove_prefix(taken.size());
        return taken;
    }

    // All or nothing: the chip takes a transfer in one piece.
    void transfer(std::string_view bytes) {
        const auto end = Clock::now() + kWriteTime;
        for (;;) {
            const std::size_t done = pipe_->bulk_write(bytes, kTransferTime);
            if (done == bytes.size()) {
                return;
            }
            if (done != 0) {
                throw LinkLost(description() + ": the board has taken half a packet");
            }
            if (Clock::now() > end) {
                throw LinkLost(description() + ": the board takes no bytes any more");
            }
        }
    }

    std::unique_ptr<UsbPipe> pipe_;
    std::size_t asked_ = 0;  // Statuses not yet read.
};

}  // namespace

std::unique_ptr<Transport> open_ch341(std::unique_ptr<UsbPipe> pipe) {
    return std::make_unique<Ch341Transport>(std::move(pipe));
}

}  // namespace leafcutter::drivers
