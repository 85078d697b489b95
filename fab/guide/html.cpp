#include "fab/guide/html.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "fab/export/number.h"
#include "fab/guide/svg_drawing.h"
#include "fab/markup.h"

namespace leafcutter::fab::guide {

namespace {

constexpr const char* kStyle = R"(
@page { size: A4; margin: 16mm 15mm 16mm; }
* { box-sizing: border-box; }
body { font: 15px/1.45 Helvetica, Arial, "Liberation Sans", sans-serif; color: #222;
       background: #fff; max-width: 188mm; margin: 0 auto; padding: 1rem 4mm 4rem; }
h1 { font-size: 30px; line-height: 1.15; margin: 0 0 .3em; overflow-wrap: anywhere; }
h2 { font-size: 22px; line-height: 1.2; margin: 3.2rem 0 .6rem; padding-top: .5rem;
     border-top: 2px solid #222; }
h3 { font-size: 17px; margin: 1.8rem 0 .4rem; }
h4 { font-size: 15px; margin: 1.2rem 0 .3rem; }
p { margin: 0 0 .6rem; }
.lead { font-size: 17px; color: #555; }
.note { font-size: 13px; color: #555; }
ul, ol { margin: 0 0 .8rem; padding-left: 1.4rem; } li { margin: 0 0 .25rem; }
ul.ticks { list-style: none; padding: 0; }
ul.ticks li { padding-left: 1.5rem; text-indent: -1.5rem; }
.tick { display: inline-block; width: .8em; height: .8em; border: 1.3px solid #222;
        border-radius: .12em; margin-right: .6em; vertical-align: -.06em; text-indent: 0; }
.swatch { display: inline-block; width: .8em; height: .8em; border: 1px solid #777;
          margin-right: .4em; vertical-align: -.06em; }
.tables { column-gap: 6mm; margin: 0 0 .9rem; } .tables table { margin: 0; }
.tables th, .tables td { white-space: nowrap; padding-right: .4rem; } td svg { max-width: none; display: block; }
table { border-collapse: collapse; width: 100%; margin: 0 0 .9rem; font-size: 13px;
        font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 700; border-bottom: 1.3px solid #222; }
td { border-bottom: 1px solid #ddd; vertical-align: top; }
th, td { padding: .18rem .9rem .18rem 0; } th:last-child, td:last-child { padding-right: 0; }
.r { text-align: right; }
figure { margin: .5rem 0 1rem; }
.pictures { display: flex; flex-wrap: wrap; gap: 3mm; align-items: flex-start; }
figcaption { font-size: 13px; color: #555; margin-top: .3rem; }
svg { max-width: 100%; height: auto; flex: 0 1 auto; stroke-linejoin: round;
      stroke-linecap: round; overflow: hidden; }
svg text.halo { paint-order: stroke; stroke: #fff; stroke-width: 35px; }
.step { border-top: 1px solid #ccc; padding: .7rem 0 .2rem; }
.step h4 { margin: 0 0 .15rem; } .step p { margin: 0 0 .3rem; } .step figure { margin: .4rem 0; }
.defs { position: absolute; width: 0; height: 0; }
nav ol { list-style: none; padding: 0; columns: 2; } nav a { color: inherit; }
@media print {
  body { font-size: 10pt; max-width: none; padding: 0; }
  h1 { font-size: 22pt; } h2 { font-size: 16pt; margin-top: 0; } h3 { font-size: 12pt; }
  h4 { font-size: 10pt; } .lead { font-size: 12pt; } .note, figcaption, table { font-size: 8.5pt; }
  .tables table { font-size: 8pt; } h3 { margin-top: 1.2rem; }
  h2 { break-before: page; } h2, h3, h4, th, p:has(+ figure) { break-after: avoid; }
  tr, li, figure, .step, svg { break-inside: avoid; } p { orphans: 2; widows: 2; }
}
)";

class HtmlWriter {
public:
    explicit HtmlWriter(const Document& document) : document_(document) {}

    std::string write() {
        add("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            "<title>{0}</title>\n<style>{1}</style></head><body>\n<h1>{0}</h1>\n",
            escaped(document_.title), kStyle);
        add_shared();
        for (const Block& block : document_.blocks) {
            std::visit([&](const auto& one) { add_block(one); }, block);
        }
        out_ += "</body></html>\n";
        return std::move(out_);
    }

private:
    template <typename... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(out_), format, std::forward<Values>(values)...);
    }

    void add_shared() {
        if (document_.shared.empty()) {
            return;
        }
        out_ += "<svg class=\"defs\" aria-hidden=\"true\"><defs>\n";
        for (std::size_t i = 0; i < document_.shared.size(); ++i) {
            append_shared(out_, document_.shared[i], i);
        }
        out_ += "</defs></svg>\n";
    }

    void add_block(const Heading& heading) {
        const int level = std::clamp(heading.level, 1, 3) + 1;
        add("<h{0}>{1}</h{0}>\n", level, escaped(heading.text));
    }

    void add_block(const Paragraph& paragraph) {
        const char* style = paragraph.style == TextStyle::Lead   ? " class=\"lead\""
                            : paragraph.style == TextStyle::Note ? " class=\"note\""
                                                                 : "";
        add("<p{}>{}</p>\n", style, escaped(paragraph.text));
    }

    void add_block(const List& list) {
        const bool numbered = list.bullet == Bullet::Number;
        const bool ticks = list.bullet == Bullet::TickBox;
        add("<{}{}>\n", numbered ? "ol" : "ul", ticks ? " class=\"ticks\"" : "");
        for (const std::string& item : list.items) {
            add("<li>{}{}</li>\n", ticks ? kTick : "", escaped(item));
        }
        add("</{}>\n", numbered ? "ol" : "ul");
    }

    // Runs abreast are columns of text: they fill page by page, and are fewer on a narrow screen.
    void add_block(const Table& table) {
        if (table.abreast > 1) {
            add("<div class=\"tables\" style=\"columns:{} {}mm\">", table.abreast,
                kTextWidthMm / (table.abreast + 0.6));
        }
        out_ += "<table>";
        const bool has_titles = std::any_of(table.columns.begin(), table.columns.end(),
                                            [](const Column& c) { return !c.title.empty(); });
        if (has_titles) {
            out_ += "<thead><tr>";
            for (const Column& column : table.columns) {
                add("<th{}>{}</th>", class_of(column), escaped(column.title));
            }
            out_ += "</tr></thead>";
        }
        out_ += "<tbody>\n";
        for (const std::vector<Cell>& row : table.rows) {
            out_ += "<tr>";
            for (std::size_t i = 0; i < row.size(); ++i) {
                add_cell(row[i], i < table.columns.size() ? table.columns[i] : Column());
            }
            out_ += "</tr>\n";
        }
        out_ += table.abreast > 1 ? "</tbody></table></div>\n" : "</tbody></table>\n";
    }

    static const char* class_of(const Column& column) {
        return column.align == Align::Right ? " class=\"r\"" : "";
    }

    void add_cell(const Cell& cell, const Column& column) {
        add("<td{}>", class_of(column));
        if (cell.tick_box) {
            out_ += kTick;
        }
        if (cell.swatch) {
            add("<span class=\"swatch\" style=\"background:{}\"></span>", hex(*cell.swatch));
        }
        if (cell.picture) {
            append_svg(out_, picture_of(cell));
        }
        add("{}</td>", escaped(cell.text));
    }

    Drawing picture_of(const Cell& cell) const {
        const Drawing& shared = document_.shared.at(*cell.picture);
        return {shared.width_mm, shared.height_mm, {Use{*cell.picture}}, {}};
    }

    void add_block(const Figure& figure) {
        if (figure.drawings.empty()) {
            return;
        }
        out_ += "<figure><div class=\"pictures\">\n";
        for (const Drawing& drawing : figure.drawings) {
            append_svg(out_, drawing);
        }
        out_ += "</div>";
        if (!figure.caption.empty()) {
            add("<figcaption>{}</figcaption>", escaped(figure.caption));
        }
        out_ += "</figure>\n";
    }

    void add_block(const Step& step) {
        add("<div class=\"step\"><h4>{}{}</h4>\n", kTick, escaped(step.title));
        for (const std::string& text : step.texts) {
            add("<p>{}</p>\n", escaped(text));
        }
        add_block(step.figure);
        out_ += "</div>\n";
    }

    static constexpr const char* kTick = "<span class=\"tick\"></span>";

    const Document& document_;
    std::string out_;
};

}  // namespace

std::string write_html(const Document& document) {
    return HtmlWriter(document).write();
}

}  // namespace leafcutter::fab::guide
