// Wavefront OBJ: `v` and `f` statements; everything else (names, normals, texture, lines,
// materials) is passed over, and no other file is ever opened. Indices count from 1, negative ones
// back from the latest vertex. A backslash at the end of a line carries the statement on.

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "geometry/io/read_mesh.h"
#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

namespace {

class ObjReader {
public:
    ObjReader(std::span<const std::byte> bytes, const ReadLimits& limits)
        : limits_(limits), lines_(as_text(bytes), limits.max_line_bytes) {}

    PolygonSoup read();

private:
    bool next_statement(std::string_view& statement);
    void read_face(std::string_view words);
    std::uint32_t read_corner(std::string_view word);

    const ReadLimits& limits_;
    LineScanner lines_;
    std::string joined_;  // The statement at hand, if it spans several lines.
    PolygonSoup soup_;
    std::size_t triangles_ = 0;
    std::uint32_t largest_index_ = 0;
    std::size_t largest_index_line_ = 0;
};

bool continues(std::string_view line) {
    return !line.empty() && line.back() == '\\';
}

bool ObjReader::next_statement(std::string_view& statement) {
    if (!lines_.next()) {
        return false;
    }
    statement = lines_.line();
    if (!continues(statement)) {
        return true;
    }
    joined_.clear();
    while (continues(statement)) {
        joined_.append(statement.substr(0, statement.size() - 1)).push_back(' ');
        statement = lines_.next() ? lines_.line() : std::string_view();
        if (joined_.size() + statement.size() > limits_.max_line_bytes) {
            throw bad_line("line-too-long", lines_.number(), "the continued line is too long");
        }
    }
    joined_.append(statement);
    statement = joined_;
    return true;
}

std::uint32_t ObjReader::read_corner(std::string_view word) {
    const auto index = parse_integer(word.substr(0, word.find('/')));
    if (!index) {
        throw bad_line("bad-index", lines_.number(),
                       fmt::format("{} is no vertex index", quoted(word)));
    }
    const auto count = static_cast<std::int64_t>(soup_.positions.size());
    const std::int64_t vertex = *index < 0 ? count + *index : *index - 1;
    if (vertex < 0 || vertex >= std::numeric_limits<std::uint32_t>::max()) {
        throw bad_line("index-out-of-range", lines_.number(),
                       *index == 0
                           ? "index out of range: 0 doesn't exist, OBJ counts vertices from 1"
                           : fmt::format("index out of range: {}", *index));
    }
    return static_cast<std::uint32_t>(vertex);
}

void ObjReader::read_face(std::string_view words) {
    const std::size_t first = soup_.corners.size();
    for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
        if (word.front() == '#') {
            break;
        }
        const std::uint32_t vertex = read_corner(word);
        soup_.corners.push_back(vertex);
        if (vertex >= largest_index_) {
            largest_index_line_ = vertex > largest_index_ || largest_index_line_ == 0
                                      ? lines_.number()
                                      : largest_index_line_;
            largest_index_ = vertex;
        }
    }
    const std::size_t corners = soup_.corners.size() - first;
    if (corners < 3) {
        throw bad_line("bad-face", lines_.number(),
                       fmt::format("a face needs at least 3 corners, this one has {}; the file may "
                                   "have been cut off",
                                   corners));
    }
    triangles_ += corners - 2;
    if (triangles_ > limits_.max_triangles) {
        throw bad_line("too-large", lines_.number(),
                       fmt::format("more than {} triangles", limits_.max_triangles));
    }
    soup_.face_offsets.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
}

PolygonSoup ObjReader::read() {
    soup_.face_offsets.push_back(0);
    std::string_view statement;
    while (next_statement(statement)) {
        const std::string_view keyword = take_word(statement);
        if (keyword == "v") {
            soup_.positions.push_back(take_position(statement, lines_.number()));
        } else if (keyword == "f") {
            read_face(statement);
        }
    }
    // Checked at the end, for a face may come before its vertices.
    if (!soup_.corners.empty() && largest_index_ >= soup_.positions.size()) {
        throw bad_line("index-out-of-range", largest_index_line_,
                       fmt::format("index out of range: the face names vertex {}, the file has {}",
                                   largest_index_ + 1ULL, soup_.positions.size()));
    }
    return std::move(soup_);
}

}  // namespace

PolygonSoup read_obj(std::span<const std::byte> bytes, const ReadLimits& limits) {
    return ObjReader(bytes, limits).read();
}

}  // namespace leafcutter::geometry
