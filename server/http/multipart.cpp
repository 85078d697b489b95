#include "server/http/multipart.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

HttpProblem malformed(const std::string& what) {
    return {400, "bad-multipart", fmt::format("the multipart body: {}", what)};
}

std::string boundary_in(std::string_view content_type) {
    constexpr std::string_view kKey = "boundary=";
    constexpr std::size_t kLongest = 70;  // RFC 2046, section 5.1.1.
    const std::size_t at = content_type.find(kKey);
    if (at == std::string_view::npos) {
        throw malformed("the content type names no boundary");
    }
    std::string_view value = content_type.substr(at + kKey.size());
    if (value.starts_with('"')) {
        value.remove_prefix(1);
        value = value.substr(0, value.find('"'));
    } else {
        value = value.substr(0, value.find(';'));
    }
    if (value.empty() || value.size() > kLongest) {
        throw malformed("the boundary must have 1 to 70 letters");
    }
    return std::string(value);
}

// The value of name="…" in a Content-Disposition; browsers write %22 for a quote inside.
std::optional<std::string> parameter(std::string_view line, std::string_view name) {
    const std::string key = fmt::format("; {}=\"", name);
    std::size_t at = line.find(key);
    if (at == std::string_view::npos) {
        return std::nullopt;
    }
    at += key.size();
    std::string value;
    for (; at < line.size() && line[at] != '"'; ++at) {
        if (line[at] == '\\' && at + 1 < line.size() && line[at + 1] == '"') {
            ++at;
        }
        value += line[at];
    }
    if (at == line.size()) {
        throw malformed("a quote is not closed");
    }
    for (std::size_t quote = 0; (quote = value.find("%22", quote)) != std::string::npos; ++quote) {
        value.erase(quote, 2);
        value[quote] = '"';
    }
    return value;
}

bool names_header(std::string_view line, std::string_view lower_name) {
    return line.size() > lower_name.size() && line[lower_name.size()] == ':' &&
           std::equal(lower_name.begin(), lower_name.end(), line.begin(), [](char wanted, char c) {
               return wanted == (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
           });
}

}  // namespace

MultipartReader::MultipartReader(std::string_view content_type, const RequestBody& body)
    : body_(body),
      delimiter_(fmt::format("\r\n--{}", boundary_in(content_type))),
      buffer_("\r\n") {}

bool MultipartReader::fill() {
    std::array<char, 16384> piece;
    const std::size_t size = body_.read(piece);
    buffer_.append(piece.data(), size);
    return size > 0;
}

void MultipartReader::need(std::size_t bytes) {
    while (buffer_.size() < bytes) {
        if (!fill()) {
            throw malformed("it ends too early");
        }
    }
}

std::optional<PartHead> MultipartReader::next() {
    std::array<char, 16384> skipped;
    while (read(skipped) > 0) {
    }
    buffer_.erase(0, delimiter_.size());
    need(2);
    if (buffer_.starts_with("--")) {
        return std::nullopt;
    }
    const std::string head = take_head();
    std::optional<PartHead> part;
    for (std::size_t at = 2; at < head.size();) {
        const std::size_t end = std::min(head.find("\r\n", at), head.size());
        const std::string_view line = std::string_view(head).substr(at, end - at);
        at = end + 2;
        if (names_header(line, "content-disposition")) {
            part = PartHead{parameter(line, "name").value_or(""),
                            parameter(line, "filename").value_or("")};
        } else if (names_header(line, "content-transfer-encoding") || line.find(':') == line.npos) {
            throw malformed("a part has a header that is not taken");
        }
    }
    if (!part || part->name.empty()) {
        throw malformed("a part has no name");
    }
    return part;
}

// From the line end after the delimiter to the empty line, both line ends of which are taken.
std::string MultipartReader::take_head() {
    constexpr std::size_t kMostHeadBytes = 4096;
    std::size_t end = std::string::npos;
    while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
        if (buffer_.size() > kMostHeadBytes || !fill()) {
            throw malformed("the head of a part is too large or cut off");
        }
    }
    if (!buffer_.starts_with("\r\n") || end > kMostHeadBytes) {
        throw malformed("a boundary is followed by something else than a line end");
    }
    std::string head = buffer_.substr(0, end);
    buffer_.erase(0, end + 4);
    return head;
}

std::size_t MultipartReader::read(std::span<char> room) {
    while (true) {
        const std::size_t found = buffer_.find(delimiter_);
        const std::size_t safe = found != std::string::npos ? found
                                 : buffer_.size() >= delimiter_.size()
                                     ? buffer_.size() - delimiter_.size() + 1
                                     : 0;
        const std::size_t size = std::min(safe, room.size());
        if (size > 0) {
            std::memcpy(room.data(), buffer_.data(), size);
            buffer_.erase(0, size);
            return size;
        }
        if (found == 0) {
            return 0;
        }
        if (!fill()) {
            throw malformed("it ends without its closing boundary");
        }
    }
}

std::string MultipartReader::read_all(std::size_t most) {
    std::string all;
    std::array<char, 4096> piece;
    while (const std::size_t size = read(piece)) {
        all.append(piece.data(), size);
        if (all.size() > most) {
            throw HttpProblem(413, "too-large",
                              fmt::format("a field may have {} bytes at most", most));
        }
    }
    return all;
}

}  // namespace leafcutter::server
