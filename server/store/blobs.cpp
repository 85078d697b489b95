#include "server/store/blobs.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/store/durable_file.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const char* what, const fs::path& path) {
    throw BlobWriteFailed(
        fmt::format("{} {}: {}", what, path.string(), std::generic_category().message(errno)));
}

void sync_shelf(const fs::path& shelf) {
    try {
        sync_folder(shelf);
    } catch (const std::system_error& error) {
        throw BlobWriteFailed(error.what());
    }
}

std::string hex(std::span<const unsigned char> bytes) {
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace

std::string sha256_of(std::string_view bytes) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr);
    return hex({digest.data(), size});
}

bool is_sha256(std::string_view text) {
    return text.size() == 64 && std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

FileHandle::~FileHandle() {
    if (fd_ >= 0) {
        ::close(fd_);
    }
}

struct BlobWriter::Digest {
    EVP_MD_CTX* context = EVP_MD_CTX_new();

    Digest() { EVP_DigestInit_ex(context, EVP_sha256(), nullptr); }
    ~Digest() { EVP_MD_CTX_free(context); }
    Digest(const Digest&) = delete;
    Digest& operator=(const Digest&) = delete;
};

BlobWriter::BlobWriter(fs::path folder, fs::path temporary)
    : folder_(std::move(folder)),
      temporary_(std::move(temporary)),
      fd_(::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)),
      digest_(std::make_unique<Digest>()) {
    if (fd_ < 0) {
        fail("cannot create", temporary_);
    }
}

BlobWriter::~BlobWriter() {
    ::close(fd_);
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
    }
}

void BlobWriter::write(std::span<const char> bytes) {
    EVP_DigestUpdate(digest_->context, bytes.data(), bytes.size());
    id_.bytes += static_cast<std::int64_t>(bytes.size());
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            fail("cannot write", temporary_);
        }
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

const BlobId& BlobWriter::digest() {
    if (id_.sha256.empty()) {
        std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
        unsigned int size = 0;
        EVP_DigestFinal_ex(digest_->context, bytes.data(), &size);
        id_.sha256 = hex({bytes.data(), size});
    }
    return id_;
}

BlobId BlobWriter::finish() {
    digest();
    const fs::path shelf = folder_ / id_.sha256.substr(0, 2);
    const fs::path target = shelf / id_.sha256;
    std::error_code error;
    if (fs::create_directory(shelf, error)) {
        sync_shelf(folder_);
    }
    if (fs::exists(target, error)) {
        ::utimensat(AT_FDCWD, target.c_str(), nullptr, 0);  // Young again, so no sweep takes it.
        return id_;
    }
    if (::fsync(fd_) != 0) {
        fail("cannot sync", temporary_);
    }
    crash_point("blob.before-rename");
    if (::rename(temporary_.c_str(), target.c_str()) != 0) {
        fail("cannot rename to", target);
    }
    temporary_.clear();
    crash_point("blob.after-rename");
    sync_shelf(shelf);
    return id_;
}

MappedBlob::MappedBlob(const FileHandle& file, std::size_t size) : size_(size) {
    if (size == 0) {
        return;
    }
    void* mapped = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.fd(), 0);
    if (mapped == MAP_FAILED) {
        throw std::system_error(errno, std::generic_category(), "mmap of a blob");
    }
    data_ = static_cast<const std::byte*>(mapped);
}

MappedBlob::~MappedBlob() {
    if (data_ != nullptr) {
        ::munmap(const_cast<std::byte*>(data_), size_);
    }
}

Blobs::Blobs(fs::path folder, Others others)
    : folder_(std::move(folder)), others_(std::move(others)) {
    fs::create_directories(folder_ / "incoming");
    for (const auto& left_over : fs::directory_iterator(folder_ / "incoming")) {
        std::error_code error;
        fs::remove(left_over.path(), error);
    }
}

std::unique_ptr<BlobWriter> Blobs::begin() const {
    return std::make_unique<BlobWriter>(folder_, folder_ / "incoming" / new_id("blob_"));
}

BlobId Blobs::put(std::string_view bytes) const {
    const std::unique_ptr<BlobWriter> writer = begin();
    writer->write({bytes.data(), bytes.size()});
    return writer->finish();
}

FileHandle Blobs::scratch() const {
    const fs::path place = folder_ / "incoming";
    FileHandle handle(::open(place.c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600));
    if (handle.fd() < 0) {
        fail("cannot create a file in", place);
    }
    return handle;
}

fs::path Blobs::path_of(const std::string& sha256) const {
    if (!is_sha256(sha256)) {
        throw std::out_of_range("no blob has the name " + sha256);
    }
    return folder_ / sha256.substr(0, 2) / sha256;
}

bool Blobs::fetch(const std::string& sha256) const {
    return others_.fetch && others_.fetch(sha256, *this);
}

void Blobs::share(const std::string& sha256) const {
    if (others_.share) {
        others_.share(sha256, *this);
    }
}

bool Blobs::is_here(const std::string& sha256) const {
    return size_here(sha256).has_value();
}

std::optional<std::int64_t> Blobs::size(const std::string& sha256) const {
    const auto here = size_here(sha256);
    return here || !fetch(sha256) ? here : size_here(sha256);
}

std::optional<std::int64_t> Blobs::size_here(const std::string& sha256) const {
    struct stat found {};
    if (::stat(path_of(sha256).c_str(), &found) != 0) {
        return std::nullopt;
    }
    return found.st_size;
}

FileHandle Blobs::open(const std::string& sha256) const {
    FileHandle handle(::open(path_of(sha256).c_str(), O_RDONLY | O_CLOEXEC));
    if (handle.fd() >= 0) {
        return handle;
    }
    FileHandle fetched(fetch(sha256) ? ::open(path_of(sha256).c_str(), O_RDONLY | O_CLOEXEC) : -1);
    if (fetched.fd() < 0) {
        throw std::out_of_range("blob " + sha256 + " is missing");
    }
    return fetched;
}

std::unique_ptr<MappedBlob> Blobs::map(const std::string& sha256) const {
    const FileHandle file = open(sha256);
    struct stat found {};
    ::fstat(file.fd(), &found);
    return std::make_unique<MappedBlob>(file, static_cast<std::size_t>(found.st_size));
}

std::string Blobs::read(const std::string& sha256) const {
    const std::unique_ptr<MappedBlob> blob = map(sha256);
    const std::span<const std::byte> bytes = blob->bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool Blobs::has_room_for(std::int64_t bytes) const {
    struct statvfs disk {};
    if (::statvfs(folder_.c_str(), &disk) != 0) {
        return false;
    }
    const auto block = static_cast<std::int64_t>(disk.f_frsize);
    const std::int64_t free = static_cast<std::int64_t>(disk.f_bavail) * block;
    const std::int64_t all = static_cast<std::int64_t>(disk.f_blocks) * block;
    constexpr std::int64_t kLargestReserve = 512LL << 20;
    return free - bytes >= std::min(all / 10, kLargestReserve);
}

std::size_t Blobs::sweep(const std::function<bool(const std::string&)>& is_referenced) const {
    const auto yesterday = fs::file_time_type::clock::now() - std::chrono::hours(24);
    std::vector<fs::path> stale;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file() && is_sha256(name) && entry.last_write_time() < yesterday &&
            (entry.path().parent_path().filename() == kPartial || !is_referenced(name))) {
            stale.push_back(entry.path());
        }
    }
    for (const fs::path& path : stale) {
        std::error_code error;
        fs::remove(path, error);
    }
    return stale.size();
}

}  // namespace leafcutter::server
