#include "drivers/pty.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <termios.h>

#include "drivers/transport.h"

namespace leafcutter::drivers {

Pty open_pty() {
    Pty pty;
    pty.controller = FileDescriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    std::array<char, 128> name{};
    if (!pty.controller.is_open() || grantpt(pty.controller.get()) != 0 ||
        unlockpt(pty.controller.get()) != 0 ||
        ptsname_r(pty.controller.get(), name.data(), name.size()) != 0) {
        throw LinkLost("pseudo terminal: " + error_text(errno));
    }
    pty.port_path = name.data();
    pty.keeper = FileDescriptor(open(name.data(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    termios settings{};
    if (!pty.keeper.is_open() || tcgetattr(pty.keeper.get(), &settings) != 0) {
        throw LinkLost(pty.port_path + ": " + error_text(errno));
    }
    cfmakeraw(&settings);
    tcsetattr(pty.keeper.get(), TCSANOW, &settings);
    return pty;
}

}  // namespace leafcutter::drivers
