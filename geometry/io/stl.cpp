// STL. Binary: 80 bytes of header, a little-endian uint32 count, then 50 bytes a triangle: normal
// and three corners as float32, two bytes of attributes. Text: "facet" blocks between "solid" and
// "endsolid". Normals are passed over; the order of the corners says which side is out.
//
// A header may begin with "solid" in a binary file, too: the size decides.

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "geometry/io/read_mesh.h"
#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

namespace {

static_assert(std::endian::native == std::endian::little,
              "binary STL is read as it lies in memory");

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::size_t kNormalBytes = 12;

std::uint32_t triangle_count(std::span<const std::byte> bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kHeaderBytes - sizeof count, sizeof count);
    return count;
}

// In 64 bits, for 50 times a hostile count overflows 32.
std::uint64_t binary_size(std::uint32_t count) {
    return kHeaderBytes + std::uint64_t{kTriangleBytes} * count;
}

bool begins_as_text(std::string_view text) {
    return lower_case(take_word(text).substr(0, 5)) == "solid";
}

bool is_text(std::span<const std::byte> bytes) {
    const std::string_view text = as_text(bytes);
    const std::size_t start = text.find_first_not_of(" \t\r\n");
    if (start == std::string_view::npos || !begins_as_text(text.substr(start, 16))) {
        return false;
    }
    const bool sized_as_binary =
        bytes.size() >= kHeaderBytes && binary_size(triangle_count(bytes)) == bytes.size();
    // Text holds no zero byte; a "solid" header of a cut-off binary file soon does.
    return !sized_as_binary && text.substr(0, 256).find('\0') == std::string_view::npos;
}

void append_triangle(const std::array<Eigen::Vector3d, 3>& corners, PolygonSoup& soup) {
    for (const Eigen::Vector3d& corner : corners) {
        soup.corners.push_back(static_cast<std::uint32_t>(soup.positions.size()));
        soup.positions.push_back(corner);
    }
    soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
}

Error bad_file(std::string code, const std::string& message) {
    return {ErrorKind::BadFile, std::move(code), message};
}

void check_binary(std::span<const std::byte> bytes, const ReadLimits& limits) {
    if (bytes.size() < kHeaderBytes) {
        throw bad_file("truncated",
                       fmt::format("truncated: a binary STL has at least 84 bytes, the file has {}",
                                   bytes.size()));
    }
    const std::uint32_t count = triangle_count(bytes);
    const std::size_t held = (bytes.size() - kHeaderBytes) / kTriangleBytes;
    if (binary_size(count) > bytes.size()) {
        throw bad_file("truncated",
                       fmt::format("truncated: the header (byte 80) claims {} triangles, the file "
                                   "holds {}",
                                   count, held));
    }
    for (const std::byte extra : bytes.subspan(binary_size(count))) {
        if (extra != std::byte{0}) {
            throw bad_file("bad-header",
                           fmt::format("the header (byte 80) claims {} triangles, the file has "
                                       "bytes for {}; one of them is wrong",
                                       count, held));
        }
    }
    if (count > limits.max_triangles) {
        throw bad_file("too-large", fmt::format("more than {} triangles", limits.max_triangles));
    }
}

PolygonSoup read_binary(std::span<const std::byte> bytes, const ReadLimits& limits) {
    check_binary(bytes, limits);
    const std::size_t count = triangle_count(bytes);
    PolygonSoup soup;
    soup.positions.reserve(3 * count);
    soup.corners.reserve(3 * count);
    soup.face_offsets.reserve(count + 1);
    soup.face_offsets.push_back(0);
    for (std::size_t face = 0; face < count; ++face) {
        const std::size_t offset = kHeaderBytes + face * kTriangleBytes + kNormalBytes;
        std::array<float, 9> numbers{};
        std::memcpy(numbers.data(), bytes.data() + offset, sizeof numbers);
        std::array<Eigen::Vector3d, 3> corners;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (!std::isfinite(numbers[i])) {
                throw bad_file("non-finite",
                               fmt::format("non-finite coordinate in triangle {} (counted from 0), "
                                           "byte {}",
                                           face, offset + i * sizeof(float)));
            }
            corners[i / 3][static_cast<Eigen::Index>(i % 3)] = static_cast<double>(numbers[i]);
        }
        append_triangle(corners, soup);
    }
    return soup;
}

class TextReader {
public:
    TextReader(std::span<const std::byte> bytes, const ReadLimits& limits)
        : limits_(limits), lines_(as_text(bytes), limits.max_line_bytes) {}

    PolygonSoup read();

private:
    std::string next_keyword();
    void expect(std::string_view keyword, std::string_view second = {});
    void read_solid();
    void read_facet();

    const ReadLimits& limits_;
    LineScanner lines_;
    std::string_view rest_;  // Of the line, behind its keyword.
    PolygonSoup soup_;
};

// The lower-case first word of the next line that has one; empty at the end of the file.
std::string TextReader::next_keyword() {
    while (lines_.next()) {
        rest_ = lines_.line();
        const std::string_view word = take_word(rest_);
        if (!word.empty()) {
            return lower_case(word.substr(0, 16));
        }
    }
    return {};
}

void TextReader::expect(std::string_view keyword, std::string_view second) {
    const std::string found = next_keyword();
    const bool matches =
        found == keyword && (second.empty() || lower_case(take_word(rest_)) == second);
    if (!matches) {
        throw bad_line(
            found.empty() ? "truncated" : "bad-statement", lines_.number(),
            found.empty()
                ? fmt::format("truncated: the file ends where \"{}\" is due", keyword)
                : fmt::format("expected \"{}\", found {}", keyword, quoted(lines_.line())));
    }
}

void TextReader::read_facet() {
    expect("outer", "loop");
    std::array<Eigen::Vector3d, 3> corners;
    for (Eigen::Vector3d& corner : corners) {
        expect("vertex");
        corner = take_position(rest_, lines_.number());
    }
    expect("endloop");
    expect("endfacet");
    append_triangle(corners, soup_);
    if (soup_.face_count() > limits_.max_triangles) {
        throw bad_line("too-large", lines_.number(),
                       fmt::format("more than {} triangles", limits_.max_triangles));
    }
}

void TextReader::read_solid() {
    for (;;) {
        const std::string keyword = next_keyword();
        if (keyword == "endsolid") {
            return;
        }
        if (keyword.empty()) {
            throw bad_line("truncated", lines_.number(),
                           "truncated: the file ends before \"endsolid\"");
        }
        if (keyword != "facet") {
            throw bad_line(
                "bad-statement", lines_.number(),
                fmt::format("expected \"facet\" or \"endsolid\", found {}", quoted(lines_.line())));
        }
        read_facet();
    }
}

PolygonSoup TextReader::read() {
    soup_.face_offsets.push_back(0);
    for (std::string keyword = next_keyword(); !keyword.empty(); keyword = next_keyword()) {
        if (!keyword.starts_with("solid")) {
            throw bad_line("bad-statement", lines_.number(),
                           fmt::format("expected \"solid\", found {}", quoted(lines_.line())));
        }
        read_solid();
    }
    return std::move(soup_);
}

}  // namespace

PolygonSoup read_stl(std::span<const std::byte> bytes, const ReadLimits& limits) {
    return is_text(bytes) ? TextReader(bytes, limits).read() : read_binary(bytes, limits);
}

}  // namespace leafcutter::geometry
