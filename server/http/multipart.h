// multipart/form-data (RFC 7578), read strictly and in pieces: part heads are small, part bodies
// are streamed and never held.

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/http/request.h"

namespace leafcutter::server {

struct PartHead {
    std::string name;
    std::string file_name;  // Empty if the part is no file.
};

class MultipartReader {
public:
    // Throws HttpProblem (400) if the content type has no proper boundary. `body` must outlive it.
    MultipartReader(std::string_view content_type, const RequestBody& body);

    // The next part, skipping what is left of this one; nothing after the last. Throws HttpProblem
    // for anything malformed.
    std::optional<PartHead> next();

    // Bytes of the current part; 0 at its end.
    std::size_t read(std::span<char> room);

    // All of the current part. Throws HttpProblem (413) if it is larger.
    std::string read_all(std::size_t most);

private:
    void need(std::size_t bytes);
    bool fill();
    std::string take_head();

    const RequestBody& body_;
    std::string delimiter_;
    std::string buffer_;
};

}  // namespace leafcutter::server
