#include "fab/strips/link.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "fab/strips/overlap.h"
#include "fab/strips/tabs.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Sheets thicker than this don't give: their slits are as wide as they are thick.
constexpr double kStiffMm = 0.5;

// Of a slit of its width at the given place along a piece the way of the beam, which leaves kerf:
// a line, or round a slot where the material is stiff.
Polyline slit_path(const Piece& piece, const Tab& tab, const PieceLimits& limits) {
    const Band body{piece.cut_left, piece.cut_right};
    const Band before = cut_off(body, tab.slit_at_mm);
    const std::size_t last = before.rungs() - 1;
    const Vector2d middle = before.middle(last);
    const Vector2d across = (before.left[last] - before.right[last]).stableNormalized();
    const Vector2d half = across * std::max(0.05, (tab.slit_width_mm - limits.kerf_mm) / 2.0);
    const double open_mm =
        limits.thickness_mm > kStiffMm ? limits.thickness_mm - limits.kerf_mm : 0.0;
    if (open_mm <= 0.0) {
        return {middle + half, middle - half};
    }
    const Vector2d thick = Vector2d(across.y(), -across.x()) * open_mm / 2.0;
    return {middle + half - thick, middle - half - thick, middle - half + thick,
            middle + half + thick, middle + half - thick};
}

class Linker {
public:
    Linker(std::span<const Strip> strips, std::span<Piece> pieces) {
        for (const Strip& strip : strips) {
            strips_.emplace(strip.id, &strip);
            if (!strip.next.empty()) {
                before_.emplace(strip.next, &strip);
            }
        }
        for (Piece& piece : pieces) {
            pieces_.emplace(piece.id, &piece);
        }
    }

    void link(const Strip& strip) {
        const std::size_t count = strip.pieces.size();
        for (std::size_t i = 0; i < count; ++i) {
            Piece& piece = *pieces_.at(strip.pieces[i]);
            if (piece.end_tab.length_mm > 0.0 && piece.end_tab.onto.empty()) {
                piece.end_tab.onto = i + 1 < count ? strip.pieces[i + 1] : behind(strip);
            }
            if (piece.start_tab.length_mm > 0.0 && piece.start_tab.onto.empty()) {
                piece.start_tab.onto = i > 0 ? strip.pieces[i - 1] : ahead(strip);
            }
        }
    }

    // False if there is no room for the slit of this piece's arrow.
    bool cut_slit(Piece& piece, const PieceLimits& limits) {
        if (piece.end_tab.slit_width_mm <= 0.0) {
            return true;
        }
        const auto onto = pieces_.find(piece.end_tab.onto);
        if (onto == pieces_.end()) {
            return false;
        }
        Polyline slit = slit_path(*onto->second, piece.end_tab, limits);
        if (!RingInterior(onto->second->outline).contains(slit)) {
            return false;
        }
        onto->second->cuts.push_back(std::move(slit));
        return true;
    }

private:
    // The piece that an end laid straight on is glued to.
    std::string glued_to(const GluedEnd& end) const {
        const auto onto = strips_.find(end.onto);
        if (onto == strips_.end()) {
            return {};
        }
        const std::vector<std::string>& pieces = onto->second->pieces;
        return end.onto_start ? pieces.front() : pieces.back();
    }

    std::string behind(const Strip& strip) const {
        if (strip.glued_end.has_tab) {
            return glued_to(strip.glued_end);
        }
        if (strip.closed) {
            return strip.pieces.front();
        }
        const auto next = strips_.find(strip.next);
        return next == strips_.end() || next->second->pieces.empty() ? std::string()
                                                                     : next->second->pieces.front();
    }

    std::string ahead(const Strip& strip) const {
        if (strip.glued_start.has_tab) {
            return glued_to(strip.glued_start);
        }
        if (strip.closed) {
            return strip.pieces.back();
        }
        const auto before = before_.find(strip.id);
        return before == before_.end() ? std::string() : before->second->pieces.back();
    }

    std::map<std::string_view, const Strip*> strips_;
    std::map<std::string_view, const Strip*> before_;  // Whose `next` it is.
    std::map<std::string_view, Piece*> pieces_;
};

}  // namespace

void link_pieces(std::span<const Strip> strips,
                 const std::array<PieceLimits, 2>& limits,
                 std::span<Piece> pieces,
                 std::vector<std::string>& warnings) {
    Linker linker(strips, pieces);
    for (const Strip& strip : strips) {
        linker.link(strip);
    }
    for (Piece& piece : pieces) {
        if (!linker.cut_slit(piece, limits[piece.family == Family::Weft ? 0 : 1])) {
            piece.end_tab.slit_width_mm = 0.0;
            warnings.push_back(
                fmt::format("{}: no room for its slit in the next piece: glue it", piece.id));
        }
    }
}

}  // namespace leafcutter::fab
