// A document as HTML and PDF: well formed, complete, self-contained, the same every time.

#include <array>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../support/grid_job.h"
#include "../support/quad_grids.h"
#include "../support/temp_dir.h"
#include "fab/guide/content.h"
#include "fab/guide/html.h"
#include "fab/guide/paging.h"
#include "fab/guide/pdf.h"
#include "fab/guide/winansi.h"

namespace leafcutter::fab::guide {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Document small_document() {
    Document document;
    document.title = "A <b>title</b> & \"more\"";
    document.subtitle = "Running";
    Drawing shared{20.0, 10.0, {}, {}};
    Paths square;
    square.lines = {{{1.0, 1.0}, {9.0, 1.0}, {9.0, 9.0}, {1.0, 9.0}}};
    square.fill = Colour{200, 10, 10};
    square.stroke = Stroke{};
    shared.shapes.emplace_back(square);
    document.shared.push_back(shared);
    Drawing drawing{20.0, 10.0, {Use{0}}, "A square"};
    Label label;
    label.text = "W1 <x>";
    label.at = {2.0, 5.0};
    label.halo = true;
    label.angle_deg = 90.0;
    drawing.shapes.emplace_back(label);
    document.blocks = {Heading{1, "One & two"},
                       Paragraph{"Words, <words>", TextStyle::Note},
                       List{{"first", "second <i>"}, Bullet::TickBox},
                       Table{{{"Piece", Align::Left, 1.0}, {"mm", Align::Right, 1.0}},
                             {{Cell{"W1.1", Colour{1, 2, 3}, true, {}}, Cell{"12", {}, false, {}}},
                              {Cell{"W2.1", {}, false, 0}, Cell{"13", {}, false, {}}}},
                             2},
                       Figure{{drawing, drawing}, "Two > one"},
                       Step{"1  Do it", {"like <this>"}, Figure{{drawing}, {}}}};
    return document;
}

// The first fault of nesting in HTML; empty if every element is closed in its turn.
std::string nesting_fault(const std::string& html) {
    const std::set<std::string> empty = {"meta", "!doctype", "br"};
    std::vector<std::string> open;
    for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at)) {
        const std::size_t end = html.find('>', at);
        if (end == std::string::npos) {
            return "unfinished tag";
        }
        std::string tag = html.substr(at + 1, end - at - 1);
        at = end;
        const bool closes = tag[0] == '/';
        const bool single = tag.back() == '/';
        tag = tag.substr(closes ? 1 : 0);
        const std::string name = tag.substr(0, tag.find_first_of(" \n/"));
        if (empty.count(name) > 0 || single) {
            continue;
        }
        if (!closes) {
            open.push_back(name);
        } else if (open.empty() || open.back() != name) {
            return fmt::format("</{}> where {} is open", name,
                               open.empty() ? "nothing" : open.back());
        } else {
            open.pop_back();
        }
        if (name == "style" && !closes) {
            at = html.find("</style", at) - 1;
        }
    }
    return open.empty() ? "" : "open at the end: " + open.back();
}

TEST(WriteHtml, ClosesWhatItOpens) {
    EXPECT_EQ(nesting_fault(write_html(small_document())), "");
    EXPECT_EQ(nesting_fault("<p><b></p></b>"), "</p> where b is open");
}

TEST(WriteHtml, EscapesEveryText) {
    const std::string html = write_html(small_document());
    for (const char* raw : {"<b>", "<words>", "<i>", "<this>", "<x>"}) {
        EXPECT_THAT(html, Not(HasSubstr(raw)));
    }
    EXPECT_THAT(html, HasSubstr("A &lt;b&gt;title&lt;/b&gt; &amp;"));
}

TEST(WriteHtml, NeedsNothingFromOutside) {
    const JobResult job = test::grid_job(test::cylinder_grid({6, 8}, 20.0, 60.0));
    const std::string html = write_html(make_guide(job));
    for (const char* outside :
         {"http:", "https:", "//", "src=", "<script", "<link", "@import", "url("}) {
        EXPECT_THAT(html, Not(HasSubstr(outside))) << outside;
    }
    EXPECT_EQ(nesting_fault(html), "");
    for (const Strip& strip : job.strips) {
        EXPECT_THAT(html, HasSubstr(strip.id));
    }
}

TEST(ToWinansi, KeepsWhatTheFontHas) {
    EXPECT_EQ(to_winansi("W1\xe2\x80\x93W3 \xc3\xa9 \xe2\x82\xac"), "W1\x96W3 \xe9 \x80");
    EXPECT_EQ(to_winansi("\xc5\x81\xc3\xb3"
                         "d\xc5\xba \xe7\x8c\xab\t\x01"),
              "L\xf3"
              "dz ?  ");
    EXPECT_EQ(to_winansi("e\xcc\x81"), "e");  // A combining accent.
    EXPECT_EQ(to_winansi("\xff\xc3"), "??");  // No UTF-8.
    EXPECT_EQ(to_winansi("\xf0\x9f\x90\x88!"), "?!");
}

TEST(WritePdf, IsAPdfAndTheSameEveryTime) {
    const std::string pdf = write_pdf(small_document());
    EXPECT_THAT(pdf, StartsWith("%PDF-1."));
    EXPECT_THAT(pdf.substr(pdf.size() - 8), HasSubstr("%%EOF"));
    EXPECT_EQ(pdf, write_pdf(small_document()));
    EXPECT_THAT(pdf, Not(HasSubstr("CreationDate")));
}

TEST(WritePdf, TakesAnyTitle) {
    Document document = small_document();
    document.title = "\xff\xe7\x8c\xab (brackets) \\ \x01";
    EXPECT_THAT(write_pdf(document), StartsWith("%PDF-1."));
    document.blocks.clear();
    document.title.clear();
    EXPECT_THAT(write_pdf(document), StartsWith("%PDF-1."));
}

std::string text_of(const std::string& pdf) {
    const test::TempDir folder;
    const std::string path = (folder.path() / "guide.pdf").string();
    std::ofstream(path, std::ios::binary) << pdf;
    std::string text;
    FILE* pipe = popen(("pdftotext -layout " + path + " - 2>/dev/null").c_str(), "r");
    std::array<char, 4096> buffer{};
    while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe)) {
        text.append(buffer.data(), count);
    }
    return pclose(pipe) == 0 ? text : std::string();
}

TEST(WritePdf, HoldsEveryStripAsText) {
    const JobResult job = test::grid_job(test::torus_grid({8, 12}, 40.0, 15.0));
    const std::string text = text_of(write_pdf(make_guide(job)));
    if (text.empty()) {
        GTEST_SKIP() << "no pdftotext";
    }
    for (const Piece& piece : job.pieces) {
        EXPECT_THAT(text, HasSubstr(piece.id));
    }
    EXPECT_THAT(text, HasSubstr("Weave in W8"));
}

// Notes what is drawn where.
class NotedCanvas final : public Canvas {
public:
    struct Noted {
        int page = 0;
        std::string text;
        Point at;
        double width_mm = 0.0;
    };

    void add_page() override { page_ = pages_++; }
    void select_page(int page) override { page_ = page; }
    double text_width_mm(std::string_view text, double size_mm, bool bold) const override {
        return static_cast<double>(text.size()) * size_mm * (bold ? 0.6 : 0.5);
    }
    void draw(const Label& label, const Point& origin) override {
        const double width = text_width_mm(label.text, label.size_mm, label.bold);
        const double back = label.anchor == Anchor::Start ? 0.0
                            : label.anchor == Anchor::End ? width
                                                          : width / 2.0;
        labels.push_back({page_, label.text, origin + label.at - Point(back, 0.0), width});
    }
    void draw(const Paths& /*paths*/, const Point& /*origin*/) override {}
    void bookmark(const std::string& title, int /*level*/, double /*y_mm*/) override {
        bookmarks.push_back(title);
    }

    const Noted& find(const std::string& text) const {
        for (const Noted& label : labels) {
            if (label.text == text) {
                return label;
            }
        }
        throw std::runtime_error("not drawn: " + text);
    }

    std::vector<Noted> labels;
    std::vector<std::string> bookmarks;

private:
    int page_ = 0;
    int pages_ = 0;
};

TEST(SetPages, KeepsInsideThePageAndDropsNothing) {
    Document document = small_document();
    Table table;
    table.columns = {{"Piece", Align::Left, 1.0}, {"Length", Align::Right, 1.0}};
    table.abreast = 3;
    for (int i = 0; i < 500; ++i) {
        table.rows.push_back({Cell{fmt::format("id{}", i), {}, true, {}},
                              Cell{fmt::format("{} mm", i), {}, false, {}}});
    }
    document.blocks.emplace_back(table);
    document.blocks.emplace_back(Paragraph{std::string(3000, 'x') + " y", TextStyle::Body});
    NotedCanvas canvas;
    const int pages = set_pages(document, canvas);
    for (const NotedCanvas::Noted& label : canvas.labels) {
        EXPECT_GE(label.at.x(), 14.9) << label.text;
        EXPECT_LE(label.at.x() + label.width_mm, 195.1) << label.text;
        EXPECT_GE(label.at.y(), 8.0);
        EXPECT_LE(label.at.y(), 290.0);
        EXPECT_LT(label.page, pages);
    }
    for (int i = 0; i < 500; ++i) {
        canvas.find(fmt::format("id{}", i));
    }
    canvas.find(fmt::format("1 / {}", pages));
    EXPECT_THAT(canvas.bookmarks, ::testing::Contains("One & two"));
}

TEST(SetPages, ReadsTableRunsDownEachPageInTurn) {
    Document document;
    document.title = "t";
    Table table;
    table.columns = {{"Piece", Align::Left, 1.0}};
    table.abreast = 2;
    for (int i = 0; i < 10; ++i) {
        table.rows.push_back({Cell{fmt::format("id{}", i), {}, false, {}}});
    }
    document.blocks.emplace_back(table);
    NotedCanvas canvas;
    set_pages(document, canvas);
    EXPECT_EQ(canvas.find("id0").at.x(), canvas.find("id4").at.x());
    EXPECT_LT(canvas.find("id0").at.x() + 50.0, canvas.find("id5").at.x());
    EXPECT_EQ(canvas.find("id0").at.y(), canvas.find("id5").at.y());
}

TEST(SetPages, KeepsAStepTogether) {
    Document document;
    document.title = "t";
    for (int i = 0; i < 30; ++i) {
        Drawing drawing{60.0, 45.0, {}, {}};
        Label label;
        label.text = fmt::format("picture {}", i);
        label.at = {1.0, 44.0};
        drawing.shapes.emplace_back(label);
        document.blocks.emplace_back(
            Step{fmt::format("step {}", i), {fmt::format("text {}", i)}, Figure{{drawing}, {}}});
    }
    NotedCanvas canvas;
    EXPECT_GT(set_pages(document, canvas), 5);
    for (int i = 0; i < 30; ++i) {
        const int page = canvas.find(fmt::format("step {}", i)).page;
        EXPECT_EQ(canvas.find(fmt::format("text {}", i)).page, page);
        EXPECT_EQ(canvas.find(fmt::format("picture {}", i)).page, page);
    }
}

}  // namespace
}  // namespace leafcutter::fab::guide
