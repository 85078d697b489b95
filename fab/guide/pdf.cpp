#include "fab/guide/pdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <hpdf.h>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "fab/guide/paging.h"
#include "fab/guide/winansi.h"
#include "geometry/error.h"

namespace leafcutter::fab::guide {

namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
// Paths are drawn in whole steps of 1/50 mm, which makes short numbers.
constexpr double kStepsPerMm = 50.0;

float points(double mm) {
    return static_cast<float>(std::round(mm * kPointsPerMm * 100.0) / 100.0);
}

float steps(double mm) {
    return static_cast<float>(std::lround(mm * kStepsPerMm));
}

float part(std::uint8_t value) {
    return std::round(static_cast<float>(value) / 255.0F * 1000.0F) / 1000.0F;
}

struct FreeDocument {
    void operator()(HPDF_Doc document) const { HPDF_Free(document); }
};

// The library goes on after an error, but every later call then reports another one.
struct FirstError {
    HPDF_STATUS error = HPDF_OK;
    HPDF_STATUS detail = 0;
};

void note_error(HPDF_STATUS error, HPDF_STATUS detail, void* first) {
    auto* noted = static_cast<FirstError*>(first);
    if (noted->error == HPDF_OK) {
        *noted = {error, detail};
    }
}

class PdfCanvas final : public Canvas {
public:
    PdfCanvas() : document_(HPDF_New(note_error, &error_)) {
        if (!document_) {
            throw geometry::Error(geometry::ErrorKind::SelfCheck, "pdf", "guide: no PDF document");
        }
        HPDF_SetCompressionMode(document_.get(), HPDF_COMP_ALL);
        regular_ = HPDF_GetFont(document_.get(), "Helvetica", "WinAnsiEncoding");
        bold_ = HPDF_GetFont(document_.get(), "Helvetica-Bold", "WinAnsiEncoding");
        encoder_ = HPDF_GetEncoder(document_.get(), "WinAnsiEncoding");
        HPDF_SetPageMode(document_.get(), HPDF_PAGE_MODE_USE_OUTLINE);
    }

    void add_page() override {
        page_ = HPDF_AddPage(document_.get());
        HPDF_Page_SetSize(page_, HPDF_PAGE_SIZE_A4, HPDF_PAGE_PORTRAIT);
        HPDF_Page_SetLineJoin(page_, HPDF_ROUND_JOIN);
        HPDF_Page_SetLineCap(page_, HPDF_ROUND_END);
        pages_.push_back(page_);
    }

    void select_page(int page) override { page_ = pages_.at(static_cast<std::size_t>(page)); }

    double text_width_mm(std::string_view text, double size_mm, bool bold) const override {
        const std::string letters = to_winansi(text);
        const auto* bytes = reinterpret_cast<const HPDF_BYTE*>(letters.data());
        const HPDF_TextWidth width = HPDF_Font_TextWidth(bold ? bold_ : regular_, bytes,
                                                         static_cast<HPDF_UINT>(letters.size()));
        return static_cast<double>(width.width) / 1000.0 * size_mm;
    }

    void draw(const Label& label, const Point& origin) override {
        const std::string letters = to_winansi(label.text);
        const double angle = label.angle_deg * std::numbers::pi / 180.0;
        Point at = origin + label.at;
        if (label.anchor != Anchor::Start) {
            const double back = text_width_mm(label.text, label.size_mm, label.bold) *
                                (label.anchor == Anchor::Middle ? 0.5 : 1.0);
            at -= back * Point(std::cos(angle), -std::sin(angle));
        }
        if (label.halo) {
            HPDF_Page_SetRGBStroke(page_, 1.0F, 1.0F, 1.0F);
            HPDF_Page_SetLineWidth(page_, points(0.6));
            HPDF_Page_SetTextRenderingMode(page_, HPDF_STROKE);
            show(letters, label, at, angle);
            HPDF_Page_SetTextRenderingMode(page_, HPDF_FILL);
        }
        set_fill(label.colour);
        show(letters, label, at, angle);
    }

    void draw(const Paths& paths, const Point& origin) override {
        const bool filled = paths.closed && paths.fill.has_value();
        if (paths.lines.empty() || (!filled && !paths.stroke)) {
            return;
        }
        HPDF_Page_GSave(page_);
        const double scale = kPointsPerMm / kStepsPerMm;
        HPDF_Page_Concat(page_, static_cast<float>(scale), 0.0F, 0.0F, static_cast<float>(-scale),
                         points(origin.x()), points(kPageHeightMm - origin.y()));
        if (filled) {
            set_fill(*paths.fill);
        }
        if (paths.stroke) {
            set_stroke(*paths.stroke);
        }
        for (const Points& line : paths.lines) {
            trace(line, paths.closed);
        }
        if (filled && paths.stroke) {
            HPDF_Page_FillStroke(page_);
        } else if (filled) {
            HPDF_Page_Fill(page_);
        } else {
            HPDF_Page_Stroke(page_);
        }
        HPDF_Page_GRestore(page_);
    }

    void bookmark(const std::string& title, int level, double y_mm) override {
        const std::size_t depth = static_cast<std::size_t>(std::clamp(level, 1, 3)) - 1;
        HPDF_Outline parent = nullptr;
        for (std::size_t i = 0; i < depth; ++i) {
            parent = outlines_[i] != nullptr ? outlines_[i] : parent;
        }
        HPDF_Outline entry =
            HPDF_CreateOutline(document_.get(), parent, to_winansi(title).c_str(), encoder_);
        HPDF_Destination there = HPDF_Page_CreateDestination(page_);
        HPDF_Destination_SetFitH(there, points(kPageHeightMm - y_mm + 4.0));
        HPDF_Outline_SetDestination(entry, there);
        HPDF_Outline_SetOpened(entry, depth == 0 ? HPDF_TRUE : HPDF_FALSE);
        outlines_[depth] = entry;
        std::fill(outlines_.begin() + static_cast<std::ptrdiff_t>(depth) + 1, outlines_.end(),
                  nullptr);
    }

    std::string bytes(const std::string& title) {
        HPDF_SetInfoAttr(document_.get(), HPDF_INFO_TITLE, to_winansi(title).c_str());
        HPDF_SaveToStream(document_.get());
        if (error_.error != HPDF_OK) {
            throw geometry::Error(geometry::ErrorKind::SelfCheck, "pdf",
                                  fmt::format("guide: the PDF library reports {:#x}, {:#x}",
                                              error_.error, error_.detail));
        }
        std::string result(HPDF_GetStreamSize(document_.get()), '\0');
        auto size = static_cast<HPDF_UINT32>(result.size());
        HPDF_ResetStream(document_.get());
        HPDF_ReadFromStream(document_.get(), reinterpret_cast<HPDF_BYTE*>(result.data()), &size);
        result.resize(size);
        return result;
    }

private:
    void set_fill(const Colour& c) {
        HPDF_Page_SetRGBFill(page_, part(c.red), part(c.green), part(c.blue));
    }

    // Widths are in steps: set inside of the scaled frame.
    void set_stroke(const Stroke& stroke) {
        const Colour& c = stroke.colour;
        HPDF_Page_SetRGBStroke(page_, part(c.red), part(c.green), part(c.blue));
        const float width = std::max(1.0F, steps(stroke.width_mm));
        HPDF_Page_SetLineWidth(page_, width);
        if (stroke.dashed) {
            const auto unit = static_cast<HPDF_UINT16>(width);
            const std::array<HPDF_UINT16, 2> dashes = {static_cast<HPDF_UINT16>(4 * unit),
                                                       static_cast<HPDF_UINT16>(3 * unit)};
            HPDF_Page_SetDash(page_, dashes.data(), 2, 0);
        }
    }

    void trace(const Points& line, bool closed) {
        if (line.empty()) {
            return;
        }
        std::pair<float, float> last = {steps(line.front().x()), steps(line.front().y())};
        HPDF_Page_MoveTo(page_, last.first, last.second);
        for (std::size_t i = 1; i < line.size(); ++i) {
            const std::pair<float, float> next = {steps(line[i].x()), steps(line[i].y())};
            if (next != last) {
                HPDF_Page_LineTo(page_, next.first, next.second);
            }
            last = next;
        }
        if (closed) {
            HPDF_Page_ClosePath(page_);
        }
    }

    void show(const std::string& letters, const Label& label, const Point& at, double angle) {
        HPDF_Page_BeginText(page_);
        HPDF_Page_SetFontAndSize(page_, label.bold ? bold_ : regular_, points(label.size_mm));
        const auto c = static_cast<float>(std::cos(angle));
        const auto s = static_cast<float>(std::sin(angle));
        HPDF_Page_SetTextMatrix(page_, c, s, -s, c, points(at.x()), points(kPageHeightMm - at.y()));
        HPDF_Page_ShowText(page_, letters.c_str());
        HPDF_Page_EndText(page_);
    }

    FirstError error_;
    std::unique_ptr<std::remove_pointer_t<HPDF_Doc>, FreeDocument> document_;
    HPDF_Font regular_ = nullptr;  // These belong to the document.
    HPDF_Font bold_ = nullptr;
    HPDF_Encoder encoder_ = nullptr;
    HPDF_Page page_ = nullptr;
    std::vector<HPDF_Page> pages_;
    std::array<HPDF_Outline, 3> outlines_ = {};  // The latest of each level.
};

}  // namespace

std::string write_pdf(const Document& document) {
    PdfCanvas canvas;
    set_pages(document, canvas);
    return canvas.bytes(document.title);
}

}  // namespace leafcutter::fab::guide
