#include "fab/guide/step_chapters.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "fab/guide/pictures.h"
#include "fab/guide/step_text.h"
#include "fab/guide/steps.h"
#include "fab/guide/weave_diagram.h"
#include "fab/guide/wording.h"

namespace leafcutter::fab::guide {

namespace {

constexpr std::size_t kMostSteps = 120;
constexpr PictureSize kModelSize{60.0, 46.0};
constexpr PictureSize kDiagramSize{kTextWidthMm - 60.0 - 3.0, 46.0};

class StepChapters {
public:
    StepChapters(const JobIndex& index, Views& views, Document& document)
        : index_(index),
          job_(index.job()),
          document_(document),
          pictures_(job_, views, kModelSize, document.shared),
          steps_(plan_steps(index, kMostSteps)) {
        progress_.weft.assign(job_.quads.quads.size(), 0);
        progress_.warp.assign(job_.quads.quads.size(), 0);
    }

    void add() {
        if (steps_.empty()) {
            return;
        }
        add_introduction();
        bool joining = false;
        int region = -1;
        for (const PlannedStep& step : steps_) {
            const bool seam = step.kind == StepKind::Joints && step.region != step.other_region;
            if (seam && !joining) {
                joining = true;
                finish(region);
                add_seam_introduction();
            } else if (!seam && !joining && step.region != region) {
                finish(region);
                region = step.region;
                add_region(region);
            }
            add_step(step);
        }
    }

private:
    void finish(int region) {
        if (region >= 0) {
            progress_.finished.push_back(region);
        }
    }

    void add_introduction() {
        document_.blocks.emplace_back(Heading{1, "Weaving"});
        document_.blocks.emplace_back(Paragraph{
            "Tick off each step when it is done. The left picture shows the model with all that is "
            "there after the step: what is new is red, pale red where it lies underneath. The "
            "right one shows the weave laid flat and seen from outside, the new strip from left to "
            "right along its arrow.",
            TextStyle::Body});
        document_.blocks.emplace_back(Paragraph{
            "Where a strip goes under others that are there already, fold those back, lay the new "
            "one, and fold them over it again. That always works in this order; where it can't, "
            "the step says \"thread\".",
            TextStyle::Body});
        document_.blocks.emplace_back(
            Paragraph{"For a stiff object put a dot of glue between the strips at each crossing as "
                      "well, when "
                      "a region is finished and sits right.",
                      TextStyle::Body});
    }

    std::vector<int> quads_of_region(int region) const {
        std::vector<int> quads;
        for (std::size_t quad = 0; quad < job_.quads.quads.size(); ++quad) {
            if (index_.region_of(static_cast<int>(quad)) == region) {
                quads.push_back(static_cast<int>(quad));
            }
        }
        return quads;
    }

    void add_region(int region) {
        const auto number = static_cast<std::size_t>(region);
        document_.blocks.emplace_back(Heading{2, fmt::format("Region {}", region + 1)});
        std::vector<std::string> weft;
        std::vector<std::string> warp;
        for (const AssemblyMove& move : job_.assembly.moves) {
            if (move.region == region &&
                (move.kind == MoveKind::Lay || move.kind == MoveKind::Thread)) {
                const Strip& strip = job_.strips[static_cast<std::size_t>(move.strip)];
                (strip.family == Family::Weft ? weft : warp).push_back(strip.id);
            }
        }
        document_.blocks.emplace_back(Paragraph{
            fmt::format("{}. Strips: {}.", region_shape(job_, number), strips_text(weft, warp)),
            TextStyle::Body});
    }

    static std::string strips_text(std::vector<std::string> weft, std::vector<std::string> warp) {
        std::string text;
        for (std::vector<std::string>* ids : {&weft, &warp}) {
            // Numbers in order, however they are laid.
            std::sort(ids->begin(), ids->end(), [](const std::string& a, const std::string& b) {
                return a.size() != b.size() ? a.size() < b.size() : a < b;
            });
            ids->erase(std::unique(ids->begin(), ids->end()), ids->end());
            if (!ids->empty()) {
                text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", id_ranges(*ids),
                                    ids->size());
            }
        }
        return text;
    }

    void add_seam_introduction() {
        document_.blocks.emplace_back(Heading{1, "Joining the regions"});
        document_.blocks.emplace_back(Paragraph{
            "All regions are woven; now they are joined, strip by strip, along the lines where "
            "they meet. Go along each line from one end to the other. In the picture the two cells "
            "of each joint are red.",
            TextStyle::Body});
    }

    const AssemblyMove& move(int number) const {
        return job_.assembly.moves[static_cast<std::size_t>(number)];
    }

    void add_step(const PlannedStep& planned) {
        StepText text = step_text(index_, planned);
        Step step;
        step.title = fmt::format("{}  {}", ++number_, text.title);
        step.texts = std::move(text.texts);
        if (planned.kind == StepKind::TableJoints) {
            step.figure.drawings.push_back(joint_list(planned, kTextWidthMm));
        } else if (planned.kind == StepKind::Joints) {
            step.figure.drawings = {joint_picture(planned),
                                    joint_list(planned, kDiagramSize.width_mm)};
        } else {
            step.figure.drawings = weave_pictures(planned);
        }
        document_.blocks.emplace_back(std::move(step));
    }

    std::vector<Drawing> weave_pictures(const PlannedStep& planned) {
        DiagramStrips strips;
        strips.fresh = planned.strips;
        Highlight highlight;
        std::vector<int> fresh;
        for (const int number : planned.moves) {
            const AssemblyMove& one = move(number);
            if (one.kind != MoveKind::Lay && one.kind != MoveKind::Thread) {
                continue;
            }
            if (one.strip == planned.strips.front()) {
                strips.held = one.held;
            }
            lay(one, highlight);
        }
        fresh = highlight.over;
        fresh.insert(fresh.end(), highlight.under.begin(), highlight.under.end());
        const std::size_t view = pictures_.view_for(fresh);
        return {pictures_.picture(view, progress_, highlight),
                planned.kind == StepKind::Base
                    ? base_diagram(index_, planned.strips, kDiagramSize)
                    : weave_diagram(index_, progress_, strips, kDiagramSize)};
    }

    // Notes where the strip lies from now on, and on which cells it lies on top.
    void lay(const AssemblyMove& one, Highlight& highlight) {
        const Strip& strip = job_.strips[static_cast<std::size_t>(one.strip)];
        const bool weft = strip.family == Family::Weft;
        const auto put = [&](int quad) {
            const auto at = static_cast<std::size_t>(quad);
            const bool crossed = (weft ? progress_.warp : progress_.weft)[at] != 0;
            const bool on_top = (job_.weave.warp_on_top[at] != 0) != weft;
            (weft ? progress_.weft : progress_.warp)[at] = 1;
            (on_top || !crossed ? highlight.over : highlight.under).push_back(quad);
        };
        if (one.pieces.empty()) {
            std::for_each(strip.quads.begin(), strip.quads.end(), put);
        }
        for (const std::string& id : one.pieces) {
            if (const Piece* piece = index_.piece(id)) {
                const std::vector<int> quads = index_.quads_of(*piece);
                std::for_each(quads.begin(), quads.end(), put);
            }
        }
    }

    Drawing joint_picture(const PlannedStep& planned) {
        Highlight highlight;
        for (const int number : planned.moves) {
            const Piece* piece = index_.piece(move(number).piece);
            const Piece* onto = index_.piece(move(number).onto);
            if (piece != nullptr && piece->cell_count > 0) {
                highlight.over.push_back(index_.quads_of(*piece).back());
            }
            if (onto != nullptr && onto->cell_count > 0) {
                highlight.under.push_back(index_.quads_of(*onto).front());
            }
        }
        std::vector<int> quads = highlight.over;
        quads.insert(quads.end(), highlight.under.begin(), highlight.under.end());
        const std::size_t view = pictures_.view_for(quads);
        return pictures_.picture(view, progress_, highlight);
    }

    // Joints in columns, each with a box to tick.
    Drawing joint_list(const PlannedStep& planned, double width_mm) const {
        constexpr double kLine = 5.0;
        constexpr double kColumn = 38.0;
        const auto columns = static_cast<std::size_t>(width_mm / kColumn);
        const std::size_t lines = (planned.moves.size() + columns - 1) / columns;
        const double column_mm = width_mm / static_cast<double>(columns);
        Drawing drawing{width_mm, kLine * static_cast<double>(lines) + 1.0, {}, "Joints"};
        Paths boxes;
        boxes.stroke = Stroke{Colour{34, 34, 34}, 0.25, false};
        for (std::size_t i = 0; i < planned.moves.size(); ++i) {
            const AssemblyMove& joint = move(planned.moves[i]);
            const Point at(static_cast<double>(i / lines) * column_mm + 0.5,
                           kLine * static_cast<double>(i % lines + 1) - 1.0);
            const double side = 2.3;
            boxes.lines.push_back(
                {at, at + Point(side, 0.0), at + Point(side, -side), at + Point(0.0, -side)});
            Label label;
            label.text = joint_name(joint);
            if (joint.tucked > 0) {
                label.text += ", tuck";
            }
            label.at = at + Point(side + 1.4, 0.0);
            label.size_mm = 2.9;
            drawing.shapes.emplace_back(std::move(label));
        }
        drawing.shapes.emplace_back(std::move(boxes));
        return drawing;
    }

    const JobIndex& index_;
    const JobResult& job_;
    Document& document_;
    ModelPictures pictures_;
    std::vector<PlannedStep> steps_;
    Progress progress_;
    int number_ = 0;
};

const char* shape_name(geometry::ChartShape shape) {
    switch (shape) {
        case geometry::ChartShape::Rectangle:
            return "an open patch";
        case geometry::ChartShape::Annulus:
            return "a tube";
        case geometry::ChartShape::Torus:
            return "a closed ring of tube";
        case geometry::ChartShape::Pillowcase:
            break;
    }
    return "a bag, closed at both ends like a pillowcase";
}

}  // namespace

std::string region_shape(const JobResult& job, std::size_t region) {
    const AssemblyRegion& one = job.assembly.regions.at(region);
    if (one.cylinders.size() == 1) {
        const auto cylinder = static_cast<std::size_t>(one.cylinders.front());
        const geometry::CylinderGrid& grid = job.quads.grids[cylinder];
        return fmt::format("Cylinder {}: {}, {} x {}", cylinder + 1, shape_name(grid.shape),
                           counted(static_cast<std::size_t>(grid.rows), "row"),
                           counted(static_cast<std::size_t>(grid.cols), "column"));
    }
    std::string numbers;
    for (const int cylinder : one.cylinders) {
        numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", cylinder + 1);
    }
    return fmt::format("Cylinders {}, woven in one go", numbers);
}

void add_step_chapters(const JobIndex& index, Views& views, Document& document) {
    StepChapters(index, views, document).add();
}

}  // namespace leafcutter::fab::guide
