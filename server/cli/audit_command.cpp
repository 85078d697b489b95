// `leafcutter audit PACKAGE [--burn FILE…]`: what was burnt, or what the sheets' G-code will burn,
// against the plan that follows from the package's pieces and layout.

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/cut/audit.h"
#include "fab/cut/toolpath.h"
#include "fab/material/material.h"
#include "server/burn_log.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/package_reader.h"

namespace leafcutter::server {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{4} << 30;

struct AuditArguments {
    std::string package;
    std::vector<std::string> burns;
    std::optional<double> kerf_mm;
    double tolerance_mm = 0.05;
};

struct SheetAudit {
    int sheet = 0;
    fab::BurnAudit audit;
    bool passed = false;
};

std::string read_text_file(const std::string& path) {
    const std::vector<std::byte> bytes = read_input_file(path, kMaxBytes);
    std::string text;
    text.reserve(bytes.size());
    for (const std::byte byte : bytes) {
        text.push_back(static_cast<char>(byte));
    }
    return text;
}

struct Makings {
    std::vector<fab::Material> materials;
    fab::MachineProfile machine;
    fab::CutParams wishes;
};

// Those of the package; of an older one that doesn't say, what is usual.
Makings makings_of(const AuditArguments& arguments) {
    try {
        const PackageFacts facts = read_facts(read_text_file(arguments.package + "/report.json"));
        return {facts.materials, facts.machine, facts.params.cut};
    } catch (const std::exception&) {
        const auto built_in = fab::built_in_materials();
        return {{built_in.begin(), built_in.end()}, {}, {}};
    }
}

fab::Material material_of(const fab::Sheet& sheet,
                          const std::vector<fab::Material>& materials,
                          const AuditArguments& arguments) {
    fab::Material material;
    if (const fab::Material* found = fab::find_material(materials, sheet.material)) {
        material = *found;
    } else if (!arguments.kerf_mm) {
        throw UsageError(fmt::format("sheet {}: nothing is known of {}; say its kerf with --kerf",
                                     sheet.id, sheet.material));
    }
    material.id = sheet.material;
    material.kerf_mm = arguments.kerf_mm.value_or(material.kerf_mm);
    return material;
}

std::vector<fab::CutProgram> plans_of(const AuditArguments& arguments) {
    const std::vector<fab::Piece> pieces =
        read_pieces(read_text_file(arguments.package + "/strips.json"));
    const Makings makings = makings_of(arguments);
    std::vector<fab::CutProgram> plans;
    for (const fab::Sheet& sheet :
         read_sheets(read_text_file(arguments.package + "/layout.json"))) {
        plans.push_back(fab::plan_sheet(
            sheet, pieces,
            {material_of(sheet, makings.materials, arguments), makings.machine, makings.wishes}));
    }
    return plans;
}

using Burns = std::vector<std::vector<fab::BurntSegment>>;  // One for each sheet.

Burns burns_of(const AuditArguments& arguments, const std::vector<fab::CutProgram>& plans) {
    Burns burns;
    if (arguments.burns.empty()) {
        for (const fab::CutProgram& plan : plans) {
            burns.push_back(fab::burnt_segments(read_text_file(
                fmt::format("{}/sheets/sheet-{:03}.gcode", arguments.package, plan.sheet))));
        }
        return burns;
    }
    for (const std::string& path : arguments.burns) {
        burns.push_back(read_burn_log(read_text_file(path)));
    }
    if (burns.size() == plans.size()) {
        return burns;
    }
    std::vector<fab::BurntSegment> together;
    for (const std::vector<fab::BurntSegment>& burn : burns) {
        together.insert(together.end(), burn.begin(), burn.end());
    }
    return part_by_sheet(together, plans);
}

void print_text(const std::vector<SheetAudit>& sheets) {
    for (const SheetAudit& sheet : sheets) {
        fmt::print("sheet {}: deviation {:.4f} mm, gap {:.4f} mm, burnt {:.1f} of {:.1f} mm: {}\n",
                   sheet.sheet, sheet.audit.largest_deviation_mm, sheet.audit.largest_gap_mm,
                   sheet.audit.burnt_mm, sheet.audit.planned_mm,
                   sheet.passed ? "as planned" : "NOT as planned");
    }
}

void print_json(const std::vector<SheetAudit>& sheets, bool passed) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const SheetAudit& sheet : sheets) {
        list.push_back({{"sheet", sheet.sheet},
                        {"largest_deviation_mm", sheet.audit.largest_deviation_mm},
                        {"largest_gap_mm", sheet.audit.largest_gap_mm},
                        {"burnt_mm", sheet.audit.burnt_mm},
                        {"planned_mm", sheet.audit.planned_mm},
                        {"passed", sheet.passed}});
    }
    const nlohmann::ordered_json out = {
        {"format", "leafcutter-audit/1"}, {"passed", passed}, {"sheets", std::move(list)}};
    fmt::print("{}\n", out.dump(2));
}

void audit(const AuditArguments& arguments, const CommonOptions& common) {
    const std::vector<fab::CutProgram> plans = plans_of(arguments);
    const Burns burns = burns_of(arguments, plans);
    std::vector<SheetAudit> sheets;
    bool passed = true;
    for (std::size_t i = 0; i < plans.size(); ++i) {
        SheetAudit sheet{plans[i].sheet, fab::audit_burn(plans[i], burns[i]), true};
        sheet.passed = sheet.audit.largest_deviation_mm <= arguments.tolerance_mm &&
                       sheet.audit.largest_gap_mm <= arguments.tolerance_mm;
        passed = passed && sheet.passed;
        sheets.push_back(sheet);
    }
    if (common.json) {
        print_json(sheets, passed);
    } else {
        print_text(sheets);
    }
    std::fflush(stdout);
    if (!passed) {
        throw std::runtime_error(
            fmt::format("audit: the burn is off its plan by more than {} mm: either something was "
                        "burnt beside it or something of it was left out",
                        arguments.tolerance_mm));
    }
}

}  // namespace

void add_audit_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("audit", "Hold a burn, or the G-code itself, against a package's plan");
    const auto arguments = std::make_shared<AuditArguments>();  // Lives as long as the callback.
    command->add_option("package", arguments->package, "Directory of a package")->required();
    command->add_option("--burn", arguments->burns,
                        "Beam logs: one for each sheet in order, or any number for all of them");
    command->add_option("--kerf", arguments->kerf_mm, "Kerf in mm (default: the material's)");
    command
        ->add_option("--tolerance", arguments->tolerance_mm,
                     "Largest deviation and gap in mm that pass")
        ->capture_default_str();
    command->callback([arguments, &common] { audit(*arguments, common); });
}

}  // namespace leafcutter::server
