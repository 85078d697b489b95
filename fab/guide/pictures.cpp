#include "fab/guide/pictures.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kWhite = {255, 255, 255};
constexpr Colour kBlack = {0, 0, 0};
constexpr Colour kOutline = {40, 40, 40};
constexpr Colour kEmpty = {238, 238, 238};
constexpr Colour kEmptyLine = {196, 196, 196};
constexpr int kLightLevels = 5;

// Fits a view into a box and centres it.
class Frame {
public:
    Frame(const View& view, PictureSize size, double margin_mm) {
        const Point extent = (view.high - view.low).cwiseMax(1e-9);
        scale_ = std::min((size.width_mm - 2.0 * margin_mm) / extent.x(),
                          (size.height_mm - 2.0 * margin_mm) / extent.y());
        offset_ = Point(size.width_mm, size.height_mm) / 2.0 -
                  scale_ * (view.low + view.high) / 2.0;
    }

    Point operator()(const Point& point) const { return scale_ * point + offset_; }

    Points operator()(const Points& line) const {
        Points mapped;
        mapped.reserve(line.size());
        for (const Point& point : line) {
            mapped.push_back((*this)(point));
        }
        return mapped;
    }

private:
    double scale_ = 1.0;
    Point offset_ = Point::Zero();
};

constexpr double kMargin = 1.0;

std::optional<Colour> parsed(const std::string& text) {
    if (text.size() != 7 || text[0] != '#') {
        return std::nullopt;
    }
    std::array<std::uint8_t, 3> parts = {};
    for (std::size_t i = 0; i < 3; ++i) {
        const char* begin = text.data() + 1 + 2 * i;
        const auto [end, error] = std::from_chars(begin, begin + 2, parts[i], 16);
        if (error != std::errc() || end != begin + 2) {
            return std::nullopt;
        }
    }
    return Colour{parts[0], parts[1], parts[2]};
}

double distance(const Colour& one, const Colour& other) {
    const double r = one.red - other.red;
    const double g = one.green - other.green;
    const double b = one.blue - other.blue;
    return 2.0 * r * r + 4.0 * g * g + 3.0 * b * b;
}

int light_level(double light) {
    return std::clamp(static_cast<int>(light * kLightLevels), 0, kLightLevels - 1);
}

// Darker for less light; what is seen from inside darker still.
Colour lit(const Colour& colour, int level, bool outside) {
    const double dark = 0.38 * (1.0 - static_cast<double>(level) / (kLightLevels - 1));
    return mixed(colour, kBlack, std::min(0.7, dark + (outside ? 0.0 : 0.3)));
}

// Areas gathered by colour, so that a picture is few paths.
class ColourGroups {
public:
    void add(const Colour& colour, const std::vector<Points>& areas, const Frame& frame) {
        std::vector<Points>& lines = groups_[{colour.red, colour.green, colour.blue}];
        for (const Points& area : areas) {
            lines.push_back(frame(area));
        }
    }

    // Each area with a thin line around it, of its own colour but darker, or of `line`.
    void append_to(Drawing& drawing, double line_mm, const std::optional<Colour>& line = {}) {
        for (auto& [key, lines] : groups_) {
            const auto& [red, green, blue] = key;
            const Colour colour{red, green, blue};
            Paths paths;
            paths.lines = std::move(lines);
            paths.fill = colour;
            paths.stroke = Stroke{line ? *line : mixed(colour, kBlack, 0.3), line_mm, false};
            drawing.shapes.emplace_back(std::move(paths));
        }
    }

private:
    std::map<std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>, std::vector<Points>> groups_;
};

void append_outline(Drawing& drawing, const View& view, const Frame& frame) {
    Paths contours;
    contours.closed = false;
    contours.stroke = Stroke{kOutline, 0.18, false};
    for (const Points& line : view.contours) {
        contours.lines.push_back(frame(line));
    }
    Paths around;
    around.stroke = Stroke{kOutline, 0.35, false};
    for (const Points& line : view.outline) {
        around.lines.push_back(frame(line));
    }
    drawing.shapes.emplace_back(std::move(contours));
    drawing.shapes.emplace_back(std::move(around));
}

// The upper strip of a cell leaves a little of the lower one free at its long sides, and is darker
// where it dives under its neighbours.
class WovenCells {
public:
    WovenCells(const JobResult& job, const Frame& frame)
        : job_(job), frame_(frame), palette_(palette_of(job)) {}

    void add(const SeenQuad& seen) {
        const bool warp = job_.weave.warp_on_top[static_cast<std::size_t>(seen.quad)] != 0;
        const int level = light_level(seen.light);
        const Colour top = lit(warp ? palette_.warp : palette_.weft, level, seen.outside);
        const Colour below = lit(warp ? palette_.weft : palette_.warp, level, seen.outside);
        if (!seen.whole) {
            ends_.add(top, seen.areas, frame_);
            return;
        }
        below_.add(mixed(below, kBlack, 0.35), seen.areas, frame_);
        // Corners a b c d: weft runs from d–a to b–c, warp from a–b to c–d.
        const Points& q = seen.areas.front();
        const std::array<std::size_t, 4> from = warp ? std::array<std::size_t, 4>{0, 1, 2, 3}
                                                     : std::array<std::size_t, 4>{3, 0, 1, 2};
        const auto at = [&](double along, double across) -> Point {
            const Point begin = q[from[0]] + across * (q[from[1]] - q[from[0]]);
            const Point end = q[from[3]] + across * (q[from[2]] - q[from[3]]);
            return begin + along * (end - begin);
        };
        const auto band = [&](double begin, double end) {
            return std::vector<Points>{{at(begin, 0.05), at(begin, 0.95), at(end, 0.95),
                                        at(end, 0.05)}};
        };
        ends_.add(mixed(top, kBlack, 0.13), band(0.0, 1.0), frame_);
        middles_.add(top, band(0.14, 0.86), frame_);
    }

    void append_to(Drawing& drawing) {
        below_.append_to(drawing, 0.05);
        ends_.append_to(drawing, 0.02);
        middles_.append_to(drawing, 0.02);
    }

private:
    const JobResult& job_;
    const Frame& frame_;
    Palette palette_;
    ColourGroups below_;
    ColourGroups ends_;
    ColourGroups middles_;
};

// The place of a region's number: the middle of its largest lit quads, as seen.
std::optional<Point> label_place(const View& view,
                                 const std::vector<int>& region_of,
                                 int region) {
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

// Fits the picture's height to what is seen.
PictureSize fitted(const View& view, PictureSize size) {
    const Point extent = (view.high - view.low).cwiseMax(1e-9);
    const double scale = std::min((size.width_mm - 2.0 * kMargin) / extent.x(),
                                  (size.height_mm - 2.0 * kMargin) / extent.y());
    return {size.width_mm, std::min(size.height_mm, scale * extent.y() + 2.0 * kMargin)};
}

void append_badge(Drawing& drawing, const Point& at, const std::string& text) {
    const double half = 1.9 + 0.8 * static_cast<double>(text.size() - 1);
    Paths badge;
    Points ring;
    for (int i = 0; i < 24; ++i) {
        const double angle = i * 3.14159265358979 / 12.0;
        ring.emplace_back(at + Point(half * std::cos(angle), 2.1 * std::sin(angle)));
    }
    badge.lines = {std::move(ring)};
    badge.fill = kWhite;
    badge.stroke = Stroke{kOutline, 0.25, false};
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

Colour mixed(const Colour& one, const Colour& other, double part_of_other) {
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround(a + part_of_other * (b - a)));
    };
    return {mix(one.red, other.red), mix(one.green, other.green), mix(one.blue, other.blue)};
}

Palette palette_of(const JobResult& job) {
    Palette palette;
    palette.weft = parsed(job.weft.colour).value_or(Colour{246, 211, 101});
    palette.warp = parsed(job.warp.colour).value_or(Colour{58, 83, 155});
    if (distance(palette.weft, palette.warp) < 2000.0) {
        palette.warp = mixed(palette.warp, distance(palette.warp, kBlack) < 150000.0 ? kWhite
                                                                                     : kBlack,
                             0.35);
    }
    constexpr std::array<Colour, 5> kAccents = {Colour{226, 48, 42}, Colour{216, 20, 130},
                                                Colour{0, 160, 70}, Colour{245, 130, 0},
                                                Colour{0, 150, 210}};
    const auto apart = [&](const Colour& colour) {
        return std::min({distance(colour, palette.weft), distance(colour, palette.warp),
                         distance(colour, kEmpty)});
    };
    palette.accent = kAccents[0];
    for (const Colour& colour : kAccents) {
        if (apart(colour) > 1.6 * apart(palette.accent)) {
            palette.accent = colour;
        }
    }
    return palette;
}

Colour region_colour(std::size_t region) {
    constexpr std::array<Colour, 12> kColours = {
        Colour{141, 184, 222}, Colour{247, 184, 113}, Colour{150, 205, 144}, Colour{240, 150, 146},
        Colour{196, 174, 220}, Colour{205, 178, 152}, Colour{243, 187, 218}, Colour{226, 220, 118},
        Colour{140, 214, 214}, Colour{180, 180, 180}, Colour{170, 160, 240}, Colour{190, 226, 180}};
    const Colour& colour = kColours[region % kColours.size()];
    return mixed(colour, kBlack, 0.12 * static_cast<double>(region / kColours.size() % 4));
}

std::size_t best_view(const Views& views) {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t view = 0; view < views.count(); ++view) {
        const double up = views.camera(view).to_viewer.y();
        const double liking = up < 0.0 ? 0.7 : up > 0.95 ? 0.8 : 1.0;
        const double area = liking * views.seen_area(view);
        if (area > 1.02 * most) {
            most = area;
            best = view;
        }
    }
    return best;
}

Drawing woven_picture(const JobResult& job, Views& views, std::size_t view, PictureSize size) {
    const View& seen = views.at(view);
    size = fitted(seen, size);
    const Frame frame(seen, size, kMargin);
    Drawing drawing{size.width_mm, size.height_mm, {}, "The finished object"};
    WovenCells cells(job, frame);
    for (const SeenQuad& quad : seen.quads) {
        cells.add(quad);
    }
    cells.append_to(drawing);
    append_outline(drawing, seen, frame);
    return drawing;
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
            region < 0 ? kEmpty : region_colour(static_cast<std::size_t>(region));
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
            best[region] =
                std::max(best[region], share[chosen.back()][region] / whole[region]);
        }
        // The second one looks at the other side in any case.
        std::size_t next = 0;
        double most_gain = -1.0;
        for (std::size_t view = 0; view < views.count(); ++view) {
            const double behind = -views.camera(view).to_viewer.dot(
                views.camera(chosen.front()).to_viewer);
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

ModelPictures::ModelPictures(const JobResult& job,
                             Views& views,
                             PictureSize size,
                             std::vector<Drawing>& shared)
    : job_(job),
      views_(views),
      size_(size),
      shared_(shared),
      palette_(palette_of(job)),
      region_of_(region_of_quads(job)),
      last_view_(best_view(views)) {}

std::size_t ModelPictures::view_for(const std::vector<int>& quads) {
    // Sides from where much of the model is seen are easier to recognise, and those from above.
    const double whole = std::max(1e-12, views_.seen_area(best_view(views_)));
    const auto worth = [&](std::size_t view) {
        const double liking = std::min(1.0, views_.seen_area(view) / whole);
        const double below = views_.camera(view).to_viewer.y() < 0.0 ? 0.8 : 1.0;
        return below * liking * liking * views_.seen_area(view, quads);
    };
    std::size_t best = last_view_;
    double most = 1.35 * worth(last_view_);
    for (std::size_t view = 0; view < views_.count(); ++view) {
        const double area = worth(view);
        if (area > most) {
            most = area;
            best = view;
        }
    }
    last_view_ = best;
    return best;
}

std::size_t ModelPictures::add_shared(Drawing drawing) {
    drawing.width_mm = size_.width_mm;
    drawing.height_mm = size_.height_mm;
    shared_.push_back(std::move(drawing));
    return shared_.size() - 1;
}

std::size_t ModelPictures::base(std::size_t view) {
    const auto [at, is_new] = known_.try_emplace({view, -2}, 0);
    if (is_new) {
        const View& seen = views_.at(view);
        const Frame frame(seen, fitted(seen, size_), kMargin);
        ColourGroups cells;
        for (const SeenQuad& quad : seen.quads) {
            const int level = std::max(2, light_level(quad.light));
            cells.add(lit(kEmpty, level, quad.outside), quad.areas, frame);
        }
        Drawing drawing;
        cells.append_to(drawing, 0.06, kEmptyLine);
        at->second = add_shared(std::move(drawing));
    }
    return at->second;
}

std::size_t ModelPictures::outline(std::size_t view) {
    const auto [at, is_new] = known_.try_emplace({view, -1}, 0);
    if (is_new) {
        const View& seen = views_.at(view);
        Drawing drawing;
        append_outline(drawing, seen, Frame(seen, fitted(seen, size_), kMargin));
        at->second = add_shared(std::move(drawing));
    }
    return at->second;
}

std::size_t ModelPictures::finished(std::size_t view, int region) {
    const auto [at, is_new] = known_.try_emplace({view, region}, 0);
    if (is_new) {
        const View& seen = views_.at(view);
        const Frame frame(seen, fitted(seen, size_), kMargin);
        ColourGroups cells;
        for (const SeenQuad& quad : seen.quads) {
            const auto number = static_cast<std::size_t>(quad.quad);
            if (region_of_[number] == region) {
                const Colour& top =
                    job_.weave.warp_on_top[number] != 0 ? palette_.warp : palette_.weft;
                cells.add(lit(top, light_level(quad.light), quad.outside), quad.areas, frame);
            }
        }
        Drawing drawing;
        cells.append_to(drawing, 0.05);
        at->second = add_shared(std::move(drawing));
    }
    return at->second;
}

Drawing ModelPictures::picture(std::size_t view,
                               const Progress& progress,
                               const Highlight& highlight) {
    const View& seen = views_.at(view);
    const Frame frame(seen, fitted(seen, size_), kMargin);
    Drawing drawing{size_.width_mm, fitted(seen, size_).height_mm, {}, "What is done so far, the new in red"};
    drawing.shapes.emplace_back(Use{base(view)});
    std::vector<bool> is_finished(job_.assembly.regions.size() + 1, false);
    for (const int region : progress.finished) {
        is_finished[static_cast<std::size_t>(region)] = true;
        drawing.shapes.emplace_back(Use{finished(view, region)});
    }
    ColourGroups cells;
    for (const SeenQuad& quad : seen.quads) {
        const auto number = static_cast<std::size_t>(quad.quad);
        const bool weft = progress.weft[number] != 0;
        const bool warp = progress.warp[number] != 0;
        const int region = region_of_[number];
        if ((!weft && !warp) || (region >= 0 && is_finished[static_cast<std::size_t>(region)])) {
            continue;
        }
        const bool warp_on_top = warp && (!weft || job_.weave.warp_on_top[number] != 0);
        const Colour& top = warp_on_top ? palette_.warp : palette_.weft;
        cells.add(lit(top, light_level(quad.light), quad.outside), quad.areas, frame);
    }
    cells.append_to(drawing, 0.05);
    ColourGroups fresh;
    const auto add_fresh = [&](const std::vector<int>& quads, const Colour& colour) {
        for (const int quad : quads) {
            const int place = seen.seen_of[static_cast<std::size_t>(quad)];
            if (place >= 0) {
                const SeenQuad& one = seen.quads[static_cast<std::size_t>(place)];
                fresh.add(lit(colour, std::max(2, light_level(one.light)), one.outside), one.areas,
                          frame);
            }
        }
    };
    add_fresh(highlight.under, mixed(palette_.accent, kWhite, 0.55));
    add_fresh(highlight.over, palette_.accent);
    fresh.append_to(drawing, 0.08);
    drawing.shapes.emplace_back(Use{outline(view)});
    return drawing;
}

}  // namespace leafcutter::fab::guide
