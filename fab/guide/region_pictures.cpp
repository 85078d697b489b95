#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "fab/guide/pictures.h"
#include "fab/guide/view_drawing.h"

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kWhite = {255, 255, 255};
constexpr Colour kBlack = {0, 0, 0};
constexpr Colour kInk = {40, 40, 40};
constexpr Colour kNoRegion = {238, 238, 238};

// The place of a region's number: the middle of its largest lit quads, as seen.
std::optional<Point> label_place(const View& view, const std::vector<int>& region_of, int region) {
    Point sum = Point::Zero();
    double count = 0.0;
    for (const SeenQuad& seen : view.quads) {
        if (region_of[static_cast<std::size_t>(seen.quad)] == region && seen.whole) {
            for (const Point& point : seen.areas.front()) {
                sum += point;
                count += 1.0;
            }
        }
    }
    if (count < 8.0) {
        return std::nullopt;
    }
    // The seen quad of the region that is nearest to its middle: that may itself be elsewhere.
    const Point middle = sum / count;
    Point best = middle;
    double nearest = std::numeric_limits<double>::infinity();
    for (const SeenQuad& seen : view.quads) {
        if (region_of[static_cast<std::size_t>(seen.quad)] != region || !seen.whole) {
            continue;
        }
        const Points& q = seen.areas.front();
        const Point centre = (q[0] + q[1] + q[2] + q[3]) / 4.0;
        if ((centre - middle).norm() < nearest) {
            nearest = (centre - middle).norm();
            best = centre;
        }
    }
    return best;
}

void append_badge(Drawing& drawing, const Point& at, const std::string& text) {
    const double half = 1.9 + 0.8 * static_cast<double>(text.size() - 1);
    Paths badge;
    Points ring;
    for (int i = 0; i < 24; ++i) {
        const double angle = i * std::numbers::pi / 12.0;
        ring.emplace_back(at + Point(half * std::cos(angle), 2.1 * std::sin(angle)));
    }
    badge.lines = {std::move(ring)};
    badge.fill = kWhite;
    badge.stroke = Stroke{kInk, 0.25, false};
    drawing.shapes.emplace_back(std::move(badge));
    Label label;
    label.text = text;
    label.at = at + Point(0.0, 1.0);
    label.size_mm = 2.9;
    label.anchor = Anchor::Middle;
    label.bold = true;
    drawing.shapes.emplace_back(std::move(label));
}

}  // namespace

Colour region_colour(std::size_t region) {
    constexpr std::array<Colour, 12> kColours = {
        Colour{141, 184, 222}, Colour{247, 184, 113}, Colour{150, 205, 144}, Colour{240, 150, 146},
        Colour{196, 174, 220}, Colour{205, 178, 152}, Colour{243, 187, 218}, Colour{226, 220, 118},
        Colour{140, 214, 214}, Colour{180, 180, 180}, Colour{170, 160, 240}, Colour{190, 226, 180}};
    const Colour& colour = kColours[region % kColours.size()];
    return mixed(colour, kBlack, 0.12 * static_cast<double>(region / kColours.size() % 4));
}

std::vector<int> region_of_quads(const JobResult& job) {
    std::vector<int> region_of_cylinder(job.quads.grids.size(), -1);
    for (std::size_t region = 0; region < job.assembly.regions.size(); ++region) {
        for (const int cylinder : job.assembly.regions[region].cylinders) {
            region_of_cylinder.at(static_cast<std::size_t>(cylinder)) = static_cast<int>(region);
        }
    }
    std::vector<int> regions;
    for (const geometry::QuadAddress& address : job.quads.addresses) {
        regions.push_back(region_of_cylinder[static_cast<std::size_t>(address.cylinder)]);
    }
    return regions;
}

Drawing region_picture(const JobResult& job, Views& views, std::size_t view, PictureSize size) {
    const View& seen = views.at(view);
    const Frame frame(seen, size, 2.5);
    const std::vector<int> region_of = region_of_quads(job);
    Drawing drawing{size.width_mm, size.height_mm, {}, "The regions of the model"};
    ColourGroups cells;
    for (const SeenQuad& quad : seen.quads) {
        const int region = region_of[static_cast<std::size_t>(quad.quad)];
        const Colour colour =
            region < 0 ? kNoRegion : region_colour(static_cast<std::size_t>(region));
        cells.add(lit(colour, light_level(quad.light), quad.outside), quad.areas, frame);
    }
    cells.append_to(drawing, 0.06);
    append_outline(drawing, seen, frame);
    for (std::size_t region = 0; region < job.assembly.regions.size(); ++region) {
        if (const auto place = label_place(seen, region_of, static_cast<int>(region))) {
            append_badge(drawing, frame(*place), fmt::format("{}", region + 1));
        }
    }
    return drawing;
}

std::vector<std::size_t> region_views(const JobResult& job, const Views& views, std::size_t most) {
    const std::size_t regions = std::max<std::size_t>(1, job.assembly.regions.size());
    const std::vector<int> region_of = region_of_quads(job);
    std::vector<std::vector<int>> quads(regions);
    for (std::size_t quad = 0; quad < region_of.size(); ++quad) {
        if (region_of[quad] >= 0) {
            quads[static_cast<std::size_t>(region_of[quad])].push_back(static_cast<int>(quad));
        }
    }
    // How well a region is seen counts by its share: small ones are to be found as well.
    std::vector<std::vector<double>> share(views.count(), std::vector<double>(regions, 0.0));
    std::vector<double> whole(regions, 1e-12);
    for (std::size_t region = 0; region < regions; ++region) {
        for (std::size_t view = 0; view < views.count(); ++view) {
            share[view][region] = views.seen_area(view, quads[region]);
            whole[region] = std::max(whole[region], share[view][region]);
        }
    }
    std::vector<std::size_t> chosen = {best_view(views)};
    std::vector<double> best(regions, 0.0);
    const auto gain_of = [&](std::size_t view) {
        double gain = 0.0;
        for (std::size_t region = 0; region < regions; ++region) {
            gain += std::max(0.0, share[view][region] / whole[region] - best[region]);
        }
        return gain;
    };
    while (chosen.size() < most) {
        for (std::size_t region = 0; region < regions; ++region) {
            best[region] = std::max(best[region], share[chosen.back()][region] / whole[region]);
        }
        // The second one looks at the other side in any case.
        std::size_t next = 0;
        double most_gain = -1.0;
        for (std::size_t view = 0; view < views.count(); ++view) {
            const double behind =
                -views.camera(view).to_viewer.dot(views.camera(chosen.front()).to_viewer);
            const double gain = gain_of(view) + (chosen.size() == 1 ? behind : 0.0);
            if (gain > most_gain) {
                most_gain = gain;
                next = view;
            }
        }
        if (chosen.size() >= 2 && most_gain < 0.25) {
            break;
        }
        chosen.push_back(next);
    }
    return chosen;
}

}  // namespace leafcutter::fab::guide
