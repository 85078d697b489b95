#include "fab/guide/paging.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "fab/guide/type.h"

namespace leafcutter::fab::guide {

namespace {

constexpr double kLeft = (kPageWidthMm - kTextWidthMm) / 2.0;
constexpr double kTop = 22.0;
constexpr double kBottom = kPageHeightMm - 20.0;
constexpr double kTableGap = 8.0;
constexpr double kCellGap = 3.0;
constexpr double kDrawingGap = 3.0;
constexpr Colour kSoft = {85, 85, 85};
constexpr Colour kHair = {215, 215, 215};

constexpr Type kBody;
constexpr Type kLead{12.0, false, kSoft};
constexpr Type kNote{8.5, false, kSoft};
constexpr Type kCellType{8.5};
constexpr Type kColumnTitle{8.5, true};
constexpr Type kTitle{24.0, true, kInk, 1.2};
constexpr Type kStepTitle{10.0, true};
constexpr Type kRunning{8.0, false, kSoft};

Type type_of(const Heading& heading) {
    return heading.level <= 1 ? Type{16.0, true, kInk, 1.25} : Type{12.0, true, kInk, 1.3};
}

class Pager {
public:
    Pager(const Document& document, Canvas& canvas) : document_(document), canvas_(canvas) {}

    int set() {
        add_page();
        const std::vector<std::string> title = lines_of(document_.title, kTitle, kTextWidthMm);
        canvas_.bookmark(document_.title, 1, y_);
        set_lines(title, kTitle, kLeft);
        y_ += 2.0;
        for (const Block& block : document_.blocks) {
            ++next_;
            std::visit([&](const auto& one) { set_block(one); }, block);
        }
        number_pages();
        return pages_;
    }

private:
    void add_page() {
        canvas_.add_page();
        ++pages_;
        y_ = kTop;
    }

    // Begins a page if `height_mm` is no longer left on this one.
    void need(double height_mm) {
        if (y_ + height_mm > kBottom && y_ > kTop) {
            add_page();
        }
    }

    std::vector<std::string> lines_of(std::string_view text, const Type& type, double width) const {
        return wrapped(text, type, width, canvas_);
    }

    void set_line(const std::string& text, const Type& type, const Point& at, Anchor anchor) {
        Label label;
        label.text = text;
        label.size_mm = type.size_mm();
        label.anchor = anchor;
        label.colour = type.colour;
        label.bold = type.bold;
        canvas_.draw(label, at);
    }

    // The base line of a line whose box begins at y.
    static double base_of(double y, const Type& type) {
        return y + type.size_mm() * (0.5 * (type.leading - 1.0) + 0.78);
    }

    void set_lines(const std::vector<std::string>& lines, const Type& type, double x) {
        for (const std::string& line : lines) {
            need(type.line_mm());
            set_line(line, type, {x, base_of(y_, type)}, Anchor::Start);
            y_ += type.line_mm();
        }
    }

    void rule(const Point& from, double length_mm, const Stroke& stroke) {
        Paths paths;
        paths.closed = false;
        paths.lines = {{from, from + Point(length_mm, 0.0)}};
        paths.stroke = stroke;
        canvas_.draw(paths, Point::Zero());
    }

    void box(const Point& corner, double side_mm, const std::optional<Colour>& fill) {
        Paths paths;
        paths.lines = {{corner, corner + Point(side_mm, 0.0), corner + Point(side_mm, side_mm),
                        corner + Point(0.0, side_mm)}};
        paths.fill = fill;
        paths.stroke = Stroke{fill ? Colour{119, 119, 119} : kInk, fill ? 0.2 : 0.3, false};
        canvas_.draw(paths, Point::Zero());
    }

    // A box as high as the letters of a line at y.
    double tick_box(const Type& type, double x, double y) {
        const double side = 0.78 * type.size_mm();
        box({x, base_of(y, type) - side}, side, std::nullopt);
        return side + 0.55 * type.size_mm();
    }

    void set_block(const Heading& heading) {
        const Type type = type_of(heading);
        if (heading.level <= 1 && y_ > kTop) {
            add_page();
        } else if (y_ > kTop) {
            y_ += 0.6 * type.line_mm();
        }
        const auto lines = lines_of(heading.text, type, kTextWidthMm);
        need(static_cast<double>(lines.size()) * type.line_mm() + height_that_follows());
        canvas_.bookmark(heading.text, heading.level, y_);
        set_lines(lines, type, kLeft);
        y_ += heading.level <= 1 ? 3.0 : 1.0;
    }

    // How much of what comes behind a heading must stand on the same page: up to its picture.
    double height_that_follows() const {
        double height = 0.0;
        for (std::size_t i = next_; i < document_.blocks.size() && i < next_ + 3; ++i) {
            const Block& block = document_.blocks[i];
            if (const auto* paragraph = std::get_if<Paragraph>(&block)) {
                const auto lines = lines_of(paragraph->text, kBody, kTextWidthMm);
                height += static_cast<double>(lines.size()) * kBody.line_mm() + 2.0;
            } else if (const auto* figure = std::get_if<Figure>(&block)) {
                return height + height_of(*figure);
            } else if (const auto* step = std::get_if<Step>(&block)) {
                return height + height_of(*step);
            } else {
                return height + 4.0 * kBody.line_mm();
            }
        }
        return height;
    }

    void set_block(const Paragraph& paragraph) {
        const Type type = paragraph.style == TextStyle::Lead   ? kLead
                          : paragraph.style == TextStyle::Note ? kNote
                                                               : kBody;
        const auto lines = lines_of(paragraph.text, type, kTextWidthMm);
        need(std::min<double>(3.0, static_cast<double>(lines.size())) * type.line_mm());
        set_lines(lines, type, kLeft);
        y_ += 2.0;
    }

    void set_block(const List& list) {
        int number = 0;
        for (const std::string& item : list.items) {
            const double indent = list.bullet == Bullet::Number ? 6.5 : 5.0;
            const auto lines = lines_of(item, kBody, kTextWidthMm - indent);
            need(std::min<double>(3.0, static_cast<double>(lines.size())) * kBody.line_mm());
            const Point at(kLeft, base_of(y_, kBody));
            ++number;
            if (list.bullet == Bullet::TickBox) {
                tick_box(kBody, kLeft, y_);
            } else {
                set_line(
                    list.bullet == Bullet::Number ? fmt::format("{}.", number) : "\xe2\x80\xa2",
                    kBody, at, Anchor::Start);
            }
            set_lines(lines, kBody, kLeft + indent);
            y_ += 0.8;
        }
        y_ += 1.5;
    }

    struct SetRow {
        std::vector<std::vector<std::string>> cells;  // Lines of each.
        double height_mm = 0.0;
    };

    static std::vector<double> widths_of(const Table& table, double width_mm) {
        double shares = 0.0;
        for (const Column& column : table.columns) {
            shares += column.share;
        }
        const double gaps = kCellGap * static_cast<double>(table.columns.size() - 1);
        std::vector<double> widths;
        for (const Column& column : table.columns) {
            widths.push_back(std::max(4.0, (width_mm - gaps) * column.share / shares));
        }
        return widths;
    }

    static double indent_of(const Cell& cell) {
        const double side = 1.33 * kCellType.size_mm();
        return (cell.tick_box ? side : 0.0) + (cell.swatch ? side : 0.0);
    }

    SetRow laid_out(const std::vector<Cell>& row, const std::vector<double>& widths) const {
        SetRow result;
        result.height_mm = kCellType.line_mm();
        for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i) {
            std::vector<std::string> lines;
            double height = 0.0;
            if (row[i].picture) {
                height = document_.shared.at(*row[i].picture).height_mm + 1.0;
            }
            if (!row[i].text.empty() || !row[i].picture) {
                lines = lines_of(row[i].text, kCellType, widths[i] - indent_of(row[i]));
                height += static_cast<double>(lines.size()) * kCellType.line_mm();
            }
            result.cells.push_back(std::move(lines));
            result.height_mm = std::max(result.height_mm, height);
        }
        result.height_mm += 0.9;
        return result;
    }

    // How many rows go into each run of the given height, from `first` on.
    static std::vector<std::size_t> fill_runs(const std::vector<SetRow>& rows,
                                              std::size_t first,
                                              std::size_t runs,
                                              double height_mm) {
        std::vector<std::size_t> counts;
        for (std::size_t run = 0; run < runs; ++run) {
            double used = 0.0;
            std::size_t count = 0;
            while (first < rows.size() &&
                   (used + rows[first].height_mm <= height_mm || (run == 0 && count == 0))) {
                used += rows[first++].height_mm;
                ++count;
            }
            counts.push_back(count);
        }
        return counts;
    }

    void set_block(const Table& table) {
        if (table.columns.empty() || table.rows.empty()) {
            return;
        }
        const auto runs = static_cast<std::size_t>(std::max(1, table.abreast));
        const double width =
            (kTextWidthMm - kTableGap * static_cast<double>(runs - 1)) / static_cast<double>(runs);
        const std::vector<double> widths = widths_of(table, width);
        std::vector<SetRow> rows;
        for (const std::vector<Cell>& row : table.rows) {
            rows.push_back(laid_out(row, widths));
        }
        const bool titled = std::any_of(table.columns.begin(), table.columns.end(),
                                        [](const Column& c) { return !c.title.empty(); });
        const double head = titled ? kColumnTitle.line_mm() + 1.2 : 0.0;
        for (std::size_t first = 0; first < rows.size();) {
            need(head + 3.0 * rows[first].height_mm);
            const double room = kBottom - y_ - head;
            const double total =
                std::accumulate(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), 0.0,
                                [](double sum, const SetRow& row) { return sum + row.height_mm; });
            // The lowest runs that hold all that is left, or full pages of it.
            double height = total / static_cast<double>(runs);
            std::vector<std::size_t> counts = fill_runs(rows, first, runs, std::min(height, room));
            const auto all_fit = [&] {
                return std::accumulate(counts.begin(), counts.end(), first) >= rows.size();
            };
            while (!all_fit() && height < room) {
                height += kCellType.line_mm();
                counts = fill_runs(rows, first, runs, std::min(height, room));
            }
            double lowest = y_;
            for (std::size_t run = 0; run < runs && counts[run] > 0; ++run) {
                const double x = kLeft + static_cast<double>(run) * (width + kTableGap);
                lowest = std::max(lowest, set_run({table, rows, widths}, first, counts[run], x));
                first += counts[run];
            }
            y_ = lowest;
        }
        y_ += 3.0;
    }

    struct TableParts {
        const Table& table;
        const std::vector<SetRow>& rows;
        const std::vector<double>& widths;
    };

    double set_run(const TableParts& parts, std::size_t first, std::size_t count, double x) {
        double y = y_;
        const double width = std::accumulate(parts.widths.begin(), parts.widths.end(), 0.0) +
                             kCellGap * static_cast<double>(parts.widths.size() - 1);
        if (std::any_of(parts.table.columns.begin(), parts.table.columns.end(),
                        [](const Column& c) { return !c.title.empty(); })) {
            double left = x;
            for (std::size_t i = 0; i < parts.widths.size(); ++i) {
                const Column& column = parts.table.columns[i];
                const bool right = column.align == Align::Right;
                set_line(column.title, kColumnTitle,
                         {left + (right ? parts.widths[i] : 0.0), base_of(y, kColumnTitle)},
                         right ? Anchor::End : Anchor::Start);
                left += parts.widths[i] + kCellGap;
            }
            y += kColumnTitle.line_mm() + 0.6;
            rule({x, y}, width, {kInk, 0.3, false});
            y += 0.6;
        }
        for (std::size_t row = first; row < first + count; ++row) {
            set_row(parts, row, {x, y});
            y += parts.rows[row].height_mm;
            rule({x, y - 0.3}, width, {kHair, 0.15, false});
        }
        return y;
    }

    void set_row(const TableParts& parts, std::size_t row, const Point& corner) {
        double left = corner.x();
        for (std::size_t i = 0; i < parts.rows[row].cells.size(); ++i) {
            const Cell& cell = parts.table.rows[row][i];
            const bool right = parts.table.columns[i].align == Align::Right;
            double x = left;
            if (cell.tick_box) {
                x += tick_box(kCellType, x, corner.y());
            }
            if (cell.swatch) {
                const double side = 0.78 * kCellType.size_mm();
                box({x, base_of(corner.y(), kCellType) - side}, side, cell.swatch);
                x += side + 0.55 * kCellType.size_mm();
            }
            double y = corner.y();
            if (cell.picture) {
                const Drawing& picture = document_.shared.at(*cell.picture);
                draw_shapes(picture, {left, y + 0.5});
                y += picture.height_mm + 1.0;
            }
            for (const std::string& line : parts.rows[row].cells[i]) {
                set_line(line, kCellType,
                         {right ? left + parts.widths[i] : x, base_of(y, kCellType)},
                         right ? Anchor::End : Anchor::Start);
                y += kCellType.line_mm();
            }
            left += parts.widths[i] + kCellGap;
        }
    }

    // Rows of drawings side by side: how many in each, and how high it is.
    struct DrawingRow {
        std::size_t count = 0;
        double height_mm = 0.0;
    };

    static std::vector<DrawingRow> rows_of(const Figure& figure) {
        std::vector<DrawingRow> rows;
        double x = 0.0;
        for (const Drawing& drawing : figure.drawings) {
            if (rows.empty() || x + drawing.width_mm > kTextWidthMm + 0.01) {
                rows.emplace_back();
                x = 0.0;
            }
            ++rows.back().count;
            rows.back().height_mm = std::max(rows.back().height_mm, drawing.height_mm);
            x += drawing.width_mm + kDrawingGap;
        }
        return rows;
    }

    double height_of(const Figure& figure) const {
        double height = figure.drawings.empty() ? 0.0 : 2.0;
        for (const DrawingRow& row : rows_of(figure)) {
            height += row.height_mm + kDrawingGap;
        }
        if (!figure.caption.empty()) {
            const auto lines = lines_of(figure.caption, kNote, kTextWidthMm);
            height += static_cast<double>(lines.size()) * kNote.line_mm();
        }
        return height;
    }

    void draw_shapes(const Drawing& drawing, const Point& corner) {
        for (const Shape& shape : drawing.shapes) {
            if (const auto* label = std::get_if<Label>(&shape)) {
                canvas_.draw(*label, corner);
            } else if (const auto* paths = std::get_if<Paths>(&shape)) {
                canvas_.draw(*paths, corner);
            } else {
                draw_shapes(document_.shared.at(std::get<Use>(shape).shared), corner);
            }
        }
    }

    void set_block(const Figure& figure) {
        if (figure.drawings.empty()) {
            return;
        }
        need(std::min(height_of(figure), kBottom - kTop));
        y_ += 1.0;
        std::size_t drawing = 0;
        for (const DrawingRow& row : rows_of(figure)) {
            need(row.height_mm);
            double x = kLeft;
            for (std::size_t i = 0; i < row.count; ++i, ++drawing) {
                draw_shapes(figure.drawings[drawing], {x, y_});
                x += figure.drawings[drawing].width_mm + kDrawingGap;
            }
            y_ += row.height_mm + kDrawingGap;
        }
        if (!figure.caption.empty()) {
            set_lines(lines_of(figure.caption, kNote, kTextWidthMm), kNote, kLeft);
        }
        y_ += 1.0;
    }

    static constexpr double kStepAir = 2.2;

    double height_of(const Step& step) const {
        double height = 2.0 * kStepAir;
        height += static_cast<double>(lines_of(step.title, kStepTitle, kTextWidthMm - 6.0).size()) *
                  kStepTitle.line_mm();
        for (const std::string& text : step.texts) {
            height +=
                static_cast<double>(lines_of(text, kBody, kTextWidthMm).size()) * kBody.line_mm() +
                0.6;
        }
        return height + height_of(step.figure);
    }

    void set_block(const Step& step) {
        const double height = height_of(step);
        if (height < kBottom - kTop) {
            need(height);
        } else if (y_ > kTop) {
            add_page();
        }
        if (y_ > kTop) {
            rule({kLeft, y_}, kTextWidthMm, {kHair, 0.2, false});
        }
        y_ += kStepAir;
        const double indent = tick_box(kStepTitle, kLeft, y_);
        set_lines(lines_of(step.title, kStepTitle, kTextWidthMm - indent), kStepTitle,
                  kLeft + indent);
        for (const std::string& text : step.texts) {
            set_lines(lines_of(text, kBody, kTextWidthMm), kBody, kLeft);
            y_ += 0.6;
        }
        set_block(step.figure);
    }

    void number_pages() {
        for (int page = 0; page < pages_; ++page) {
            canvas_.select_page(page);
            set_line(fmt::format("{} / {}", page + 1, pages_), kRunning,
                     {kLeft + kTextWidthMm, kPageHeightMm - 10.0}, Anchor::End);
            if (page > 0) {
                const auto lines = lines_of(document_.subtitle, kRunning, kTextWidthMm);
                set_line(lines.front(), kRunning, {kLeft, 12.0}, Anchor::Start);
                rule({kLeft, 14.0}, kTextWidthMm, {kHair, 0.2, false});
            }
        }
    }

    const Document& document_;
    Canvas& canvas_;
    std::size_t next_ = 0;  // The block behind the one that is set.
    double y_ = kTop;
    int pages_ = 0;
};

}  // namespace

int set_pages(const Document& document, Canvas& canvas) {
    return Pager(document, canvas).set();
}

}  // namespace leafcutter::fab::guide
