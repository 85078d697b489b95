#include "drivers/burn/journal_file.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace leafcutter::drivers {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kSyncEvery{200};

[[noreturn]] void fail(const fs::path& path) {
    throw std::system_error(errno, std::generic_category(), path.string());
}

bool write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(file, text.data(), text.size());
        if (written < 0 && errno != EINTR) {
            return false;
        }
        text.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
    }
    return true;
}

void sync_folder(const fs::path& path) {
    const FileDescriptor folder(
        ::open(path.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder.is_open() || ::fsync(folder.get()) != 0) {
        fail(path);
    }
}

// On disk under its name when this returns.
FileDescriptor make_file(const fs::path& path, std::string_view text) {
    constexpr mode_t kMode = 0600;
    const fs::path beside = path.string() + ".new";
    FileDescriptor file(::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode));
    if (!file.is_open() || !write_all(file.get(), text) || ::fsync(file.get()) != 0 ||
        ::rename(beside.c_str(), path.c_str()) != 0) {
        fail(path);
    }
    sync_folder(path);
    return file;
}

}  // namespace

JournalFile::JournalFile(const fs::path& path, const JournalHeader& header)
    : file_(make_file(path, write_record(header))),
      thread_([this](const std::stop_token& stop) { loop(stop); }) {}

JournalFile::~JournalFile() {
    finish();
}

void JournalFile::finish() {
    thread_.request_stop();
    if (thread_.joinable()) {
        thread_.join();
    }
}

void JournalFile::note(const JournalRecord& record) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_ += write_record(record);
        if (record.kind == JournalRecord::Kind::May) {
            lines_waiting_ = std::max(lines_waiting_, record.lines);
        }
    }
    arrived_.notify_one();
}

void JournalFile::loop(const std::stop_token& stop) {
    std::chrono::steady_clock::time_point synced{};
    while (true) {
        std::string text;
        std::size_t lines = 0;
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, stop, [this] { return !waiting_.empty(); });
            text.swap(waiting_);
            lines = lines_waiting_;
        }
        if (text.empty()) {
            return;  // Stopped, and nothing is left.
        }
        if (failed_) {
            continue;
        }
        // A killed process loses nothing of what is written; only what lines wait for is hurried
        // to the disk itself.
        const auto now = std::chrono::steady_clock::now();
        const bool hurry = lines != lines_on_disk_ || now - synced >= kSyncEvery;
        failed_ = !write_all(file_.get(), text) || (hurry && ::fdatasync(file_.get()) != 0);
        if (hurry && !failed_) {
            ++syncs_;
            synced = now;
            lines_on_disk_ = lines;
        }
    }
}

void append_record(const fs::path& path, const JournalRecord& record) {
    std::optional<Journal> journal = load_journal(path);
    if (!journal) {
        errno = ENOENT;
        fail(path);
    }
    // Written anew: behind a record that a power cut tore, nothing would be read.
    std::string text = write_record(journal->header);
    journal->records.push_back(record);
    for (const JournalRecord& each : journal->records) {
        text += write_record(each);
    }
    make_file(path, text);
}

std::optional<Journal> load_journal(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        return std::nullopt;
    }
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return read_journal(text);
}

}  // namespace leafcutter::drivers
