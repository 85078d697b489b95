#include "fab/cut/test_card.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "fab/cut/estimate.h"
#include "fab/strips/labels.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr double kMarginMm = 5.0;
constexpr double kTextMm = 2.5;

class Drawing {
public:
    void add(Operation operation,
             Polyline points,
             std::optional<LaserSettings> settings = std::nullopt) {
        CutPath path;
        path.operation = operation;
        path.points = std::move(points);
        path.settings = settings;
        paths_.push_back(std::move(path));
    }

    void rectangle(Operation operation,
                   const Eigen::Vector2d& corner,
                   const Eigen::Vector2d& size,
                   std::optional<LaserSettings> settings = std::nullopt) {
        const double x = corner.x();
        const double y = corner.y();
        const double right = x + size.x();
        const double top = y + size.y();
        add(operation, {{x, y}, {right, y}, {right, top}, {x, top}, {x, y}}, settings);
    }

    void line(Operation operation, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
        add(operation, {from, to});
    }

    // Its base line begins at `at`.
    void text(std::string_view words, const Eigen::Vector2d& at) {
        for (Polyline stroke : text_strokes(words)) {
            for (Eigen::Vector2d& point : stroke) {
                point = at + kTextMm * point;
            }
            add(Operation::Engrave, std::move(stroke));
        }
    }

    std::vector<CutPath> take() { return std::move(paths_); }

private:
    std::vector<CutPath> paths_;
};

double width_of(std::string_view words) {
    return kTextMm * text_width(words);
}

// How far the last cell's right edge lies from the window's nominal end, in kerfs: a half at the
// window's left end, and one for every cell that became narrower.
double kerfs_of_gap(const KerfCard& card) {
    return card.cells + 0.5;
}

// Ticks of 0.05 mm, the longer ones of 0.1 mm and the longest of 0.5 mm.
void draw_ruler(const KerfCard& card, double end_x, double y, Drawing& drawing) {
    constexpr double kStepMm = 0.05;
    const int steps = static_cast<int>(std::floor(card.largest_kerf_mm / kStepMm + 1e-9));
    for (int i = 0; i <= steps; ++i) {
        const double x = end_x - kerfs_of_gap(card) * kStepMm * i;
        const double length = i % 10 == 0 ? 4.0 : (i % 2 == 0 ? 2.5 : 1.5);
        drawing.line(Operation::Engrave, {x, y}, {x, y - length});
        if (i % 10 == 0) {
            const std::string label = fmt::format("{:g}", kStepMm * i);
            drawing.text(label, {x - width_of(label) / 2.0, y - length - 1.0 - kTextMm});
        }
    }
}

SheetSize draw(const KerfCard& card, const Material& material, Drawing& drawing) {
    constexpr double kRulerMm = 9.0;
    constexpr double kClearMm = 1.0;  // Of the ruler from the window.
    const double length = card.cells * card.cell_mm;
    const Eigen::Vector2d corner(kMarginMm, kMarginMm + kRulerMm);
    const double top = corner.y() + card.cell_mm;
    const std::string title = fmt::format("KERF {}", material.id);
    drawing.text(title, {kMarginMm, top + 2.0});
    draw_ruler(card, corner.x() + length, corner.y() - kClearMm, drawing);
    for (int i = 1; i < card.cells; ++i) {
        const double x = corner.x() + i * card.cell_mm;
        // Up and down in turns: the way to the next line is short.
        const double from = i % 2 == 1 ? corner.y() : top;
        drawing.line(Operation::Cut, {x, from}, {x, corner.y() + top - from});
    }
    drawing.rectangle(Operation::Cut, corner, {length, card.cell_mm});
    return {std::max(length, width_of(title)) + 2.0 * kMarginMm, top + 2.0 + kTextMm + kMarginMm};
}

double step_of(const std::array<double, 2>& range, int index, int count) {
    return count == 1 ? range[0] : range[0] + (range[1] - range[0]) * index / (count - 1);
}

void draw_cell(const PowerCard& card,
               const Eigen::Vector2d& corner,
               const LaserSettings& settings,
               Drawing& drawing) {
    const Eigen::Vector2d size(card.cell_mm, card.cell_mm);
    if (card.operation == Operation::Cut) {
        drawing.rectangle(card.operation, corner, size, settings);
        return;
    }
    if (card.operation == Operation::Score) {
        drawing.rectangle(card.operation, corner, size, settings);
        drawing.add(card.operation, {corner, corner + size}, settings);
        return;
    }
    constexpr double kHatchMm = 0.2;
    const int lines = static_cast<int>(card.cell_mm / kHatchMm);
    Polyline hatch;
    for (int i = 0; i <= lines; ++i) {
        const double y = corner.y() + kHatchMm * i;
        const double left = corner.x();
        const double right = left + card.cell_mm;
        hatch.emplace_back(i % 2 == 0 ? left : right, y);
        hatch.emplace_back(i % 2 == 0 ? right : left, y);
    }
    drawing.add(card.operation, std::move(hatch), settings);
}

SheetSize draw(const PowerCard& card, const Material& material, Drawing& drawing) {
    constexpr double kGapMm = 4.0;
    double labels = 0.0;
    for (int row = 0; row < card.feeds; ++row) {
        const double feed = step_of(card.feed_mm_per_min, row, card.feeds);
        labels = std::max(labels, width_of(fmt::format("F{:.0f}", feed)));
    }
    const Eigen::Vector2d corner(kMarginMm + labels + 2.0, kMarginMm + kTextMm + 2.0);
    const double pitch = card.cell_mm + kGapMm;
    const double top = corner.y() + card.feeds * pitch;
    static constexpr const char* kNames[] = {"ENGRAVE", "SCORE", "CUT"};
    const std::string title = fmt::format(
        "{} {} X{}", kNames[static_cast<std::size_t>(card.operation)], material.id, card.passes);
    drawing.text(title, {kMarginMm, top});
    for (int column = 0; column < card.powers; ++column) {
        const std::string label =
            fmt::format("{:.0f}", step_of(card.power_percent, column, card.powers));
        drawing.text(label, {corner.x() + column * pitch, kMarginMm});
    }
    for (int row = 0; row < card.feeds; ++row) {
        drawing.text(fmt::format("F{:.0f}", step_of(card.feed_mm_per_min, row, card.feeds)),
                     {kMarginMm, corner.y() + row * pitch + (card.cell_mm - kTextMm) / 2.0});
    }
    for (int row = 0; row < card.feeds; ++row) {
        for (int column = 0; column < card.powers; ++column) {
            const LaserSettings settings{step_of(card.power_percent, column, card.powers),
                                         step_of(card.feed_mm_per_min, row, card.feeds),
                                         card.passes};
            draw_cell(card, corner + Eigen::Vector2d(column * pitch, row * pitch), settings,
                      drawing);
        }
    }
    const double right = corner.x() + card.powers * pitch - kGapMm;
    return {std::max(right, kMarginMm + width_of(title)) + kMarginMm, top + kTextMm + kMarginMm};
}

void check_fits(const SheetSize& size, const Material& material) {
    const auto fits = [&size](const StockSheet& sheet) {
        return size.width_mm <= sheet.size.width_mm && size.height_mm <= sheet.size.height_mm;
    };
    if (!material.sheets.empty() &&
        std::none_of(material.sheets.begin(), material.sheets.end(), fits)) {
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "too-large",
            fmt::format("cell_mm: the card has {:.0f} x {:.0f} mm and fits on no sheet of {}; "
                        "make the cells smaller or fewer",
                        size.width_mm, size.height_mm, material.id));
    }
}

}  // namespace

CutProgram plan_test_card(const TestCard& card,
                          const Material& material,
                          const MachineProfile& machine) {
    Drawing drawing;
    CutProgram program;
    program.job = "test card";
    program.material = material.id;
    program.cut = material.cut;
    program.score = material.score;
    program.engrave = material.engrave;
    program.size =
        std::visit([&](const auto& each) { return draw(each, material, drawing); }, card);
    check_fits(program.size, material);
    program.paths = drawing.take();
    const CutEstimate estimate = estimate_cut(program, machine);
    program.burn_mm = estimate.burn_mm;
    program.travel_mm = estimate.travel_mm;
    program.estimated_s = estimate.seconds;
    return program;
}

std::string reading_of(const TestCard& card) {
    if (const auto* kerf = std::get_if<KerfCard>(&card)) {
        return fmt::format(
            "Push all {} cells to the left end of the window. The tick under the right edge of the "
            "last one is the kerf; ticks are 0.05 mm apart. Or measure the gap at the right end "
            "and divide it by {}.",
            kerf->cells, kerf->cells + 1);
    }
    return "Power grows to the right (percent), feed upwards (F, mm/min). Take the fastest cell "
           "that came out clean, at the least power that does it.";
}

}  // namespace leafcutter::fab
