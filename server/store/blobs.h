// Files named by the SHA-256 of their bytes: blobs/ab/abcdef…. What is there is complete and on
// disk: written beside, synced, renamed, folder synced. Safe from any thread.

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace leafcutter::server {

struct BlobId {
    std::string sha256;  // 64 lower-case hex digits.
    std::int64_t bytes = 0;
};

bool is_sha256(std::string_view text);

// Lower-case hex.
std::string sha256_of(std::string_view bytes);

// The disk is full or fails; the message has the system's reason.
class BlobWriteFailed : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// An open file, closed with its owner.
class FileHandle {
public:
    explicit FileHandle(int fd) : fd_(fd) {}
    ~FileHandle();
    FileHandle(FileHandle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    FileHandle& operator=(FileHandle&&) = delete;

    int fd() const { return fd_; }

private:
    int fd_;
};

// A blob on its way in. Its temporary file vanishes unless finish() is reached.
class BlobWriter {
public:
    BlobWriter(std::filesystem::path folder, std::filesystem::path temporary);
    ~BlobWriter();
    BlobWriter(const BlobWriter&) = delete;
    BlobWriter& operator=(const BlobWriter&) = delete;

    // Throws BlobWriteFailed.
    void write(std::span<const char> bytes);

    // The digest of what was written so far; no more may be written after it.
    const BlobId& digest();

    // Makes it durable under its name. Throws BlobWriteFailed.
    BlobId finish();

private:
    struct Digest;

    std::filesystem::path folder_;
    std::filesystem::path temporary_;
    int fd_ = -1;
    std::unique_ptr<Digest> digest_;
    BlobId id_;
};

// The bytes of a blob, mapped for reading as long as it lives.
class MappedBlob {
public:
    MappedBlob(const FileHandle& file, std::size_t size);
    ~MappedBlob();
    MappedBlob(const MappedBlob&) = delete;
    MappedBlob& operator=(const MappedBlob&) = delete;

    std::span<const std::byte> bytes() const { return {data_, size_}; }

private:
    const std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

class Blobs {
public:
    // Ways to other nodes that have blobs too; both may take seconds.
    struct Others {
        // Gets what is missing here and puts it in; false: nobody has it.
        std::function<bool(const std::string& sha256, const Blobs& here)> fetch;

        // Lets another one have it, as a copy beyond this host.
        std::function<void(const std::string& sha256, const Blobs& here)> share;
    };

    // Creates the folder and sweeps temporary files that a dead process left behind.
    explicit Blobs(std::filesystem::path folder, Others others = {});

    // Below folder(): those of which only a part has come, under the name of the whole.
    static constexpr const char* kPartial = "partial";

    const std::filesystem::path& folder() const { return folder_; }

    std::unique_ptr<BlobWriter> begin() const;
    BlobId put(std::string_view bytes) const;

    // A file without a name, gone when it is closed. Throws BlobWriteFailed.
    FileHandle scratch() const;

    // Gives a copy to others, if there are any.
    void share(const std::string& sha256) const;

    // Whether it lies on this host.
    bool is_here(const std::string& sha256) const;

    // What is not here comes from others, if they have it. Nothing if there is none of that name.
    std::optional<std::int64_t> size(const std::string& sha256) const;

    // Throws std::out_of_range if there is none.
    FileHandle open(const std::string& sha256) const;
    std::unique_ptr<MappedBlob> map(const std::string& sha256) const;
    std::string read(const std::string& sha256) const;

    // Room for `bytes` more with a reserve for the database.
    bool has_room_for(std::int64_t bytes) const;

    // Removes blobs that `is_referenced` denies and that are older than a day: younger ones may be
    // uploads whose job is yet to come. Returns how many.
    std::size_t sweep(const std::function<bool(const std::string& sha256)>& is_referenced) const;

private:
    std::filesystem::path path_of(const std::string& sha256) const;
    std::optional<std::int64_t> size_here(const std::string& sha256) const;
    bool fetch(const std::string& sha256) const;

    std::filesystem::path folder_;
    Others others_;
};

}  // namespace leafcutter::server
