#include "fab/guide/job_index.h"

#include <fmt/format.h>

#include "fab/guide/pictures.h"

namespace leafcutter::fab::guide {

namespace {

template <typename Value>
std::optional<Value> found_in(const std::map<std::string, Value>& map, const std::string& key) {
    const auto at = map.find(key);
    return at == map.end() ? std::nullopt : std::optional<Value>(at->second);
}

}  // namespace

JobIndex::JobIndex(const JobResult& job)
    : job_(job),
      weft_at_(job.quads.quads.size(), -1),
      warp_at_(job.quads.quads.size(), -1),
      region_of_(region_of_quads(job)),
      neighbours_(geometry::find_neighbours(job.quads.quads)) {
    for (const Piece& piece : job.pieces) {
        pieces_[piece.id] = &piece;
    }
    for (const Sheet& sheet : job.layout.sheets) {
        for (const Placement& placement : sheet.placements) {
            sheets_[placement.piece] = sheet.id;
        }
    }
    for (std::size_t i = 0; i < job.strips.size(); ++i) {
        const Strip& strip = job.strips[i];
        strips_[strip.id] = static_cast<int>(i);
        auto& at = strip.family == Family::Weft ? weft_at_ : warp_at_;
        for (const int quad : strip.quads) {
            at.at(static_cast<std::size_t>(quad)) = static_cast<int>(i);
        }
    }
}

const Piece* JobIndex::piece(const std::string& id) const {
    const auto at = pieces_.find(id);
    return at == pieces_.end() ? nullptr : at->second;
}

std::optional<int> JobIndex::strip(const std::string& id) const {
    return found_in(strips_, id);
}

std::optional<int> JobIndex::sheet_of(const std::string& piece) const {
    return found_in(sheets_, piece);
}

int JobIndex::strip_at(int quad, Family family) const {
    return (family == Family::Weft ? weft_at_ : warp_at_).at(static_cast<std::size_t>(quad));
}

std::vector<int> JobIndex::quads_of(const Piece& piece) const {
    std::vector<int> quads;
    const std::optional<int> number = strip(piece.strip);
    if (!number) {
        return quads;
    }
    const std::vector<int>& all = job_.strips[static_cast<std::size_t>(*number)].quads;
    for (int i = 0; i < piece.cell_count; ++i) {
        quads.push_back(all[static_cast<std::size_t>(piece.first_cell + i) % all.size()]);
    }
    return quads;
}

std::string JobIndex::place_of(int strip) const {
    const Strip& one = job_.strips[static_cast<std::size_t>(strip)];
    const geometry::QuadAddress& address =
        job_.quads.addresses[static_cast<std::size_t>(one.quads.front())];
    const geometry::CylinderGrid& grid =
        job_.quads.grids[static_cast<std::size_t>(address.cylinder)];
    return one.family == Family::Weft ? fmt::format("row {} of {}", address.row + 1, grid.rows)
                                      : fmt::format("column {} of {}", address.col + 1, grid.cols);
}

}  // namespace leafcutter::fab::guide
