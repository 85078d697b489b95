#include "server/cli/api_client.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <httplib.h>

#include "geometry/error.h"
#include "server/cli/command.h"
#include "server/cli/interrupt.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr const char* kRoot = "/api/v1";

std::string text_of(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

// The answer's body, or what went wrong as an exception with the exit status it deserves.
json answer_of(const httplib::Result& result, const std::string& url) {
    if (!result) {
        throw std::runtime_error(fmt::format("{}: no answer ({}): is the daemon running?", url,
                                             httplib::to_string(result.error())));
    }
    json body = json::parse(result->body, nullptr, /*allow_exceptions=*/false);
    if (result->status < 300) {
        return body.is_discarded() ? json() : body;
    }
    const std::string detail =
        body.is_object() ? body.value("detail", "") : fmt::format("status {}", result->status);
    if (result->status == 422 || result->status == 413) {
        throw UsageError(detail);
    }
    if (result->status == 401 || result->status == 403) {
        throw std::runtime_error(fmt::format("{}: {} (give a key with --api-key)", url, detail));
    }
    throw std::runtime_error(fmt::format("{}: {}", url, detail));
}

// Takes the lines of an event stream.
class EventLines {
public:
    using Take = std::function<bool(const std::string&, const json&)>;

    explicit EventLines(const Take& take) : take_(take) {}

    // False: enough.
    bool add(std::string_view bytes) {
        waiting_ += bytes;
        std::size_t end = 0;
        while ((end = waiting_.find('\n')) != std::string::npos) {
            std::string line = waiting_.substr(0, end);
            waiting_.erase(0, end + 1);
            if (!line.empty() && line.back() == '\r') {
                line.pop_back();
            }
            if (!take_line(line)) {
                return false;
            }
        }
        return true;
    }

    const std::string& last_id() const { return id_; }

private:
    bool take_line(const std::string& line) {
        if (line.starts_with("event: ")) {
            type_ = line.substr(7);
        } else if (line.starts_with("id: ")) {
            id_ = line.substr(4);
        } else if (line.starts_with("data: ")) {
            const json data = json::parse(line.substr(6), nullptr, /*allow_exceptions=*/false);
            return data.is_discarded() || take_(type_, data);
        }
        return true;
    }

    const Take& take_;
    std::string waiting_;
    std::string type_;
    std::string id_;
};

}  // namespace

void add_api_options(CLI::App& command, ApiOptions& options) {
    command.add_option("--url", options.url, "Where the daemon answers")
        ->envname("LEAFCUTTER_URL")
        ->capture_default_str();
    command.add_option("--api-key", options.key, "For a daemon with accounts: lc_…")
        ->envname("LEAFCUTTER_API_KEY");
}

ApiClient::ApiClient(ApiOptions options) : options_(std::move(options)) {
    const bool is_web = options_.url.starts_with("http://") || options_.url.starts_with("https://");
    if (is_web) {
        client_ = std::make_unique<httplib::Client>(options_.url);
    }
    if (!client_ || !client_->is_valid()) {
        throw UsageError(options_.url + ": is no URL of a daemon; write http://127.0.0.1:8080");
    }
    client_->set_read_timeout(std::chrono::seconds(60));
    if (!options_.key.empty()) {
        client_->set_bearer_token_auth(options_.key.c_str());
    }
}

ApiClient::~ApiClient() = default;

json ApiClient::get(const std::string& path) {
    return answer_of(client_->Get(kRoot + path), options_.url);
}

json ApiClient::readiness() {
    httplib::Result result = client_->Get(std::string(kRoot) + "/readyz");
    if (result && result->status == 503) {
        result->status = 200;  // Not ready is an answer too.
    }
    return answer_of(result, options_.url);
}

json ApiClient::post(const std::string& path, const json& body) {
    return answer_of(client_->Post(kRoot + path, text_of(body), "application/json"), options_.url);
}

json ApiClient::post(const std::string& path, const json& body, const std::string& key) {
    const httplib::Headers headers{{"Idempotency-Key", key}};
    return answer_of(client_->Post(kRoot + path, headers, text_of(body), "application/json"),
                     options_.url);
}

json ApiClient::put(const std::string& path, const json& body) {
    return answer_of(client_->Put(kRoot + path, text_of(body), "application/json"), options_.url);
}

void ApiClient::save(const std::string& path,
                     const std::string& file,
                     const std::function<void(double)>& progress) {
    const std::string partial = file + ".part";
    std::ofstream out(partial, std::ios::binary);
    if (!out) {
        throw UsageError(fmt::format("{}: cannot be written", partial));
    }
    std::string refusal;
    int status = 0;
    const InterruptWatch interrupt;
    httplib::Result result = client_->Get(
        kRoot + path,
        [&status](const httplib::Response& response) {
            status = response.status;
            return true;
        },
        [&](const char* bytes, std::size_t size) {
            status == 200 ? static_cast<void>(out.write(bytes, static_cast<std::streamsize>(size)))
                          : static_cast<void>(refusal.append(bytes, size));
            return out.good() && !interrupt.token().stop_requested();
        },
        [&progress](std::uint64_t done, std::uint64_t all) {
            progress(all == 0 ? 0.0 : static_cast<double>(done) / static_cast<double>(all));
            return true;
        });
    out.close();
    if (result && status == 200 && out.good()) {
        std::filesystem::rename(partial, file);
        return;
    }
    std::filesystem::remove(partial);
    if (interrupt.token().stop_requested()) {
        throw geometry::Cancelled();
    }
    if (!out.good()) {
        throw std::runtime_error(fmt::format("{}: cannot be written", partial));
    }
    if (result) {
        result->body = refusal;
    }
    answer_of(result, options_.url);
}

json ApiClient::patch(const std::string& path, const json& body) {
    return answer_of(client_->Patch(kRoot + path, text_of(body), "application/json"), options_.url);
}

json ApiClient::remove(const std::string& path) {
    return answer_of(client_->Delete(kRoot + path), options_.url);
}

void ApiClient::put_bytes(const std::string& path, const char* bytes, std::size_t size) {
    answer_of(client_->Put(kRoot + path, bytes, size, "application/octet-stream"), options_.url);
}

void ApiClient::follow(const std::function<bool(const std::string&, const json&)>& take) {
    constexpr auto kBeforeAgain = std::chrono::milliseconds(500);
    constexpr int kMostTries = 20;
    const InterruptWatch interrupt;
    EventLines lines(take);
    bool enough = false;
    for (int tries = 0; !enough && tries < kMostTries; ++tries) {
        httplib::Headers headers;
        if (!lines.last_id().empty()) {
            headers.emplace("Last-Event-ID", lines.last_id());
        }
        std::optional<int> status;
        client_->Get(
            std::string(kRoot) + "/events", headers,
            [&status](const httplib::Response& response) {
                status = response.status;
                return response.status == 200;
            },
            [&](const char* bytes, std::size_t size) {
                tries = 0;
                enough = !lines.add({bytes, size});
                return !enough && !interrupt.token().stop_requested();
            });
        if (interrupt.token().stop_requested()) {
            throw geometry::Cancelled();
        }
        if (status && *status != 200) {
            get("/version");
            throw std::runtime_error(fmt::format("{}: the events answer {}", url(), *status));
        }
        if (!enough) {
            std::this_thread::sleep_for(kBeforeAgain);
        }
    }
    if (!enough) {
        throw std::runtime_error(options_.url + ": the daemon went away");
    }
}

void print_json(const json& value) {
    std::printf("%s\n", text_of(value).c_str());
}

}  // namespace leafcutter::server
