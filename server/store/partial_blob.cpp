#include "server/store/partial_blob.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
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

fs::path path_of(const Blobs& blobs, const std::string& sha256) {
    return blobs.folder() / Blobs::kPartial / sha256;
}

// Of the open file, not of the process: two connections of one daemon exclude each other. And
// whether it is held can be asked without holding it, which flock() cannot.
struct flock whole_file(short type) {
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    return lock;
}

[[noreturn]] void fail(const fs::path& path) {
    throw BlobWriteFailed(
        fmt::format("cannot use {}: {}", path.string(), std::generic_category().message(errno)));
}

}  // namespace

std::optional<std::int64_t> PartialBlob::bytes_here(const Blobs& blobs, const std::string& sha256) {
    const fs::path path = path_of(blobs, sha256);
    const FileHandle file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.fd() < 0 && errno == ENOENT) {
        return 0;
    }
    struct flock lock = whole_file(F_RDLCK);
    struct stat found {};
    if (file.fd() < 0 || ::fcntl(file.fd(), F_OFD_GETLK, &lock) != 0 ||
        ::fstat(file.fd(), &found) != 0) {
        fail(path);
    }
    return lock.l_type == F_UNLCK ? std::optional<std::int64_t>(found.st_size) : std::nullopt;
}

PartialBlob::PartialBlob(const Blobs& blobs, const std::string& sha256)
    : blobs_(blobs), sha256_(sha256), path_(path_of(blobs, sha256)), file_(opened(path_)) {
    if (file_.fd() < 0) {
        fail(path_);
    }
    // Somebody may have made it whole between the two calls: then the name leads elsewhere.
    struct stat mine {};
    struct stat named {};
    struct flock lock = whole_file(F_WRLCK);
    ours_ = ::fcntl(file_.fd(), F_OFD_SETLK, &lock) == 0 && ::fstat(file_.fd(), &mine) == 0 &&
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
