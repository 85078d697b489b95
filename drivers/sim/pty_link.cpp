#include <cerrno>
#include <filesystem>
#include <poll.h>
#include <thread>
#include <unistd.h>

#include "drivers/pty.h"
#include "drivers/sim/sim_link.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

namespace fs = std::filesystem;

class PtyLink final : public SimLink {
public:
    explicit PtyLink(std::string symlink_path)
        : pty_(open_pty()), symlink_path_(std::move(symlink_path)) {
        if (symlink_path_.empty()) {
            return;
        }
        std::error_code none;
        if (fs::exists(fs::symlink_status(symlink_path_, none)) &&
            !fs::is_symlink(fs::symlink_status(symlink_path_, none))) {
            throw LinkLost(symlink_path_ +
                           ": is there already and no symbolic link; name another path");
        }
        fs::remove(symlink_path_, none);
        std::error_code fault;
        fs::create_symlink(pty_.port_path, symlink_path_, fault);
        if (fault) {
            throw LinkLost(symlink_path_ + ": " + fault.message());
        }
    }

    PtyLink(const PtyLink&) = delete;
    PtyLink& operator=(const PtyLink&) = delete;
    ~PtyLink() override { remove_symlink(); }

    std::string receive(std::chrono::milliseconds timeout) override {
        if (!pty_.controller.is_open()) {
            std::this_thread::sleep_for(timeout);
            return {};
        }
        return read_from(pty_.controller, pty_.port_path, timeout);
    }

    void send(std::string_view bytes) override {
        while (pty_.controller.is_open() && !bytes.empty()) {
            const ssize_t count = ::write(pty_.controller.get(), bytes.data(), bytes.size());
            if (count <= 0 && errno != EINTR) {
                return;
            }
            bytes.remove_prefix(count > 0 ? static_cast<std::size_t>(count) : 0);
        }
    }

    void unplug() override {
        remove_symlink();
        pty_.controller.close();
        pty_.keeper.close();
    }

    std::string address() const override {
        return symlink_path_.empty() ? pty_.port_path : symlink_path_;
    }

private:
    void remove_symlink() const {
        std::error_code none;
        if (!symlink_path_.empty() && fs::read_symlink(symlink_path_, none) == pty_.port_path) {
            fs::remove(symlink_path_, none);
        }
    }

    Pty pty_;
    std::string symlink_path_;
};

}  // namespace

std::unique_ptr<SimLink> open_pty_link(const std::string& symlink_path) {
    return std::make_unique<PtyLink>(symlink_path);
}

}  // namespace leafcutter::drivers
