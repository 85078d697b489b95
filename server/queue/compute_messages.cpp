#include "server/queue/compute_messages.h"

#include <nlohmann/json.hpp>

namespace leafcutter::server {

namespace {

using nlohmann::json;

std::string written(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

std::string job_message(const ComputeInput& input, unsigned threads) {
    return written({{"file_name", input.file_name},
                    {"params", input.params_json},
                    {"job_name", input.job_name},
                    {"materials", input.material_records},
                    {"recut", input.recut_json},
                    {"threads", threads}});
}

JobMessage read_job_message(const std::string& text) {
    const json job = json::parse(text);
    JobMessage message;
    message.input.file_name = job.at("file_name").get<std::string>();
    message.input.params_json = job.at("params").get<std::string>();
    message.input.job_name = job.at("job_name").get<std::string>();
    message.input.material_records = job.at("materials").get<std::vector<std::string>>();
    message.input.recut_json = job.at("recut").get<std::string>();
    message.threads = job.at("threads").get<unsigned>();
    return message;
}

std::string progress_message(const ComputeProgress& progress) {
    return written({{"stage", progress.stage}, {"fraction", progress.fraction}});
}

ComputeProgress read_progress_message(const std::string& text) {
    const json progress = json::parse(text);
    return {progress.at("stage").get<std::string>(), progress.at("fraction").get<double>()};
}

std::string result_message(const ComputeOutput& output) {
    json sheets = json::array();
    for (const SheetPlan& plan : output.sheets) {
        sheets.push_back({{"number", plan.number},
                          {"material", plan.material},
                          {"program_path", plan.program_path},
                          {"estimated_s", plan.estimated_s},
                          {"size_mm", plan.size_mm},
                          {"stock", plan.stock},
                          {"offcut", plan.offcut_json}});
    }
    return written({{"summary", output.summary_json}, {"sheets", std::move(sheets)}});
}

ComputeOutput read_result_message(const std::string& text) {
    const json result = json::parse(text);
    ComputeOutput output;
    output.summary_json = result.at("summary").get<std::string>();
    for (const json& sheet : result.at("sheets")) {
        SheetPlan plan;
        plan.number = sheet.at("number").get<int>();
        plan.material = sheet.at("material").get<std::string>();
        plan.program_path = sheet.at("program_path").get<std::string>();
        plan.estimated_s = sheet.at("estimated_s").get<double>();
        plan.size_mm = sheet.at("size_mm").get<std::array<double, 2>>();
        plan.stock = sheet.at("stock").get<std::string>();
        plan.offcut_json = sheet.at("offcut").get<std::string>();
        output.sheets.push_back(std::move(plan));
    }
    return output;
}

std::string failure_message(const JobFailure& failure) {
    return written({{"kind", failure.kind}, {"code", failure.code}, {"detail", failure.detail}});
}

JobFailure read_failure_message(const std::string& text) {
    const json failure = json::parse(text);
    return {failure.at("kind").get<std::string>(), failure.at("code").get<std::string>(),
            failure.at("detail").get<std::string>()};
}

}  // namespace leafcutter::server
