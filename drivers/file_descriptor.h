// An open file that closes itself, and reading and writing it as a link to a machine.

#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

namespace leafcutter::drivers {

class FileDescriptor {
public:
    FileDescriptor() = default;
    explicit FileDescriptor(int number) : number_(number) {}
    FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    FileDescriptor& operator=(FileDescriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    ~FileDescriptor() { close(); }

    int get() const { return number_; }
    bool is_open() const { return number_ >= 0; }
    void close();

private:
    int number_ = -1;
};

// The text of an errno value.
std::string error_text(int error_number);

// Of a non-blocking descriptor: waits up to `timeout` for bytes and returns those there are.
// Throws LinkLost, naming `link`, once the other end is gone.
std::string read_from(const FileDescriptor& file,
                      std::string_view link,
                      std::chrono::milliseconds timeout);

// Writes all bytes. Throws LinkLost when the other end is gone, or takes nothing for 5 s.
void write_to(const FileDescriptor& file, std::string_view link, std::string_view bytes);

}  // namespace leafcutter::drivers
