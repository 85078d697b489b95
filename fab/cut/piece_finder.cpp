#include "fab/cut/piece_finder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "fab/cut/certificate_facts.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Shapes whose measures differ by more than this are not tried on each other.
constexpr double kLikeMm = 0.05;

std::size_t index(Family family) {
    return family == Family::Weft ? 0 : 1;
}

bool is_digit(char letter) {
    return letter >= '0' && letter <= '9';
}

// "W12.1" at the start of `text`, or nothing.
std::string_view leading_id(std::string_view text) {
    std::size_t at = 0;
    const auto digits = [&] {
        const std::size_t first = at;
        while (at < text.size() && is_digit(text[at])) {
            ++at;
        }
        return at > first;
    };
    if (text.empty() || (text.front() != 'W' && text.front() != 'P')) {
        return {};
    }
    at = 1;
    if (!digits() || at >= text.size() || text[at] != '.') {
        return {};
    }
    ++at;
    return digits() ? text.substr(0, at) : std::string_view{};
}

// A motion that takes the text as read to the mark as planned.
RigidMotion motion_of(const ReadText& read, const Mark& mark) {
    RigidMotion motion;
    motion.angle_rad = (mark.angle_deg - read.angle_deg) * std::numbers::pi / 180.0;
    motion.shift = mark.at - motion.apply(read.at);
    return motion;
}

std::vector<RigidMotion> starts_by_text(const std::vector<ReadText>& texts, const Piece& piece) {
    std::vector<RigidMotion> starts;
    for (const ReadText& text : texts) {
        for (const Mark& mark : piece.marks) {
            if (mark.text == text.text) {
                starts.push_back(motion_of(text, mark));
            }
        }
    }
    // Marks of the same words are taken for each other but once; the longest text is the surest.
    constexpr std::size_t kMost = 4;
    starts.resize(std::min(starts.size(), kMost));
    return starts;
}

Ring mirrored(Ring ring) {
    for (Vector2d& point : ring) {
        point.x() = -point.x();
    }
    std::reverse(ring.begin(), ring.end());
    return ring;
}

bool alike(const ShapeKey& a, const ShapeKey& b) {
    return std::abs(std::sqrt(a.area_mm2) - std::sqrt(b.area_mm2)) < kLikeMm &&
           std::abs(a.perimeter_mm - b.perimeter_mm) < 4.0 * kLikeMm &&
           std::abs(a.spread_mm - b.spread_mm) < kLikeMm;
}

}  // namespace

std::string own_id(const std::vector<ReadText>& texts) {
    struct Votes {
        int count = 0;
        double height_mm = 0.0;
    };
    std::map<std::string_view, Votes> votes;
    for (const ReadText& text : texts) {
        const std::string_view id = leading_id(text.text);
        if (!id.empty()) {
            Votes& vote = votes[id];
            ++vote.count;
            vote.height_mm = std::max(vote.height_mm, text.height_mm);
        }
    }
    std::string best;
    Votes most;
    for (const auto& [id, vote] : votes) {
        if (std::tie(vote.count, vote.height_mm) > std::tie(most.count, most.height_mm)) {
            best = id;
            most = vote;
        }
    }
    return best;
}

ReadPiece read_piece(BurntPiece burnt) {
    ReadPiece read;
    read.reading = read_texts(burnt.marks);
    read.id = own_id(read.reading.texts);
    read.burnt = std::move(burnt);
    return read;
}

PieceFinder::PieceFinder(std::span<const Piece> pieces, std::array<double, 2> kerf_mm)
    : pieces_(pieces), kerf_mm_(kerf_mm) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        by_id_.emplace(pieces[i].id, i);
        Ring burnt = as_burnt(pieces[i].outline, kerf_mm[index(pieces[i].family)]);
        if (burnt.size() < 3) {
            burnt = pieces[i].outline;
        }
        outlines_.push_back(std::move(burnt));
        keys_.push_back(shape_key(outlines_.back()));
        by_area_.push_back(i);
    }
    std::stable_sort(by_area_.begin(), by_area_.end(), [&](std::size_t a, std::size_t b) {
        return keys_[a].area_mm2 < keys_[b].area_mm2;
    });
}

std::optional<std::size_t> PieceFinder::named(const std::string& id) const {
    const auto found = by_id_.find(id);
    return found == by_id_.end() ? std::nullopt : std::optional(found->second);
}

double PieceFinder::kerf_of(std::size_t piece) const {
    return kerf_mm_[index(pieces_[piece].family)];
}

std::optional<Registration> PieceFinder::lay(const ReadPiece& read, std::size_t piece) const {
    const Ring contour = without_kerf(read.burnt.contour, kerf_of(piece));
    if (contour.size() < 3) {
        return std::nullopt;
    }
    const Ring& outline = outlines_[piece];
    const std::vector<RigidMotion> told = starts_by_text(read.reading.texts, pieces_[piece]);
    if (!told.empty()) {
        Registration by_text = lay_onto(contour, outline, told);
        if (by_text.miss_mm <= kLargestOutlineMm) {
            return by_text;
        }
    }
    return lay_onto(contour, outline, starts_by_shape(contour, outline));
}

std::optional<Registration> PieceFinder::lay_mirrored(const ReadPiece& read,
                                                      std::size_t piece) const {
    const Ring contour = mirrored(without_kerf(read.burnt.contour, kerf_of(piece)));
    if (contour.size() < 3) {
        return std::nullopt;
    }
    const Ring& outline = outlines_[piece];
    return lay_onto(contour, outline, starts_by_shape(contour, outline));
}

std::optional<FoundPiece> PieceFinder::by_shape(const ReadPiece& read,
                                                const std::vector<char>& free) const {
    std::optional<FoundPiece> best;
    for (const std::size_t family : {std::size_t{0}, std::size_t{1}}) {
        if (family == 1 && kerf_mm_[0] == kerf_mm_[1]) {
            break;
        }
        const Ring contour = without_kerf(read.burnt.contour, kerf_mm_[family]);
        if (contour.size() < 3) {
            continue;
        }
        const ShapeKey key = shape_key(contour);
        const double least = std::pow(std::max(0.0, std::sqrt(key.area_mm2) - kLikeMm), 2);
        auto at = std::lower_bound(
            by_area_.begin(), by_area_.end(), least,
            [&](std::size_t piece, double area) { return keys_[piece].area_mm2 < area; });
        const double most = std::pow(std::sqrt(key.area_mm2) + kLikeMm, 2);
        for (; at != by_area_.end() && keys_[*at].area_mm2 <= most; ++at) {
            if (free[*at] == 0 || kerf_of(*at) != kerf_mm_[family] || !alike(key, keys_[*at])) {
                continue;
            }
            const Ring& outline = outlines_[*at];
            Registration laid = lay_onto(contour, outline, starts_by_shape(contour, outline));
            if (laid.miss_mm <= kLargestOutlineMm &&
                (!best || laid.miss_mm < best->registration.miss_mm)) {
                best = FoundPiece{0, *at, false, std::move(laid)};
            }
        }
    }
    return best;
}

}  // namespace leafcutter::fab
