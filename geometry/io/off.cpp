// Geomview OFF, text form, one vertex or face a line: [ST][C][N]OFF, then "vertices faces [edges]",
// then that many vertex lines (what follows x y z is normal, colour or texture and passed over) and
// face lines (corner count, indices from 0, then perhaps a colour). The keyword may be missing or
// stand on the line of the counts. Four- and n-dimensional and binary OFF are refused.

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "geometry/io/read_mesh.h"
#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

namespace {

struct OffCounts {
    std::size_t vertices = 0;
    std::size_t faces = 0;
};

class OffReader {
public:
    OffReader(std::span<const std::byte> bytes, const ReadLimits& limits)
        : limits_(limits), lines_(as_text(bytes), limits.max_line_bytes) {}

    PolygonSoup read();

private:
    OffCounts read_header();
    std::string_view read_keyword();
    OffCounts read_counts(std::string_view words);
    void check_counts(const OffCounts& counts) const;
    void read_face(std::string_view words);
    void next_line_of(std::string_view what, std::size_t done, std::size_t wanted);

    const ReadLimits& limits_;
    LineScanner lines_;
    PolygonSoup soup_;
    std::size_t triangles_ = 0;
};

// Reads the keyword and returns what follows it on its line.
std::string_view OffReader::read_keyword() {
    std::string_view line = lines_.line();
    std::string_view after = line;
    const std::string_view word = take_word(after);
    const std::size_t keyword_end = word.find("OFF");
    if (keyword_end == std::string_view::npos) {
        return line;  // No keyword: Geomview takes the counts alone, too.
    }
    const std::string_view prefix = word.substr(0, keyword_end);
    if (prefix.find('4') != prefix.npos || prefix.find('n') != prefix.npos) {
        throw bad_line("not-supported", lines_.number(), "only three-dimensional OFF is read");
    }
    if (prefix.find_first_not_of("STCN") != prefix.npos) {
        throw bad_line("bad-header", lines_.number(),
                       fmt::format("{} is no OFF keyword", quoted(word)));
    }
    std::string_view rest = after;
    if (lower_case(take_word(rest)).starts_with("binary")) {
        throw bad_line("not-supported", lines_.number(),
                       "binary OFF is not supported; save the mesh as text OFF or as PLY");
    }
    // "OFF8 6 12" is met in the wild: the counts begin right behind the keyword.
    const std::size_t glued = keyword_end + 3;
    return glued < word.size()
               ? line.substr(static_cast<std::size_t>(word.data() - line.data()) + glued)
               : after;
}

OffCounts OffReader::read_header() {
    if (!lines_.next_content()) {
        throw bad_line("empty-file", 1, "empty file: no OFF header");
    }
    std::string_view counts = read_keyword();
    std::string_view probe = counts;
    if (take_word(probe).empty()) {
        if (!lines_.next_content()) {
            throw bad_line("truncated", lines_.number(), "the file ends before the counts");
        }
        counts = lines_.line();
    }
    return read_counts(counts);
}

OffCounts OffReader::read_counts(std::string_view words) {
    const std::string_view first = take_word(words);
    const auto vertices = parse_integer(first);
    const auto faces = parse_integer(take_word(words));
    if (!vertices || !faces || *vertices < 0 || *faces < 0) {
        throw bad_line("bad-header", lines_.number(),
                       fmt::format("expected the numbers of vertices and faces, found {}",
                                   quoted(lines_.line())));
    }
    const OffCounts counts{static_cast<std::size_t>(*vertices), static_cast<std::size_t>(*faces)};
    check_counts(counts);
    return counts;
}

void OffReader::check_counts(const OffCounts& counts) const {
    // The shortest vertex is "0 0 0" and the shortest face "3 0 1 2", each with a line end but the
    // last.
    constexpr std::size_t kVertexBytes = 6;
    constexpr std::size_t kFaceBytes = 8;
    const std::size_t room = lines_.bytes_left() + 1;
    if (counts.vertices > room / kVertexBytes || counts.faces > room / kFaceBytes) {
        throw bad_line("count-exceeds-file", lines_.number(),
                       fmt::format("the header claims {} vertices and {} faces, more than the "
                                   "{} bytes left can hold",
                                   counts.vertices, counts.faces, lines_.bytes_left()));
    }
    if (counts.faces > limits_.max_triangles) {
        throw bad_line("too-large", lines_.number(),
                       fmt::format("more than {} triangles", limits_.max_triangles));
    }
}

void OffReader::next_line_of(std::string_view what, std::size_t done, std::size_t wanted) {
    if (!lines_.next_content()) {
        throw bad_line("truncated", lines_.number(),
                       fmt::format("the file ends after {} of {} {}", done, wanted, what));
    }
}

void OffReader::read_face(std::string_view words) {
    const std::string_view first = take_word(words);
    const auto corners = parse_integer(first);
    if (!corners || *corners < 3) {
        throw bad_line("bad-face", lines_.number(),
                       fmt::format("a face begins with its number of corners, at least 3; found {}",
                                   quoted(first)));
    }
    for (std::int64_t corner = 0; corner < *corners; ++corner) {
        const std::string_view word = take_word(words);
        const auto index = parse_integer(word);
        if (!index) {
            throw bad_line("bad-index", lines_.number(),
                           word.empty()
                               ? fmt::format("the face has {} of its {} corners", corner, *corners)
                               : fmt::format("{} is no vertex index", quoted(word)));
        }
        if (*index < 0 || static_cast<std::uint64_t>(*index) >= soup_.positions.size()) {
            throw bad_line("index-out-of-range", lines_.number(),
                           fmt::format("index out of range: {}, the {} vertices count from 0",
                                       *index, soup_.positions.size()));
        }
        soup_.corners.push_back(static_cast<std::uint32_t>(*index));
    }
    triangles_ += static_cast<std::size_t>(*corners) - 2;
    if (triangles_ > limits_.max_triangles) {
        throw bad_line("too-large", lines_.number(),
                       fmt::format("more than {} triangles", limits_.max_triangles));
    }
    soup_.face_offsets.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
}

PolygonSoup OffReader::read() {
    const OffCounts counts = read_header();
    soup_.positions.reserve(counts.vertices);
    soup_.face_offsets.reserve(counts.faces + 1);
    soup_.corners.reserve(3 * counts.faces);
    for (std::size_t vertex = 0; vertex < counts.vertices; ++vertex) {
        next_line_of("vertices", vertex, counts.vertices);
        std::string_view words = lines_.line();
        soup_.positions.push_back(take_position(words, lines_.number()));
    }
    soup_.face_offsets.push_back(0);
    for (std::size_t face = 0; face < counts.faces; ++face) {
        next_line_of("faces", face, counts.faces);
        read_face(lines_.line());
    }
    if (lines_.next_content()) {
        throw bad_line("bad-header", lines_.number(),
                       fmt::format("the file goes on after the {} faces of its header; the counts "
                                   "in the header are wrong",
                                   counts.faces));
    }
    return std::move(soup_);
}

}  // namespace

PolygonSoup read_off(std::span<const std::byte> bytes, const ReadLimits& limits) {
    return OffReader(bytes, limits).read();
}

}  // namespace leafcutter::geometry
