#include "fab/export/scissors.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "fab/export/number.h"
#include "fab/export/scissors_pages.h"
#include "fab/markup.h"
#include "fab/strips/labels.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr std::size_t kPagesInRow = 4;
constexpr double kPageGapMm = 10.0;

constexpr const char* kNamespaces =
    "xmlns=\"http://www.w3.org/2000/svg\" "
    "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
    "xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\"";

constexpr const char* kStyle =
    "<style>.cut{stroke:#000;stroke-width:.2}.fold{fill:none;stroke:#000;stroke-width:.2;"
    "stroke-dasharray:1.5 1}.tab{fill:#bbb;stroke:none}.mark{fill:none;stroke:#444;"
    "stroke-width:.15}text{font-family:sans-serif;font-size:3px;fill:#000}</style>\n";

// A quarter of the colour on white, so that lines and words on it can be read.
std::string light(std::string_view colour) {
    std::array<int, 3> rgb{136, 136, 136};
    if (colour.size() == 7 && colour.front() == '#') {
        for (std::size_t i = 0; i < 3; ++i) {
            const char* at = colour.data() + 1 + 2 * i;
            std::from_chars(at, at + 2, rgb[i], 16);
        }
    }
    for (int& part : rgb) {
        part = 255 - (255 - part) / 4;
    }
    return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

// The outline from one corner of a rung to the other, counter-clockwise: a tab.
Polyline part_between(const Ring& ring, const Vector2d& from, const Vector2d& to) {
    const auto nearest = [&](const Vector2d& point) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < ring.size(); ++i) {
            if ((ring[i] - point).squaredNorm() < (ring[best] - point).squaredNorm()) {
                best = i;
            }
        }
        return best;
    };
    const std::size_t last = nearest(to);
    Polyline part;
    for (std::size_t i = nearest(from); i != last; i = (i + 1) % ring.size()) {
        part.push_back(ring[i]);
    }
    part.push_back(ring[last]);
    return part;
}

class PageWriter {
public:
    PageWriter(const JobResult& job, std::size_t pages) : job_(job), pages_(pages) {}

    std::string write(const ScissorsPage& page, std::size_t number) {
        out_.clear();
        height_ = page.size.height_mm;
        const Material& material = job_.material_of(page.family);
        fmt::format_to(std::back_inserter(out_), "<g fill=\"{}\">\n", light(material.colour));
        for (const PlacedPiece& placed : page.pieces) {
            add_piece(placed);
        }
        out_ += "</g>\n";
        add_foot(page, number, material);
        return std::move(out_);
    }

private:
    void add_run(const Polyline& points, const Pose& pose, bool closed) {
        bool first = true;
        for (const Vector2d& point : moved(points, pose)) {
            fmt::format_to(std::back_inserter(out_), "{}{},{}", first ? "M" : " ",
                           short_number(point.x()), short_number(height_ - point.y()));
            first = false;
        }
        out_ += closed ? "Z" : "";
    }

    void add_path(const char* kind, const Polyline& points, const Pose& pose, bool closed) {
        fmt::format_to(std::back_inserter(out_), "<path class=\"{}\" d=\"", kind);
        add_run(points, pose, closed);
        out_ += "\"/>\n";
    }

    void add_tabs(const Piece& piece, const Pose& pose) {
        if (piece.start_tab.length_mm > 0.0) {
            add_path("tab",
                     part_between(piece.outline, piece.cut_left.front(), piece.cut_right.front()),
                     pose, true);
        }
        if (piece.end_tab.length_mm > 0.0) {
            add_path("tab",
                     part_between(piece.outline, piece.cut_right.back(), piece.cut_left.back()),
                     pose, true);
        }
    }

    // Lines of one kind as one element.
    void add_marks(const Piece& piece, const Pose& pose, Operation operation) {
        std::vector<Polyline> lines;
        for (const Mark& mark : piece.marks) {
            if (mark.operation != operation) {
                continue;
            }
            if (mark.text.empty()) {
                lines.push_back(mark.path);
            } else {
                const std::vector<Polyline> strokes = mark_strokes(mark);
                lines.insert(lines.end(), strokes.begin(), strokes.end());
            }
        }
        if (lines.empty()) {
            return;
        }
        out_ += operation == Operation::Score ? "<path class=\"fold\" d=\""
                                              : "<path class=\"mark\" d=\"";
        for (const Polyline& line : lines) {
            add_run(line, pose, false);
        }
        out_ += "\"/>\n";
    }

    void add_piece(const PlacedPiece& placed) {
        const Piece& piece = *placed.piece;
        const std::string id = escaped(piece.id);
        fmt::format_to(std::back_inserter(out_), "<g id=\"{}\"><title>{}</title>\n", id, id);
        fmt::format_to(std::back_inserter(out_), "<path class=\"cut\" d=\"");
        add_run(piece.outline, placed.pose, true);
        for (const Polyline& cut : piece.cuts) {
            add_run(cut, placed.pose, false);
        }
        out_ += "\"/>\n";
        add_tabs(piece, placed.pose);
        add_marks(piece, placed.pose, Operation::Score);
        add_marks(piece, placed.pose, Operation::Engrave);
        if (!bears_name(piece)) {
            const Box box = bounds(moved(piece.outline, placed.pose));
            fmt::format_to(std::back_inserter(out_), "<text x=\"{}\" y=\"{}\">{}</text>\n",
                           short_number(box.low.x()), short_number(height_ - box.high.y() - 0.5),
                           id);
        }
        out_ += "</g>\n";
    }

    void add_foot(const ScissorsPage& page, std::size_t number, const Material& material) {
        const double x = kPageMarginMm;
        const double y = page.size.height_mm - kPageMarginMm;
        const std::string left = short_number(x);
        const std::string base = short_number(y);
        fmt::format_to(std::back_inserter(out_),
                       "<path class=\"scale-bar mark\" d=\"M{0},{1}h100M{0},{2}v3M{3},{2}v3"
                       "M{4},{2}v3\"/>\n",
                       left, base, short_number(y - 3.0), short_number(x + 50.0),
                       short_number(x + 100.0));
        fmt::format_to(std::back_inserter(out_),
                       "<text x=\"{}\" y=\"{}\">this bar is 100 mm long: print at 100 %</text>\n",
                       short_number(x + 2.0), short_number(y - 1.0));
        fmt::format_to(std::back_inserter(out_),
                       "<text x=\"{}\" y=\"{}\">{} · page {} of {} · {}{}</text>\n",
                       short_number(x + 106.0), base, escaped(job_.input.file), number, pages_,
                       escaped(material.name),
                       page.fits_paper ? "" : " · longer than the paper: plotter or poster print");
    }

    const JobResult& job_;
    std::size_t pages_;
    double height_ = 0.0;
    std::string out_;
};

std::string document(const SheetSize& size, std::string_view title, std::string_view content) {
    const std::string width = short_number(size.width_mm);
    const std::string height = short_number(size.height_mm);
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg {0} width=\"{1}mm\" height=\"{2}mm\" viewBox=\"0 0 {1} {2}\">\n"
        "<title>{3}</title>\n{4}{5}</svg>\n",
        kNamespaces, width, height, escaped(title), kStyle, content);
}

}  // namespace

ScissorsDrawing write_scissors(const JobResult& job) {
    const std::vector<ScissorsPage> pages = scissors_pages(job);
    PageWriter writer(job, pages.size());
    ScissorsDrawing drawing;
    std::string view;   // Inkscape's pages.
    std::string whole;  // What is on them.
    SheetSize size;
    double x = 0.0;
    double y = 0.0;
    double row_mm = 0.0;
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const SheetSize& page = pages[i].size;
        const std::string content = writer.write(pages[i], i + 1);
        const std::string name = fmt::format("{}, page {}", job.input.file, i + 1);
        drawing.pages.push_back(document(page, name, content));
        if (i > 0 && i % kPagesInRow == 0) {
            y += row_mm + kPageGapMm;
            x = 0.0;
            row_mm = 0.0;
        }
        fmt::format_to(std::back_inserter(view),
                       "<inkscape:page id=\"page-{}\" x=\"{}\" y=\"{}\" width=\"{}\" "
                       "height=\"{}\"/>\n",
                       i + 1, short_number(x), short_number(y), short_number(page.width_mm),
                       short_number(page.height_mm));
        fmt::format_to(std::back_inserter(whole),
                       "<g inkscape:groupmode=\"layer\" inkscape:label=\"page {}\" "
                       "transform=\"translate({} {})\">\n<rect width=\"{}\" height=\"{}\" "
                       "fill=\"#fff\" stroke=\"#ccc\" stroke-width=\".2\"/>\n{}</g>\n",
                       i + 1, short_number(x), short_number(y), short_number(page.width_mm),
                       short_number(page.height_mm), content);
        x += page.width_mm + kPageGapMm;
        row_mm = std::max(row_mm, page.height_mm);
        size.width_mm = std::max(size.width_mm, x - kPageGapMm);
        size.height_mm = std::max(size.height_mm, y + page.height_mm);
    }
    drawing.all = document(
        size, fmt::format("{}, all pieces", job.input.file),
        fmt::format("<sodipodi:namedview id=\"view\">\n{}</sodipodi:namedview>\n{}", view, whole));
    return drawing;
}

}  // namespace leafcutter::fab
