// A blob that comes in several pieces, perhaps over several connections: a file in the folder
// partial of the blobs. What has come is there for whoever goes on; what nobody goes on with is
// swept after a day, see Blobs::sweep().

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "server/store/blobs.h"

namespace leafcutter::server {

class PartialBlob {
public:
    // How much of it is here, without taking it up; nullopt while a connection sends it.
    static std::optional<std::int64_t> bytes_here(const Blobs& blobs, const std::string& sha256);

    // Begins it, or takes it up. Throws BlobWriteFailed.
    PartialBlob(const Blobs& blobs, const std::string& sha256);

    // False: another connection has it just now. Nothing may be written then.
    bool is_ours() const { return ours_; }
    std::int64_t bytes() const { return bytes_; }

    // Whatever came behind is forgotten.
    void cut_to(std::int64_t bytes);

    // Behind what is there. Throws BlobWriteFailed.
    void write(std::span<const char> bytes);

    // It is whole: makes it a blob of its own name. False: the bytes have another one; they are
    // gone.
    bool finish();

private:
    const Blobs& blobs_;
    std::string sha256_;
    std::filesystem::path path_;
    FileHandle file_;
    bool ours_ = false;
    std::int64_t bytes_ = 0;
};

}  // namespace leafcutter::server
