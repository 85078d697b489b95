// Sets a document page by page on something that can draw: A4 portrait, a running header, numbered.

#pragma once

#include <string>
#include <string_view>

#include "fab/guide/document.h"

namespace leafcutter::fab::guide {

constexpr double kPageWidthMm = 210.0;
constexpr double kPageHeightMm = 297.0;

// Pages are drawn on in millimetres from their upper left corner, y down.
class Canvas {
public:
    Canvas() = default;
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;
    virtual ~Canvas() = default;

    // Behind the last; it is drawn on from now on.
    virtual void add_page() = 0;
    // Goes back to a page, counted from 0.
    virtual void select_page(int page) = 0;

    virtual double text_width_mm(std::string_view text, double size_mm, bool bold) const = 0;
    virtual void draw(const Label& label, const Point& origin) = 0;
    virtual void draw(const Paths& paths, const Point& origin) = 0;

    // An entry of the table of contents that leads to this height of this page. Level from 1.
    virtual void bookmark(const std::string& title, int level, double y_mm) = 0;
};

// Returns the number of pages.
int set_pages(const Document& document, Canvas& canvas);

}  // namespace leafcutter::fab::guide
