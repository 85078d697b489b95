#include "drivers/port_discovery.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/file_descriptor.h"

namespace leafcutter::drivers {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLihuiyuBoard = "1a86:5512";

std::string read_line(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

std::vector<fs::path> entries(const fs::path& directory) {
    std::error_code none;
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(directory, none)) {
        found.push_back(entry.path());
    }
    std::sort(found.begin(), found.end());
    return found;
}

// The nearest directory above that describes a USB device.
std::optional<fs::path> usb_device_above(fs::path place) {
    std::error_code none;
    while (place.has_relative_path() && place != place.parent_path()) {
        if (fs::exists(place / "idVendor", none)) {
            return place;
        }
        place = place.parent_path();
    }
    return std::nullopt;
}

void describe(const fs::path& usb, FoundPort& port) {
    port.usb_id = read_line(usb / "idVendor") + ":" + read_line(usb / "idProduct");
    const std::string maker = read_line(usb / "manufacturer");
    const std::string product = read_line(usb / "product");
    port.description = maker + (maker.empty() || product.empty() ? "" : " ") + product;
    port.serial_number = read_line(usb / "serial");
}

std::string stable_name(const fs::path& dev, const fs::path& port) {
    std::error_code none;
    for (const fs::path& link : entries(dev / "serial" / "by-id")) {
        if (fs::weakly_canonical(link, none) == fs::weakly_canonical(port, none)) {
            return link.string();
        }
    }
    return {};
}

// Built-in ports that the kernel lists without a chip behind them have type 0.
bool is_real_port(const fs::path& sys_entry) {
    std::error_code none;
    if (!fs::exists(sys_entry / "device", none)) {
        return false;
    }
    const std::string type = read_line(sys_entry / "type");
    return type.empty() || type != "0";
}

std::string group_of(const std::string& path) {
    struct stat info {};
    std::array<char, 1024> buffer{};
    group entry{};
    group* found = nullptr;
    if (stat(path.c_str(), &info) != 0 ||
        getgrgid_r(info.st_gid, &entry, buffer.data(), buffer.size(), &found) != 0 ||
        found == nullptr) {
        return "dialout";
    }
    return found->gr_name;
}

std::string access_trouble(const std::string& path) {
    if (access(path.c_str(), R_OK | W_OK) == 0) {
        return {};
    }
    return diagnose_open_failure(path, errno);
}

std::string held_trouble(const std::string& path, const std::string& proc) {
    const std::vector<std::string> holders = holders_of(path, proc);
    return holders.empty()
               ? std::string{}
               : fmt::format("{} has it open; close that one first", fmt::join(holders, " and "));
}

// A name in /proc that is a number is a process.
bool is_process(const fs::path& entry) {
    const std::string name = entry.filename().string();
    return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

// A CH341 adapter on the bus whose serial port is missing: brltty takes these for braille displays.
bool lost_its_port(const fs::path& usb) {
    for (const fs::path& part : entries(usb)) {
        for (const fs::path& inner : entries(part)) {
            if (inner.filename().string().substr(0, 3) == "tty") {
                return false;
            }
        }
    }
    return true;
}

std::optional<FoundPort> usb_without_port(const fs::path& usb) {
    FoundPort port;
    describe(usb, port);
    port.path = "usb:" + usb.filename().string();
    if (port.usb_id == kLihuiyuBoard) {
        port.uri = "lihuiyu:usb?bus=" + read_line(usb / "busnum") +
                   "&address=" + read_line(usb / "devnum");
        return port;
    }
    if ((port.usb_id == "1a86:7523" || port.usb_id == "10c4:ea60") && lost_its_port(usb)) {
        port.trouble =
            "the adapter is plugged in but has no serial port: brltty may have taken it; remove "
            "the "
            "package brltty or its udev rule, then plug it in again";
        return port;
    }
    return std::nullopt;
}

}  // namespace

std::vector<FoundPort> find_ports(const DiscoveryRoots& roots) {
    std::vector<FoundPort> found;
    std::error_code none;
    for (const fs::path& entry : entries(fs::path(roots.sys) / "class" / "tty")) {
        if (!is_real_port(entry)) {
            continue;
        }
        FoundPort port;
        const fs::path device = fs::path(roots.dev) / entry.filename();
        port.path = device.string();
        port.uri = "grbl:" + port.path;
        port.stable_path = stable_name(roots.dev, device);
        if (const auto usb = usb_device_above(fs::weakly_canonical(entry / "device", none))) {
            describe(*usb, port);
        }
        port.trouble = access_trouble(port.path);
        if (port.trouble.empty()) {
            port.trouble = held_trouble(port.path, roots.proc);
        }
        found.push_back(port);
    }
    for (const fs::path& entry : entries(fs::path(roots.sys) / "bus" / "usb" / "devices")) {
        if (!fs::exists(entry / "idVendor", none)) {
            continue;
        }
        if (auto port = usb_without_port(fs::weakly_canonical(entry, none))) {
            found.push_back(*std::move(port));
        }
    }
    return found;
}

std::vector<std::string> holders_of(const std::string& path, const std::string& proc) {
    std::error_code none;
    const fs::path wanted = fs::weakly_canonical(path, none);
    const std::string own = std::to_string(getpid());
    std::vector<std::string> holders;
    for (const fs::path& process : entries(proc)) {
        const std::string number = process.filename().string();
        if (!is_process(process) || number == own) {
            continue;
        }
        for (const fs::path& open_file : entries(process / "fd")) {
            if (fs::read_symlink(open_file, none) == wanted) {
                holders.push_back(
                    fmt::format("{} (process {})", read_line(process / "comm"), number));
                break;
            }
        }
    }
    return holders;
}

std::string diagnose_open_failure(const std::string& path, int error_number) {
    switch (error_number) {
        case EACCES:
            return "permission denied; add yourself to its group (`sudo usermod -aG " +
                   group_of(path) + " $USER`), then log in again";
        case EBUSY:
            if (const std::string held = held_trouble(path, "/proc"); !held.empty()) {
                return held;
            }
            return "another program has it open; close that one first";
        case ENOENT:
            return "there is no such port; plug the machine in and see `leafcutter devices`";
        default:
            return "can't be opened: " + error_text(error_number);
    }
}

}  // namespace leafcutter::drivers
