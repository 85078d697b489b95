#include "server/recut.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "server/package_reader.h"

namespace leafcutter::server {

namespace {

[[noreturn]] void refuse(const char* code, const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::BadOption, code, message);
}

// Letters to insert, drop or change to get from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t corner = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t change = corner + (a[i] == b[j] ? 0 : 1);
            corner = row[j + 1];
            row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

std::string in_capitals(std::string text) {
    for (char& letter : text) {
        letter = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
    }
    return text;
}

// Resolves what users call pieces.
class PieceNames {
public:
    PieceNames(const PackageSource& source, std::string_view strips_json)
        : source_(source), strips_(read_strips(strips_json)) {
        for (const fab::Strip& strip : strips_) {
            known_.push_back(strip.id);
            for (const std::string& piece : strip.pieces) {
                known_.push_back(piece);
            }
        }
    }

    // In the order asked for, each once.
    std::vector<std::string> resolve(const std::vector<std::string>& names) const {
        std::vector<std::string> ids;
        std::set<std::string> seen;
        for (const std::string& name : names) {
            for (std::string& id : meant_by(name)) {
                if (seen.insert(id).second) {
                    ids.push_back(std::move(id));
                }
            }
        }
        return ids;
    }

private:
    std::vector<std::string> meant_by(const std::string& name) const {
        constexpr std::string_view kSheet = "sheet:";
        if (name.starts_with(kSheet)) {
            return on_sheet(name, name.substr(kSheet.size()));
        }
        std::vector<std::string> all;
        for (const fab::Strip& strip : strips_) {
            if (strip.id == name) {
                return strip.pieces;
            }
            all.insert(all.end(), strip.pieces.begin(), strip.pieces.end());
        }
        if (name == "all") {
            return all;
        }
        if (std::find(all.begin(), all.end(), name) == all.end()) {
            refuse("no-such-piece",
                   fmt::format("{}: has no piece or strip {}; the nearest are {}", source_.name,
                               name, fmt::join(nearest(name), ", ")));
        }
        return {name};
    }

    std::vector<std::string> on_sheet(const std::string& name, const std::string& number) const {
        int wanted = 0;
        const char* end = number.data() + number.size();
        const auto parsed = std::from_chars(number.data(), end, wanted);
        const std::vector<fab::Sheet> sheets = read_sheets(source_.read("layout.json"));
        for (const fab::Sheet& sheet : sheets) {
            if (parsed.ec == std::errc() && parsed.ptr == end && sheet.id == wanted) {
                std::vector<std::string> ids;
                for (const fab::Placement& placement : sheet.placements) {
                    ids.push_back(placement.piece);
                }
                return ids;
            }
        }
        refuse("no-such-sheet", fmt::format("{}: has no {}; its sheets are numbered from 1 to {}",
                                            source_.name, name, sheets.size()));
    }

    std::vector<std::string> nearest(const std::string& name) const {
        constexpr std::size_t kMost = 3;
        const std::string wanted = in_capitals(name);
        std::vector<std::pair<std::size_t, std::size_t>> order;
        for (std::size_t i = 0; i < known_.size(); ++i) {
            order.emplace_back(edit_distance(wanted, known_[i]), i);
        }
        std::sort(order.begin(), order.end());
        std::vector<std::string> names;
        for (std::size_t i = 0; i < std::min(kMost, order.size()); ++i) {
            names.push_back(known_[order[i].second]);
        }
        return names;
    }

    const PackageSource& source_;
    std::vector<fab::Strip> strips_;
    std::vector<std::string> known_;  // Strips and pieces.
};

fab::Material material_of(const PackageFacts& facts,
                          const std::string& id,
                          const RecutWishes& wishes,
                          std::span<const fab::Material> materials) {
    const std::string& wanted = wishes.material.empty() ? id : wishes.material;
    // What the package was made of, unless another one is named on purpose.
    const fab::Material* found = fab::find_material(facts.materials, wanted);
    if (const fab::Material* other = fab::find_material(materials, wanted);
        other != nullptr && (found == nullptr || !wishes.material.empty())) {
        found = other;
    }
    if (const fab::Material* other = fab::find_material(wishes.instead, wanted)) {
        found = other;
    }
    if (found == nullptr) {
        refuse("no-such-material", fmt::format("material: there is no {}", wanted));
    }
    fab::Material material = fab::on_machine(*found, facts.params.output.machine);
    if (wishes.sheet) {
        material.sheets = {{*wishes.sheet, std::nullopt}};
    }
    return material;
}

// So that the new package can be cut again from what it was cut from.
std::string with_materials_of(const fab::MaterialParams& material, const std::string& params_json) {
    nlohmann::json params = nlohmann::json::parse(params_json);
    params["material"]["warp"] = material.warp;
    params["material"]["weft"] = material.weft;
    return params.dump();
}

std::vector<fab::Piece> picked(std::vector<fab::Piece> pieces,
                               const std::vector<std::string>& ids) {
    std::map<std::string_view, std::size_t> index;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        index.emplace(pieces[i].id, i);
    }
    std::vector<fab::Piece> wanted;
    for (const std::string& id : ids) {
        const auto found = index.find(id);
        if (found == index.end()) {
            throw geometry::Error(geometry::ErrorKind::BadFile, "bad-package",
                                  fmt::format("strips.json: piece {} is missing", id));
        }
        wanted.push_back(pieces[found->second]);
    }
    return wanted;
}

// All but the pieces themselves.
fab::RecutInput input_for(const PackageFacts& facts,
                          const RecutWishes& wishes,
                          std::span<const fab::Material> materials) {
    fab::RecutInput input;
    input.input = facts.input;
    input.params = facts.params;
    input.params.nesting.time_s = std::min(wishes.time_s, facts.params.nesting.time_s);
    input.machine = facts.machine;
    input.weft = material_of(facts, facts.params.material.weft, wishes, materials);
    input.warp = material_of(facts, facts.params.material.warp, wishes, materials);
    input.params.material = {.warp = input.warp.id, .weft = input.weft.id};
    input.params_json = with_materials_of(input.params.material, facts.params_json);
    input.remnant = wishes.remnant;
    return input;
}

}  // namespace

void check_recut(const PackageSource& source,
                 const RecutWishes& wishes,
                 std::span<const fab::Material> materials) {
    input_for(read_facts(source.read("report.json")), wishes, materials);
    PieceNames(source, source.read("strips.json")).resolve(wishes.pieces);
}

fab::RecutSummary recut_package(const PackageSource& source,
                                const RecutWishes& wishes,
                                std::span<const fab::Material> materials,
                                const geometry::Context& context) {
    const std::string strips_json = source.read("strips.json");
    const std::vector<std::string> ids = PieceNames(source, strips_json).resolve(wishes.pieces);
    context.check();
    fab::RecutInput input = input_for(read_facts(source.read("report.json")), wishes, materials);
    input.pieces = picked(read_pieces(strips_json), ids);
    fab::RecutSummary summary = fab::recut(input, context);
    summary.package.files.push_back(
        {"strips.json", pick_pieces(strips_json, {ids.begin(), ids.end()})});
    return summary;
}

}  // namespace leafcutter::server
