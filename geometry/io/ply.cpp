// PLY, text and both binary byte orders (Greg Turk, "The PLY Polygon File Format", 1994).
//
// ply_header.h reads the declarations; here the elements are walked in their order: "vertex" gives
// x y z, "face" its list vertex_indices (or vertex_index), everything else is passed over by its
// declared size. Triangle strips are refused.

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/io/ply_header.h"
#include "geometry/io/read_mesh.h"
#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

namespace {

// Values one after the other, whatever the encoding.
class TextValues {
public:
    explicit TextValues(LineScanner& lines) : lines_(lines) {}

    // Each element stands on a line of its own.
    void begin_element() {
        if (!lines_.next_content()) {
            throw bad_line("truncated", lines_.number(), "unexpected end of file");
        }
        rest_ = lines_.line();
    }
    double next(PlyType /*type*/) {
        const std::string_view word = take_word(rest_);
        const std::optional<double> value = parse_number(word);
        if (!value) {
            throw bad_line(word.empty() ? "truncated" : "bad-number", lines_.number(),
                           word.empty() ? "the line has fewer values than the header declares"
                                        : fmt::format("{} is no number", quoted(word)));
        }
        return *value;
    }
    bool at_end() { return !lines_.next_content(); }
    std::string where() const { return fmt::format("line {}", lines_.number()); }
    std::size_t values_left() const { return rest_.size() / 2 + 1; }

private:
    LineScanner& lines_;
    std::string_view rest_;
};

class BinaryValues {
public:
    BinaryValues(std::string_view bytes, std::size_t begin, PlyEncoding encoding)
        : bytes_(bytes), position_(begin), encoding_(encoding) {}

    void begin_element() {}
    double next(PlyType type) {
        const std::size_t size = ply_size(type);
        if (bytes_.size() - position_ < size) {
            throw Error(ErrorKind::BadFile, "truncated",
                        fmt::format("{}: unexpected end of file", where()));
        }
        const double value = ply_value(bytes_.substr(position_, size), type, encoding_);
        position_ += size;
        return value;
    }
    // Padding and a last line end are no data.
    bool at_end() const {
        return bytes_.find_first_not_of(std::string_view("\0 \t\r\n", 5), position_) ==
               std::string_view::npos;
    }
    std::string where() const { return fmt::format("byte {}", position_); }
    std::size_t values_left() const { return bytes_.size() - position_; }

private:
    std::string_view bytes_;
    std::size_t position_;
    PlyEncoding encoding_;
};

// Reads the elements from either kind of values.
template <typename Values>
class PlyBody {
public:
    PlyBody(const PlyHeader& header, Values values, const ReadLimits& limits)
        : header_(header),
          vertex_count_(header.vertex_count()),
          values_(std::move(values)),
          limits_(limits) {}

    PolygonSoup read();

private:
    Error bad_value(std::string code, const std::string& message) const {
        return {ErrorKind::BadFile, std::move(code), values_.where() + ": " + message};
    }
    std::size_t next_count(const PlyProperty& property);
    void skip(const PlyProperty& property);
    void read_vertex(const PlyElement& element);
    void read_face(const PlyElement& element);
    void read_corners(const PlyProperty& property);
    void read_element(const PlyElement& element);

    const PlyHeader& header_;
    std::size_t vertex_count_;
    Values values_;
    const ReadLimits& limits_;
    PolygonSoup soup_;
    std::size_t triangles_ = 0;
};

template <typename Values>
std::size_t PlyBody<Values>::next_count(const PlyProperty& property) {
    const double count = values_.next(*property.count_type);
    if (!(count >= 0.0) || count != std::floor(count) ||
        count > static_cast<double>(values_.values_left())) {
        throw bad_value("truncated",
                        fmt::format("a list claims {} entries, more than the file holds", count));
    }
    return static_cast<std::size_t>(count);
}

template <typename Values>
void PlyBody<Values>::skip(const PlyProperty& property) {
    const std::size_t count = property.count_type ? next_count(property) : 1;
    for (std::size_t i = 0; i < count; ++i) {
        values_.next(property.type);
    }
}

template <typename Values>
void PlyBody<Values>::read_vertex(const PlyElement& element) {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (const PlyProperty& property : element.properties) {
        const std::size_t axis =
            property.name.size() == 1 ? std::string_view("xyz").find(property.name[0]) : 3;
        if (axis >= 3) {
            skip(property);
            continue;
        }
        const double value = values_.next(property.type);
        if (!std::isfinite(value)) {
            throw bad_value("non-finite",
                            fmt::format("non-finite coordinate {} of vertex {} (counted from 0)",
                                        property.name, soup_.positions.size()));
        }
        position[static_cast<Eigen::Index>(axis)] = value;
    }
    soup_.positions.push_back(position);
}

template <typename Values>
void PlyBody<Values>::read_corners(const PlyProperty& property) {
    const std::size_t count = next_count(property);
    if (count < 3) {
        throw bad_value("bad-face", fmt::format("face {} has {} corners, a face needs at least 3",
                                                soup_.face_count(), count));
    }
    triangles_ += count - 2;
    if (triangles_ > limits_.max_triangles) {
        throw bad_value("too-large", fmt::format("more than {} triangles", limits_.max_triangles));
    }
    for (std::size_t corner = 0; corner < count; ++corner) {
        const double index = values_.next(property.type);
        const auto vertices = static_cast<double>(vertex_count_);
        if (!(index >= 0.0) || index >= vertices || index != std::floor(index)) {
            throw bad_value("index-out-of-range",
                            fmt::format("index out of range: {} in face {}, the {} vertices count "
                                        "from 0",
                                        index, soup_.face_count(), vertex_count_));
        }
        soup_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    soup_.face_offsets.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
}

template <typename Values>
void PlyBody<Values>::read_face(const PlyElement& element) {
    for (const PlyProperty& property : element.properties) {
        if (property.is_corner_list()) {
            read_corners(property);
        } else {
            skip(property);
        }
    }
}

template <typename Values>
void PlyBody<Values>::read_element(const PlyElement& element) {
    values_.begin_element();
    if (element.name == "vertex") {
        read_vertex(element);
    } else if (element.name == "face") {
        read_face(element);
    } else {
        for (const PlyProperty& property : element.properties) {
            skip(property);
        }
    }
}

template <typename Values>
PolygonSoup PlyBody<Values>::read() {
    soup_.positions.reserve(vertex_count_);
    soup_.face_offsets.push_back(0);
    for (const PlyElement& element : header_.elements) {
        for (std::size_t i = 0; i < element.count; ++i) {
            read_element(element);
        }
    }
    if (!values_.at_end()) {
        throw bad_value("bad-header",
                        "the file goes on after the elements of its header; the counts in the "
                        "header are wrong");
    }
    return std::move(soup_);
}

}  // namespace

PolygonSoup read_ply(std::span<const std::byte> bytes, const ReadLimits& limits) {
    LineScanner lines(as_text(bytes), limits.max_line_bytes);
    const PlyHeader header = read_ply_header(lines);
    if (header.encoding == PlyEncoding::Text) {
        return PlyBody<TextValues>(header, TextValues(lines), limits).read();
    }
    const std::string_view text = as_text(bytes);
    BinaryValues values(text, text.size() - lines.bytes_left(), header.encoding);
    return PlyBody<BinaryValues>(header, values, limits).read();
}

}  // namespace leafcutter::geometry
