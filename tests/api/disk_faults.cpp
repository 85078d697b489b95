// Loaded before the C library, makes a disk fail: LEAFCUTTER_FAULT="sync:7:EIO" fails the seventh
// sync, and every later one, of files whose path has LEAFCUTTER_FAULT_PATH in it; "write:7:ENOSPC"
// likewise writes. With a '!' behind it the fault passes after that one call.

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <unistd.h>

namespace {

struct Fault {
    std::string kind;
    int at = 0;
    int error = 0;
    bool passes = false;
    std::string path;
};

std::string text_of(const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? "" : text;
}

Fault wanted_fault() {
    Fault fault;
    std::string text = text_of("LEAFCUTTER_FAULT");
    fault.path = text_of("LEAFCUTTER_FAULT_PATH");
    const std::size_t first = text.find(':');
    const std::size_t second = text.rfind(':');
    if (first == std::string::npos || first == second) {
        return fault;
    }
    fault.passes = text.back() == '!';
    fault.kind = text.substr(0, first);
    std::from_chars(text.data() + first + 1, text.data() + second, fault.at);
    fault.error = text.find("ENOSPC") != std::string::npos ? ENOSPC : EIO;
    return fault;
}

bool is_meant(int fd, const std::string& part) {
    std::array<char, 512> link{};
    std::array<char, 64> name{};
    std::snprintf(name.data(), name.size(), "/proc/self/fd/%d", fd);
    const ssize_t size = ::readlink(name.data(), link.data(), link.size());
    return size > 0 && std::string_view(link.data(), static_cast<std::size_t>(size)).find(part) !=
                           std::string_view::npos;
}

bool fails(std::string_view kind, int fd) {
    static const Fault fault = wanted_fault();
    static std::atomic<int> calls{0};
    if (fault.kind != kind || !is_meant(fd, fault.path)) {
        return false;
    }
    const int call = ++calls;
    if (call < fault.at || (fault.passes && call > fault.at)) {
        return false;
    }
    errno = fault.error;
    return true;
}

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int fsync(int fd) {
    static const auto real = next<int (*)(int)>("fsync");
    return fails("sync", fd) ? -1 : real(fd);
}

int fdatasync(int fd) {
    static const auto real = next<int (*)(int)>("fdatasync");
    return fails("sync", fd) ? -1 : real(fd);
}

ssize_t write(int fd, const void* bytes, size_t size) {
    static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
    return fails("write", fd) ? -1 : real(fd, bytes, size);
}

ssize_t pwrite(int fd, const void* bytes, size_t size, off_t offset) {
    static const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
    return fails("write", fd) ? -1 : real(fd, bytes, size, offset);
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t offset) {
    static const auto real = next<ssize_t (*)(int, const void*, size_t, off64_t)>("pwrite64");
    return fails("write", fd) ? -1 : real(fd, bytes, size, offset);
}
}
