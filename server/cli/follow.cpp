#include "server/cli/follow.h"

#include <fmt/format.h>

#include "server/cli/progress_line.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

bool is_one_of(const json& state, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (state == name) {
            return true;
        }
    }
    return false;
}

// The thing of that id in an event or in the snapshot that opens the stream; null: not there.
json thing_in(const json& data, const std::string& kind, const std::string& id) {
    const auto direct = data.find(kind);
    if (direct != data.end() && direct->is_object() && direct->value("id", "") == id) {
        return *direct;
    }
    const auto list = data.find(kind + "s");
    if (list != data.end() && list->is_array()) {
        for (const json& each : *list) {
            if (each.value("id", "") == id) {
                return each;
            }
        }
    }
    return {};
}

template <typename Over, typename Stage>
json follow(ApiClient& client,
            const std::string& kind,
            const std::string& id,
            const CommonOptions& common,
            std::pair<Over, Stage> rules) {
    ProgressLine line(common);
    json last = client.get(fmt::format("/{}s/{}", kind, id));
    const auto show = [&] {
        line.show(rules.second(last), last.at("progress").at("fraction").get<double>());
        return !rules.first(last);
    };
    if (show()) {
        client.follow([&](const std::string&, const json& data) {
            json found = thing_in(data, kind, id);
            if (found.is_null()) {
                return true;
            }
            last = std::move(found);
            return show();
        });
    }
    line.clear();
    return client.get(fmt::format("/{}s/{}", kind, id));
}

}  // namespace

json follow_job(ApiClient& client, const std::string& id, const CommonOptions& common) {
    const auto over = [](const json& job) {
        return !is_one_of(job.at("state"), {"queued", "computing"});
    };
    const auto stage = [](const json& job) {
        const std::string now = job.at("progress").at("stage").get<std::string>();
        return now.empty() ? job.at("state").get<std::string>() : now;
    };
    return follow(client, "job", id, common, std::pair(over, stage));
}

namespace {

std::string cut_stage(const json& cut) {
    return fmt::format("sheet {} {}", cut.at("sheet").get<int>(),
                       cut.at("state").get<std::string>());
}

bool is_cut_over(const json& cut) {
    return is_one_of(cut.at("state"), {"done", "aborted", "failed", "interrupted"});
}

}  // namespace

json follow_cut(ApiClient& client, const std::string& id, const CommonOptions& common) {
    return follow(client, "cut", id, common, std::pair(&is_cut_over, &cut_stage));
}

json follow_sheet(ApiClient& client, const std::string& id, const CommonOptions& common) {
    const auto over = [](const json& cut) {
        return is_cut_over(cut) || cut.at("state") == "awaiting-sheet";
    };
    return follow(client, "cut", id, common, std::pair(over, &cut_stage));
}

}  // namespace leafcutter::server
