// A document as values: headings, text, tables and vector pictures in reading order. Writers turn
// it into HTML (html.h) and PDF (pdf.h); neither knows what it is about.
//
// Pictures are measured in millimetres on paper, origin at the upper left, y down. All text is
// UTF-8; writers escape it.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::fab::guide {

using Point = Eigen::Vector2d;
using Points = std::vector<Point>;

struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;

    friend bool operator==(const Colour&, const Colour&) = default;
};

struct Stroke {
    Colour colour;
    double width_mm = 0.2;
    bool dashed = false;
};

// Lines or areas that look alike. Areas are filled first, all of them, then stroked.
struct Paths {
    std::vector<Points> lines;
    bool closed = true;  // The last point of each goes on to its first; only then it is filled.
    std::optional<Colour> fill;
    std::optional<Stroke> stroke;
};

enum class Anchor { Start, Middle, End };

struct Label {
    std::string text;
    Point at = Point::Zero();  // On the base line.
    double size_mm = 2.6;
    Anchor anchor = Anchor::Start;
    Colour colour = {34, 34, 34};
    bool bold = false;
    bool halo = false;       // A white rim, to be read on top of a picture.
    double angle_deg = 0.0;  // Counter-clockwise, about `at`.
};

// Another drawing of the document, as large as it is, at the same origin.
struct Use {
    std::size_t shared = 0;  // Into Document::shared.
};

using Shape = std::variant<Paths, Label, Use>;

struct Drawing {
    double width_mm = 0.0;
    double height_mm = 0.0;
    std::vector<Shape> shapes;  // The first lies undermost.
    std::string description;    // For those who can't see it.
};

struct Heading {
    int level = 1;  // 1: a chapter, on a new page. 2, 3: inside.
    std::string text;
};

enum class TextStyle { Body, Lead, Note };

struct Paragraph {
    std::string text;
    TextStyle style = TextStyle::Body;
};

enum class Bullet { Dot, Number, TickBox };

struct List {
    std::vector<std::string> items;
    Bullet bullet = Bullet::Dot;
};

enum class Align { Left, Right };

struct Column {
    std::string title;
    Align align = Align::Left;
    double share = 1.0;  // Of the table's width, in parts.
};

struct Cell {
    std::string text;
    std::optional<Colour> swatch;        // A patch of colour before the text.
    bool tick_box = false;               // An empty box before the text.
    std::optional<std::size_t> picture;  // Into Document::shared: above the text.
};

struct Table {
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> rows;
    int abreast = 1;  // That many runs of rows side by side, to be read one after the other.
};

// Pictures side by side; below each other where there is no room.
struct Figure {
    std::vector<Drawing> drawings;
    std::string caption;
};

// Something to do and tick off, never parted by a page break.
struct Step {
    std::string title;
    std::vector<std::string> texts;
    Figure figure;
};

using Block = std::variant<Heading, Paragraph, List, Table, Figure, Step>;

struct Document {
    std::string title;
    std::string subtitle;  // Of the running header.
    std::vector<Drawing> shared;
    std::vector<Block> blocks;
};

// The width that text and pictures have on a page.
constexpr double kTextWidthMm = 180.0;

}  // namespace leafcutter::fab::guide
