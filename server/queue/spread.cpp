#include "server/queue/spread.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

namespace leafcutter::server {

namespace {

bool fits(const SheetRecord& sheet, const CutPlace& place) {
    constexpr double kTolerance = 1e-6;
    return sheet.size_mm[0] <= place.bed_mm[0] + kTolerance &&
           sheet.size_mm[1] <= place.bed_mm[1] + kTolerance;
}

CutPlace* soonest(const SheetRecord& sheet, std::vector<CutPlace>& places) {
    CutPlace* best = nullptr;
    for (CutPlace& place : places) {
        if (fits(sheet, place) && (best == nullptr || place.busy_s < best->busy_s)) {
            best = &place;
        }
    }
    return best;
}

}  // namespace

std::vector<CutWish> spread_sheets(std::vector<SheetRecord> sheets, std::vector<CutPlace> places) {
    std::stable_sort(sheets.begin(), sheets.end(),
                     [](const auto& a, const auto& b) { return a.estimated_s > b.estimated_s; });
    std::map<std::string, std::vector<int>> parts;
    for (const SheetRecord& sheet : sheets) {
        CutPlace* place = soonest(sheet, places);
        if (place == nullptr) {
            throw NotCuttable(fmt::format("sheet {} ({} x {} mm) fits none of these machines",
                                          sheet.number, sheet.size_mm[0], sheet.size_mm[1]));
        }
        place->busy_s += sheet.estimated_s;
        parts[place->device].push_back(sheet.number);
    }
    std::vector<CutWish> wishes;
    for (const CutPlace& place : places) {
        const auto part = parts.find(place.device);
        if (part != parts.end()) {
            std::sort(part->second.begin(), part->second.end());
            wishes.push_back({place.device, std::move(part->second)});
        }
    }
    return wishes;
}

}  // namespace leafcutter::server
