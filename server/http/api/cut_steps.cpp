#include "server/http/api/cut_steps.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/views.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

enum class Needed { Yes, No };

json step(const char* name, Needed needed, json details = json::object()) {
    details["step"] = name;
    details["required"] = needed == Needed::Yes;
    if (details.count("done") == 0) {
        details["done"] = nullptr;  // Only people can tell.
    }
    return details;
}

json loading(App& app, const CutRecord& cut) {
    json details = {{"sheet", cut.sheet()}};
    const auto job = app.store().jobs.find(cut.job);
    if (job) {
        const auto sheet =
            std::find_if(job->sheets.begin(), job->sheets.end(),
                         [&cut](const SheetRecord& each) { return each.number == cut.sheet(); });
        if (sheet != job->sheets.end()) {
            details["material"] = sheet->material;
            details["size_mm"] = sheet->size_mm;
            details["stock"] = sheet->stock.empty() ? json() : json(sheet->stock);
        }
    }
    return details;
}

// The program whose outline the machine went round last.
std::string framed_on(App& app, const std::string& device) {
    if (const auto runner = app.fleet().find(device)) {
        return runner->framed();
    }
    const auto elsewhere = app.remote().find("device", device);
    return elsewhere ? elsewhere->value("framed", "") : "";
}

// Up to the call that lets the beam loose.
json before_fire(App& app, const CutRecord& cut, const char* call) {
    json steps = json::array();
    if (cut.position > 0) {
        steps.push_back(
            step("remove-sheet", Needed::Yes, {{"sheet", cut.sheets.at(cut.position - 1)}}));
    }
    steps.push_back(cut.is_rest() ? step("keep-sheet", Needed::Yes, {{"sheet", cut.sheet()}})
                                  : step("load-sheet", Needed::Yes, loading(app, cut)));
    steps.push_back(
        step("frame", Needed::No, {{"done", framed_on(app, cut.device) == cut.program_sha256}}));
    steps.push_back(step("bed-clear", Needed::Yes));
    steps.push_back(step(call, Needed::Yes, {{"done", false}}));
    return steps;
}

}  // namespace

json cut_steps(App& app, const CutRecord& cut) {
    if (cut.state == CutState::Waiting) {
        return before_fire(app, cut, "start");
    }
    if (cut.state == CutState::AwaitingSheet) {
        return before_fire(app, cut, "confirm-sheet");
    }
    json steps = json::array();
    if (cut_allows(app, cut, "finish")) {
        if (!cut.beam->position_kept) {
            steps.push_back(step("home", Needed::Yes));
        }
        steps.push_back(step("keep-sheet", Needed::Yes, {{"sheet", cut.sheet()}}));
        if (!cut.beam->certain) {
            steps.push_back(step("measure-burnt", Needed::Yes));
        }
        steps.push_back(step("finish", Needed::Yes, {{"done", false}}));
    }
    return steps;
}

}  // namespace leafcutter::server
