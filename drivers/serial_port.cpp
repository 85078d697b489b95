#include "drivers/serial_port.h"

#include <asm/termbits.h>
#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <utility>

#include <climits>

#include "drivers/file_descriptor.h"
#include "drivers/port_discovery.h"

namespace leafcutter::drivers {

namespace {

class SerialPort final : public Transport {
public:
    SerialPort(FileDescriptor file, std::string path, bool exclusive)
        : file_(std::move(file)), path_(std::move(path)), exclusive_(exclusive) {}

    SerialPort(const SerialPort&) = delete;
    SerialPort& operator=(const SerialPort&) = delete;

    ~SerialPort() override {
        if (exclusive_) {
            ioctl(file_.get(), TIOCNXCL);
        }
    }

    std::string read_some(std::chrono::milliseconds timeout) override {
        return read_from(file_, path_, timeout);
    }
    void write_all(std::string_view bytes) override { write_to(file_, path_, bytes); }
    std::string description() const override { return path_; }

private:
    FileDescriptor file_;
    std::string path_;
    bool exclusive_;
};

// termios2 takes any baud rate, not only the listed ones (asm/termbits.h, BOTHER).
void set_raw(const FileDescriptor& file, const std::string& path, unsigned baud) {
    termios2 settings{};
    if (ioctl(file.get(), TCGETS2, &settings) != 0) {
        throw LinkLost(path + ": is no serial port (" + error_text(errno) + ")");
    }
    settings.c_iflag = IGNBRK;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
    settings.c_ispeed = baud;
    settings.c_ospeed = baud;
    settings.c_cc[VMIN] = 0;
    settings.c_cc[VTIME] = 0;
    if (ioctl(file.get(), TCSETS2, &settings) != 0) {
        throw LinkLost(path + ": refuses " + std::to_string(baud) + " baud (" + error_text(errno) +
                       ")");
    }
    ioctl(file.get(), TCFLSH, TCIOFLUSH);
}

// A pty keeps TIOCEXCL when its user dies, as long as its other end lives; the file lock is enough
// there.
bool is_pty(const std::string& path) {
    char* const real = realpath(path.c_str(), nullptr);
    const bool pty = real != nullptr && std::string_view(real).substr(0, 9) == "/dev/pts/";
    std::free(real);
    return pty;
}

}  // namespace

std::unique_ptr<Transport> open_serial_port(const std::string& path, unsigned baud) {
    FileDescriptor file(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!file.is_open()) {
        throw LinkLost(path + ": " + diagnose_open_failure(path, errno));
    }
    if (flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
        throw LinkLost(path + ": " + diagnose_open_failure(path, EBUSY));
    }
    const bool exclusive = !is_pty(path) && ioctl(file.get(), TIOCEXCL) == 0;
    set_raw(file, path, baud);
    return std::make_unique<SerialPort>(std::move(file), path, exclusive);
}

}  // namespace leafcutter::drivers
