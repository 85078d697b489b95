#include "fab/guide/content.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "fab/guide/job_index.h"
#include "fab/guide/notes_chapter.h"
#include "fab/guide/pictures.h"
#include "fab/guide/piece_picture.h"
#include "fab/guide/step_chapters.h"
#include "fab/guide/wording.h"
#include "fab/guide/work_time.h"
#include "fab/material/totals.h"
#include "fab/strips/marks.h"

namespace leafcutter::fab::guide {

namespace {

// A file's name without its ending.
std::string model_name(std::string file) {
    constexpr std::size_t kLongestEnding = 5;
    const std::size_t dot = file.find_last_of('.');
    if (dot != std::string::npos && dot > 0 && file.size() - dot <= kLongestEnding) {
        file.erase(dot);
    }
    return file.empty() ? "Woven object" : file;
}

std::string time_text(double seconds) {
    const double minutes = seconds / 60.0;
    if (minutes < 90.0) {
        return fmt::format("about {:.0f} min", std::max(5.0, 5.0 * std::ceil(minutes / 5.0)));
    }
    return fmt::format("about {:.0f} h", std::ceil(minutes / 60.0));
}

class GuideBuilder {
public:
    explicit GuideBuilder(const JobResult& job)
        : job_(job), index_(job), views_(job.quads), palette_(palette_of(job)) {
        document_.title = model_name(job.input.file);
        document_.subtitle = document_.title + " \xe2\x80\x93 assembly guide";
    }

    Document build() {
        add_cover();
        add_pieces();
        add_sheets();
        add_map();
        add_step_chapters(index_, views_, document_);
        add_notes_chapter(index_, document_);
        return std::move(document_);
    }

private:
    void add(Block block) { document_.blocks.push_back(std::move(block)); }
    void heading(int level, std::string text) { add(Heading{level, std::move(text)}); }
    void text(std::string words, TextStyle style = TextStyle::Body) {
        add(Paragraph{std::move(words), style});
    }

    void add_cover() {
        text("Assembly guide", TextStyle::Lead);
        add(Figure{{woven_picture(job_, views_, best_view(views_), {kTextWidthMm, 118.0})}, {}});
        add_facts();
        add_bill();
        add_tools();
    }

    std::string family_text(Family family) const {
        const FamilyTotals totals = total_of(job_, family);
        return fmt::format(
            "{} ({}) in {}, {:.1f} m", counted(static_cast<std::size_t>(totals.strips), "strip"),
            family == Family::Weft ? "weft, W" : "warp, P",
            counted(static_cast<std::size_t>(totals.pieces), "piece"), totals.length_mm / 1000.0);
    }

    void add_facts() {
        Eigen::Vector3d low = job_.quads.vertices.front();
        Eigen::Vector3d high = low;
        for (const Eigen::Vector3d& point : job_.quads.vertices) {
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
        }
        const Eigen::Vector3d size = (high - low) / 10.0;
        const double weight =
            total_of(job_, Family::Weft).weight_g + total_of(job_, Family::Warp).weight_g;
        const HandTimes times;
        Table table;
        table.columns = {{"", Align::Left, 1.0}, {"", Align::Left, 4.0}};
        const auto fact = [&](std::string what, std::string value,
                              std::optional<Colour> swatch = {}) {
            table.rows.push_back(
                {Cell{std::move(what), {}, false, {}}, Cell{std::move(value), swatch, false, {}}});
        };
        fact("Size", fmt::format("{:.1f} x {:.1f} x {:.1f} cm", size.x(), size.y(), size.z()));
        fact("Strips", family_text(Family::Weft), palette_.weft);
        fact("", family_text(Family::Warp), palette_.warp);
        fact("Sheets", fmt::format("{}", job_.layout.sheets.size()));
        fact("Weight", fmt::format("{:.0f} g", std::max(1.0, weight)));
        fact(
            "Your time",
            fmt::format("{}: counted as {:.0f} s for each of {} pieces, {:.0f} s for each of {} "
                        "crossings, {:.0f} s for each joint",
                        time_text(working_time_s(job_, times)), times.per_piece, job_.pieces.size(),
                        times.per_crossing, job_.quads.quads.size(), times.per_joint));
        add(std::move(table));
    }

    void add_bill() {
        if (job_.bill.lines.empty()) {
            return;
        }
        Table table;
        table.columns = {{"Material", Align::Left, 4.0}, {"Sheets", Align::Right, 1.0},
                         {"Weight", Align::Right, 1.0},  {"Cut", Align::Right, 1.0},
                         {"Machine", Align::Right, 1.2}, {"Cost", Align::Right, 1.4}};
        for (const BillLine& line : job_.bill.lines) {
            const auto cell = [](std::string words) {
                return Cell{std::move(words), {}, false, {}};
            };
            table.rows.push_back(
                {cell(line.name.empty() ? line.material : line.name),
                 cell(fmt::format("{}", line.sheets)), cell(fmt::format("{:.0f} g", line.weight_g)),
                 cell(fmt::format("{:.1f} m", line.cut_mm / 1000.0)),
                 cell(fmt::format("{:.0f} min", std::ceil(line.machine_s / 60.0))),
                 cell(line.cost > 0.0 ? fmt::format("{:.2f} {}", line.cost, line.currency) : "-")});
        }
        add(std::move(table));
    }

    void add_tools() {
        const bool slots = job_.params.fit.joint == Joint::Slot;
        List list;
        list.bullet = Bullet::TickBox;
        list.items = {
            slots ? "Tweezers, to pull tabs through their slits"
                  : "Glue that dries fast and clear: a glue pen, or white glue and a fine brush",
            slots ? "A little glue, if the object is to be stiff"
                  : "Small clips or clothes pegs, to hold a joint while it dries; tweezers",
            "Masking tape, to hold strips side by side while you begin",
            "Flat boxes or envelopes, one for each region: sort the pieces before you begin"};
        heading(2, "Have ready");
        add(std::move(list));
    }

    void add_pieces() {
        const Piece* piece = typical_piece(job_);
        if (piece == nullptr) {
            return;
        }
        heading(1, "How to read a piece");
        text(fmt::format(
            "W stands for weft, P for warp. {} is piece {} of strip {}. This is how it "
            "comes off the sheet:",
            piece->id, piece->id.substr(piece->id.find_last_of('.') + 1), piece->strip));
        ExplainedPiece explained = explain_piece(index_, *piece);
        add(Figure{{std::move(explained.drawings.front())}, "All of it"});
        add(Figure{{explained.drawings.begin() + 1, explained.drawings.end()},
                   "Left its start, right its end, enlarged"});
        List list;
        list.bullet = Bullet::Number;
        list.items = std::move(explained.legend);
        add(std::move(list));
        add_joining();
        add_legend();
    }

    // Every kind of mark, as it looks and what it tells.
    void add_legend() {
        constexpr double kHeight = 3.2;
        heading(2, "All marks");
        Table table;
        table.columns = {
            {"", Align::Left, 1.1}, {"Mark", Align::Left, 2.7}, {"Means", Align::Left, 5.2}};
        for (const LegendEntry& entry : mark_legend(job_.params.fit)) {
            Drawing drawing{1.0, kHeight + 0.6, {}, entry.symbol};
            Paths lines;
            lines.closed = false;
            lines.stroke = Stroke{Colour{34, 34, 34}, 0.25, false};
            for (const Polyline& line : entry.picture) {
                Points points;
                for (const Eigen::Vector2d& point : line) {
                    points.emplace_back(0.3 + kHeight * point.x(),
                                        0.3 + kHeight * (1.0 - point.y()));
                    drawing.width_mm = std::max(drawing.width_mm, points.back().x() + 0.3);
                }
                lines.lines.push_back(std::move(points));
            }
            drawing.shapes.emplace_back(std::move(lines));
            document_.shared.push_back(std::move(drawing));
            table.rows.push_back({Cell{{}, {}, false, document_.shared.size() - 1},
                                  Cell{entry.symbol, {}, false, {}},
                                  Cell{entry.meaning, {}, false, {}}});
        }
        add(std::move(table));
    }

    void add_joining() {
        heading(2, "Joining two pieces");
        text(job_.params.fit.joint == Joint::Slot
                 ? "The arrow at the end of a piece goes through the slit at the start of the "
                   "next, from below; it holds without glue. Edges and arrows line up."
                 : "The tab at the end of a piece goes under the start of the next one, so that "
                   "edges and arrows line up, and is glued there. A ring is a strip whose last tab "
                   "goes under its own start.");
    }

    void add_sheets() {
        if (job_.layout.sheets.empty()) {
            return;
        }
        heading(1, "Sheets");
        text("Pieces in the order in which they are cut. Sort them by region as they come off.");
        for (std::size_t i = 0; i < job_.layout.sheets.size(); ++i) {
            add_sheet(i);
        }
        if (!job_.layout.unplaced.empty()) {
            text(fmt::format("On no sheet, too large: {}.", first_of(job_.layout.unplaced, 40)));
        }
    }

    void add_sheet(std::size_t number) {
        const Sheet& sheet = job_.layout.sheets[number];
        heading(2, fmt::format("Sheet {}", sheet.id));
        const Material& material = sheet.family == "warp" ? job_.warp : job_.weft;
        std::string line =
            fmt::format("{}, {:g} x {:g} mm, {}", material.name, sheet.size.width_mm,
                        sheet.size.height_mm, counted(sheet.placements.size(), "piece"));
        if (number < job_.programs.size()) {
            line += fmt::format(", {:.0f} min on the machine",
                                std::ceil(job_.programs[number].estimated_s / 60.0));
        }
        text(line);
        // Sheets with few pieces may share a page.
        const double height_mm = sheet.placements.size() > 20 ? 165.0 : 88.0;
        add(Figure{{sheet_picture(index_, sheet, {kTextWidthMm, height_mm})}, {}});
        Table table;
        table.columns = {{"Piece", Align::Left, 2.4},
                         {"Cells", Align::Right, 1.0},
                         {"Length", Align::Right, 1.6},
                         {"Region", Align::Right, 1.3}};
        table.abreast = 3;
        for (const std::string& id : cutting_order(number)) {
            const Piece* piece = index_.piece(id);
            if (piece == nullptr) {
                continue;
            }
            table.rows.push_back(
                {Cell{id, {}, true, {}}, Cell{fmt::format("{}", piece->cell_count), {}, false, {}},
                 Cell{fmt::format("{:.0f} mm", piece_length_mm(*piece)), {}, false, {}},
                 Cell{regions_text(*piece), {}, false, {}}});
        }
        add(std::move(table));
    }

    std::vector<std::string> cutting_order(std::size_t number) const {
        std::vector<std::string> order;
        std::set<std::string> seen;
        if (number < job_.programs.size()) {
            for (const CutPath& path : job_.programs[number].paths) {
                if (path.operation == Operation::Cut && seen.insert(path.piece).second) {
                    order.push_back(path.piece);
                }
            }
        }
        for (const Placement& placement : job_.layout.sheets[number].placements) {
            if (seen.insert(placement.piece).second) {
                order.push_back(placement.piece);
            }
        }
        return order;
    }

    std::string regions_text(const Piece& piece) const {
        std::set<int> regions;
        for (const int quad : index_.quads_of(piece)) {
            regions.insert(index_.region_of(quad) + 1);
        }
        std::string words;
        for (const int region : regions) {
            words += fmt::format("{}{}", words.empty() ? "" : ", ", region);
        }
        return words;
    }

    void add_map() {
        const std::size_t regions = job_.assembly.regions.size();
        if (regions == 0) {
            return;
        }
        heading(1, "Map of the model");
        text(regions == 1 ? "The whole model is woven in one go."
                          : fmt::format("The model is woven in {} regions, one after the other in "
                                        "the order of their numbers, which are joined in the end.",
                                        regions));
        Figure figure;
        const std::size_t most = regions > 12 ? 6 : 4;
        for (const std::size_t view : region_views(job_, views_, most)) {
            figure.drawings.push_back(
                region_picture(job_, views_, view, {(kTextWidthMm - 3.0) / 2.0, 66.0}));
        }
        add(std::move(figure));
        Table table;
        table.columns = {{"Region", Align::Left, 1.0},
                         {"What it is", Align::Left, 3.4},
                         {"Weft strips", Align::Left, 3.0},
                         {"Warp strips", Align::Left, 3.0}};
        for (std::size_t region = 0; region < regions; ++region) {
            const int part = job_.assembly.regions[region].part;
            std::string shape = region_shape(job_, region);
            if (job_.parts.size() > 1) {
                shape += fmt::format(", part {}", part + 1);
            }
            table.rows.push_back(
                {Cell{fmt::format("{}", region + 1), region_colour(region), false, {}},
                 Cell{std::move(shape), {}, false, {}},
                 Cell{strips_of(region, Family::Weft), {}, false, {}},
                 Cell{strips_of(region, Family::Warp), {}, false, {}}});
        }
        add(std::move(table));
    }

    std::string strips_of(std::size_t region, Family family) const {
        std::set<int> numbers;
        for (std::size_t i = 0; i < job_.strips.size(); ++i) {
            const Strip& strip = job_.strips[i];
            if (strip.family == family &&
                std::any_of(strip.quads.begin(), strip.quads.end(), [&](int quad) {
                    return index_.region_of(quad) == static_cast<int>(region);
                })) {
                numbers.insert(static_cast<int>(i));
            }
        }
        std::vector<std::string> ids;
        for (const int number : numbers) {
            ids.push_back(job_.strips[static_cast<std::size_t>(number)].id);
        }
        return id_ranges(ids);
    }

    const JobResult& job_;
    JobIndex index_;
    Views views_;
    Palette palette_;
    Document document_;
};

}  // namespace

Document make_guide(const JobResult& job) {
    return GuideBuilder(job).build();
}

}  // namespace leafcutter::fab::guide
