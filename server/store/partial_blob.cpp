#include "server/store/partial_blob.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

int opened(const fs::path& path) {
    std::error_code error;
    fs::create_directory(path.parent_path(), error);
    return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
}

[[noreturn]] void fail(const fs::path& path) {
    throw BlobWriteFailed(
        fmt::format("cannot write {}: {}", path.string(), std::generic_category().message(errno)));
}

}  // namespace

PartialBlob::PartialBlob(const Blobs& blobs, const std::string& sha256)
    : blobs_(blobs),
      sha256_(sha256),
      path_(blobs.folder() / Blobs::kPartial / sha256),
      file_(opened(path_)) {
    if (file_.fd() < 0) {
        fail(path_);
    }
    // Somebody may have made it whole between the two calls: then the name leads elsewhere.
    struct stat mine {};
    struct stat named {};
    ours_ = ::flock(file_.fd(), LOCK_EX | LOCK_NB) == 0 && ::fstat(file_.fd(), &mine) == 0 &&
            ::stat(path_.c_str(), &named) == 0 && mine.st_ino == named.st_ino;
    bytes_ = mine.st_size;
}

void PartialBlob::cut_to(std::int64_t bytes) {
    if (::ftruncate(file_.fd(), bytes) != 0) {
        fail(path_);
    }
    bytes_ = bytes;
}

void PartialBlob::write(std::span<const char> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(file_.fd(), bytes.data(), bytes.size(), bytes_);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            fail(path_);
        }
        bytes_ += written;
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

bool PartialBlob::finish() {
    const std::unique_ptr<BlobWriter> writer = blobs_.begin();
    std::array<char, 65536> piece;
    ssize_t got = 0;
    for (std::int64_t at = 0; (got = ::pread(file_.fd(), piece.data(), piece.size(), at)) > 0;) {
        writer->write({piece.data(), static_cast<std::size_t>(got)});
        at += got;
    }
    const bool right = got == 0 && writer->digest().sha256 == sha256_;
    if (right) {
        writer->finish();
    }
    ::unlink(path_.c_str());
    return right;
}

}  // namespace leafcutter::server
