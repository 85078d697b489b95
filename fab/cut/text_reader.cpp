#include "fab/cut/text_reader.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "fab/cut/stroke_lines.h"
#include "fab/point_pairs.h"
#include "fab/strips/labels.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kMissMm = 5e-3;       // An end of a line may be off by this much,
constexpr double kMissHeights = 0.01;  // and by this part of the text's height.
constexpr double kLeastHeightMm = 0.3;
constexpr double kLargestHeightMm = 100.0;
constexpr std::size_t kLeastSeedLines = 3;  // Fewer could be anything.
constexpr double kSimilarLength = 0.97;     // Of lines that may be taken for each other.

struct Template {
    char letter = ' ';
    std::vector<StrokeLine> lines;  // Capitals 1 high, from the pen's position.
    double advance = 0.0;           // To the next letter's.
    double length = 0.0;
    double longest = 0.0;
};

double advance_of(const Glyph& glyph) {
    return static_cast<double>(glyph.width + kGap) / kCapital;
}

std::vector<Template> make_templates() {
    std::vector<Template> templates;
    for (const Glyph& glyph : font()) {
        Template drawn;
        drawn.letter = glyph.letter;
        drawn.advance = advance_of(glyph);
        for (const Polyline& stroke : glyph_strokes(glyph)) {
            for (std::size_t i = 1; i < stroke.size(); ++i) {
                drawn.lines.push_back({stroke[i - 1] / kCapital, stroke[i] / kCapital});
                drawn.length += drawn.lines.back().length();
                drawn.longest = std::max(drawn.longest, drawn.lines.back().length());
            }
        }
        if (!drawn.lines.empty()) {
            templates.push_back(std::move(drawn));
        }
    }
    // The richest letter first: what is found of it leaves nothing for a poorer one inside it.
    std::stable_sort(templates.begin(), templates.end(), [](const Template& a, const Template& b) {
        return a.lines.size() > b.lines.size() ||
               (a.lines.size() == b.lines.size() && a.length > b.length);
    });
    return templates;
}

const std::vector<Template>& templates() {
    static const std::vector<Template> made = make_templates();
    return made;
}

double blank_advance() {
    const std::span<const Glyph> glyphs = font();
    const auto blank = std::find_if(glyphs.begin(), glyphs.end(),
                                    [](const Glyph& glyph) { return glyph.letter == ' '; });
    return blank == glyphs.end() ? 0.5 : advance_of(*blank);
}

// A similarity without mirroring: (x, y) of the font to at + x along + y up.
struct TextPose {
    Vector2d at = Vector2d::Zero();
    Vector2d along = Vector2d::UnitX();  // As long as capitals are high.

    Vector2d up() const { return {-along.y(), along.x()}; }
    Vector2d apply(const Vector2d& point) const {
        return at + point.x() * along + point.y() * up();
    }
    double height() const { return along.norm(); }
    double miss() const { return kMissMm + kMissHeights * height(); }
};

// The pose that takes `line` of the font to `burnt`.
TextPose pose_of(const StrokeLine& line, const StrokeLine& burnt) {
    const Vector2d d = line.to - line.from;
    const Vector2d e = burnt.to - burnt.from;
    TextPose pose;
    // Division of complex numbers.
    pose.along =
        Vector2d(e.x() * d.x() + e.y() * d.y(), e.y() * d.x() - e.x() * d.y()) / d.squaredNorm();
    pose.at = burnt.from - (pose.apply(line.from) - pose.at);
    return pose;
}

// The pose that takes points of the font to burnt ones.
TextPose pose_of(const PointPairs& pairs) {
    TextPose pose;
    pose.along = pairs.products() / pairs.from_squares();
    pose.at = pairs.to() - (pose.apply(pairs.from()) - pose.at);
    return pose;
}

// A text as it is being read.
struct Candidate {
    std::string text;
    double left = 0.0;   // Pen positions, in the font's units, from the seed's.
    double right = 0.0;  // Behind the last letter and its gap.
    PointPairs fit;
    std::vector<std::size_t> lines;
};

class Reader {
public:
    explicit Reader(std::span<const BurntSegment> burnt) : burnt_(burnt) {
        lines_.reserve(burnt.size());
        for (const BurntSegment& segment : burnt) {
            lines_.push_back({segment.from, segment.to});
        }
        index_.emplace(lines_);
        used_.assign(lines_.size(), 0);
    }

    Reading read() {
        std::vector<Candidate> candidates;
        for (const std::vector<std::size_t>& group : connected(lines_)) {
            add_candidates(group, candidates);
        }
        std::stable_sort(
            candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.lines.size() > b.lines.size(); });
        Reading reading;
        std::vector<std::pair<std::size_t, ReadText>> found;
        for (const Candidate& candidate : candidates) {
            if (std::any_of(candidate.lines.begin(), candidate.lines.end(),
                            [&](std::size_t line) { return used_[line] != 0; })) {
                continue;
            }
            for (const std::size_t line : candidate.lines) {
                used_[line] = 1;
            }
            found.emplace_back(*std::min_element(candidate.lines.begin(), candidate.lines.end()),
                               text_of(candidate));
        }
        std::sort(found.begin(), found.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        for (auto& [line, text] : found) {
            reading.texts.push_back(std::move(text));
        }
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            if (used_[i] == 0) {
                reading.rest.push_back(burnt_[i]);
            }
        }
        return reading;
    }

private:
    static ReadText text_of(const Candidate& candidate) {
        const TextPose pose = pose_of(candidate.fit);
        ReadText text;
        text.text = candidate.text;
        text.at = pose.apply({candidate.left, 0.0});
        text.angle_deg = std::atan2(pose.along.y(), pose.along.x()) * 180.0 / std::numbers::pi;
        text.height_mm = pose.height();
        return text;
    }

    // Every letter that the group is, in every pose.
    void add_candidates(const std::vector<std::size_t>& group,
                        std::vector<Candidate>& candidates) const {
        if (group.size() < kLeastSeedLines) {
            return;
        }
        std::size_t longest = group.front();
        for (const std::size_t line : group) {
            if (lines_[line].length() > lines_[longest].length()) {
                longest = line;
            }
        }
        const StrokeLine& burnt = lines_[longest];
        for (const Template& glyph : templates()) {
            if (glyph.lines.size() != group.size()) {
                continue;
            }
            for (const StrokeLine& line : glyph.lines) {
                if (line.length() < kSimilarLength * glyph.longest) {
                    continue;
                }
                add_candidate(glyph, pose_of(line, burnt), candidates);
                add_candidate(glyph, pose_of({line.to, line.from}, burnt), candidates);
            }
        }
    }

    void add_candidate(const Template& glyph,
                       const TextPose& pose,
                       std::vector<Candidate>& candidates) const {
        if (pose.height() < kLeastHeightMm || pose.height() > kLargestHeightMm) {
            return;
        }
        Candidate candidate;
        if (!add_letter(glyph, {pose, 0.0}, candidate)) {
            return;
        }
        candidate.text = glyph.letter;
        candidate.right = glyph.advance;
        while (grow_right(candidate) || grow_left(candidate)) {
        }
        candidates.push_back(std::move(candidate));
    }

    struct Pen {
        TextPose pose;
        double x = 0.0;
    };

    // Adds the lines of `glyph` at the pen's position, if all are there.
    bool add_letter(const Template& glyph, const Pen& pen, Candidate& candidate) const {
        std::vector<LineIndex::Hit> hits;
        for (const StrokeLine& line : glyph.lines) {
            const Vector2d shift(pen.x, 0.0);
            const StrokeLine wanted{pen.pose.apply(line.from + shift),
                                    pen.pose.apply(line.to + shift)};
            const auto hit = index_->find(wanted, pen.pose.miss());
            if (!hit || std::find(candidate.lines.begin(), candidate.lines.end(), hit->line) !=
                            candidate.lines.end()) {
                return false;
            }
            hits.push_back(*hit);
        }
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const StrokeLine& burnt = lines_[hits[i].line];
            const Vector2d shift(pen.x, 0.0);
            candidate.fit.add(glyph.lines[i].from + shift, hits[i].turned ? burnt.to : burnt.from);
            candidate.fit.add(glyph.lines[i].to + shift, hits[i].turned ? burnt.from : burnt.to);
            candidate.lines.push_back(hits[i].line);
        }
        return true;
    }

    bool grow_right(Candidate& candidate) const {
        for (const bool blank : {false, true}) {
            const double x = candidate.right + (blank ? blank_advance() : 0.0);
            for (const Template& glyph : templates()) {
                if (add_letter(glyph, {pose_of(candidate.fit), x}, candidate)) {
                    candidate.text =
                        fmt::format("{}{}{}", candidate.text, blank ? " " : "", glyph.letter);
                    candidate.right = x + glyph.advance;
                    return true;
                }
            }
        }
        return false;
    }

    bool grow_left(Candidate& candidate) const {
        for (const bool blank : {false, true}) {
            const double end = candidate.left - (blank ? blank_advance() : 0.0);
            for (const Template& glyph : templates()) {
                const double x = end - glyph.advance;
                if (add_letter(glyph, {pose_of(candidate.fit), x}, candidate)) {
                    candidate.text =
                        fmt::format("{}{}{}", glyph.letter, blank ? " " : "", candidate.text);
                    candidate.left = x;
                    return true;
                }
            }
        }
        return false;
    }

    std::span<const BurntSegment> burnt_;
    std::vector<StrokeLine> lines_;
    std::optional<LineIndex> index_;
    std::vector<char> used_;
};

}  // namespace

Reading read_texts(std::span<const BurntSegment> lines) {
    return Reader(lines).read();
}

}  // namespace leafcutter::fab
