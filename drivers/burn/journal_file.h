// A journal on disk. What is noted is written and synced by a thread of its own, all that waits
// together: neither the stream nor a stop ever waits for the disk.

#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "drivers/burn/beam_follower.h"
#include "drivers/burn/journal.h"
#include "drivers/file_descriptor.h"

namespace leafcutter::drivers {

class JournalFile final : public JournalSink {
public:
    // Makes a new file, on disk with its name when this returns. Throws std::system_error.
    JournalFile(const std::filesystem::path& path, const JournalHeader& header);

    ~JournalFile() override;
    JournalFile(const JournalFile&) = delete;
    JournalFile& operator=(const JournalFile&) = delete;

    // From any thread; waits for nothing.
    void note(const JournalRecord& record) override;

    std::size_t lines_on_disk() const override { return lines_on_disk_.load(); }

    // When it returns, everything noted is on disk, or the disk failed. No more may be noted.
    void finish();

    // The disk takes nothing more.
    bool failed() const { return failed_.load(); }

    std::size_t syncs() const { return syncs_.load(); }

private:
    void loop(const std::stop_token& stop);

    FileDescriptor file_;
    std::atomic<std::size_t> lines_on_disk_{0};
    std::atomic<std::size_t> syncs_{0};
    std::atomic<bool> failed_{false};

    std::mutex mutex_;  // Guards the members below.
    std::condition_variable_any arrived_;
    std::string waiting_;
    std::size_t lines_waiting_ = 0;

    std::jthread thread_;  // Last: it uses everything above.
};

// Adds a record to a journal that nobody writes any more. Throws std::system_error.
void append_record(const std::filesystem::path& path, const JournalRecord& record);

// Nothing if there is none, or none that can be read.
std::optional<Journal> load_journal(const std::filesystem::path& path);

}  // namespace leafcutter::drivers
