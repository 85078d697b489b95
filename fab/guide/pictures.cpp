#include "fab/guide/pictures.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <tuple>

#include "fab/guide/view_drawing.h"

namespace leafcutter::fab::guide {

namespace {

constexpr Colour kWhite = {255, 255, 255};
constexpr Colour kBlack = {0, 0, 0};
constexpr Colour kEmpty = {238, 238, 238};
constexpr Colour kEmptyLine = {196, 196, 196};

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
        const std::array<std::size_t, 4> from =
            warp ? std::array<std::size_t, 4>{0, 1, 2, 3} : std::array<std::size_t, 4>{3, 0, 1, 2};
        const auto at = [&](double along, double across) -> Point {
            const Point begin = q[from[0]] + across * (q[from[1]] - q[from[0]]);
            const Point end = q[from[3]] + across * (q[from[2]] - q[from[3]]);
            return begin + along * (end - begin);
        };
        const auto band = [&](double begin, double end) {
            return std::vector<Points>{
                {at(begin, 0.05), at(begin, 0.95), at(end, 0.95), at(end, 0.05)}};
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

}  // namespace

Palette palette_of(const JobResult& job) {
    Palette palette;
    palette.weft = parsed(job.weft.colour).value_or(Colour{246, 211, 101});
    palette.warp = parsed(job.warp.colour).value_or(Colour{58, 83, 155});
    if (distance(palette.weft, palette.warp) < 2000.0) {
        palette.warp =
            mixed(palette.warp, distance(palette.warp, kBlack) < 150000.0 ? kWhite : kBlack, 0.35);
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
    Drawing drawing{
        size_.width_mm, fitted(seen, size_).height_mm, {}, "What is done so far, the new in red"};
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
