#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "server/http/multipart.h"
#include "server/http/problem.h"

namespace leafcutter::server {
namespace {

constexpr const char* kType = "multipart/form-data; boundary=xyz";

// A body that comes in pieces of `step` bytes.
RequestBody body_of(const std::string& text, std::size_t step) {
    RequestBody body;
    body.bytes = static_cast<std::int64_t>(text.size());
    body.read = [text, step, at = std::size_t{0}](std::span<char> room) mutable {
        const std::size_t size = std::min({step, room.size(), text.size() - at});
        std::memcpy(room.data(), text.data() + at, size);
        at += size;
        return size;
    };
    return body;
}

std::map<std::string, std::string> parts_of(const std::string& text, std::size_t step) {
    const RequestBody body = body_of(text, step);
    MultipartReader reader(kType, body);
    std::map<std::string, std::string> parts;
    while (const auto part = reader.next()) {
        parts[part->name + "/" + part->file_name] = reader.read_all(1000);
    }
    return parts;
}

const std::string kForm =
    "--xyz\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"a\\\"b%22.obj\"\r\n"
    "Content-Type: application/octet-stream\r\n\r\nv 1\r\n--xy\r\n-\r\n--xyz\r\n"
    "Content-Disposition: form-data; name=\"empty\"\r\n\r\n\r\n--xyz--\r\n";

TEST(Multipart, JoinsPartsAtAnySplit) {
    for (std::size_t step = 1; step <= kForm.size(); ++step) {
        const auto parts = parts_of(kForm, step);
        ASSERT_EQ(parts.size(), 2U) << step;
        EXPECT_EQ(parts.at("mesh/a\"b\".obj"), "v 1\r\n--xy\r\n-") << step;
        EXPECT_EQ(parts.at("empty/"), "") << step;
    }
}

TEST(Multipart, RefusesEveryTruncation) {
    const std::size_t end = kForm.rfind("--");
    for (std::size_t size = 0; size < end + 2; ++size) {
        EXPECT_THROW(parts_of(kForm.substr(0, size), 7), HttpProblem) << size;
    }
}

TEST(Multipart, RefusesAPartWithoutName) {
    EXPECT_THROW(parts_of("--xyz\r\nContent-Type: text/plain\r\n\r\nx\r\n--xyz--", 100),
                 HttpProblem);
}

TEST(Multipart, RefusesAnEndlessPartHead) {
    EXPECT_THROW(parts_of("--xyz\r\nX: " + std::string(100000, 'a'), 1000), HttpProblem);
}

TEST(Multipart, RefusesAFieldBeyondItsLimit) {
    const std::string body = "--xyz\r\nContent-Disposition: form-data; name=\"n\"\r\n\r\n" +
                             std::string(2000, 'a') + "\r\n--xyz--\r\n";
    EXPECT_THROW(parts_of(body, 100), HttpProblem);
}

}  // namespace
}  // namespace leafcutter::server
