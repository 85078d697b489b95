// The daemon as the command line sees it.

#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace httplib {
class Client;
}

namespace leafcutter::server {

struct ApiOptions {
    std::string url = "http://127.0.0.1:8080";
    std::string key;  // Empty: as on a daemon without accounts.
};

// --url and --api-key, or LEAFCUTTER_URL and LEAFCUTTER_API_KEY.
void add_api_options(CLI::App& command, ApiOptions& options);

// Every call throws UsageError for what the daemon refuses as wrong (422, 413), std::runtime_error
// for all else that is no success.
class ApiClient {
public:
    explicit ApiClient(ApiOptions options);
    ~ApiClient();
    ApiClient(const ApiClient&) = delete;
    ApiClient& operator=(const ApiClient&) = delete;

    const std::string& url() const { return options_.url; }

    // Paths below /api/v1. What is answered, null for nothing.
    nlohmann::json get(const std::string& path);

    // What /readyz answers, whether it is ready or not.
    nlohmann::json readiness();
    nlohmann::json post(const std::string& path, const nlohmann::json& body);
    nlohmann::json post(const std::string& path,
                        const nlohmann::json& body,
                        const std::string& idempotency_key);
    nlohmann::json put(const std::string& path, const nlohmann::json& body);
    nlohmann::json patch(const std::string& path, const nlohmann::json& body);
    nlohmann::json remove(const std::string& path);

    // As it is, whatever its kind; `progress` is told how much of it has come, from 0 to 1.
    void save(const std::string& path,
              const std::string& file,
              const std::function<void(double)>& progress);
    void put_bytes(const std::string& path, const char* bytes, std::size_t size);

    // Live events until `take` says false; reconnects where the stream breaks off. Throws
    // geometry::Cancelled on Ctrl-C.
    void follow(
        const std::function<bool(const std::string& type, const nlohmann::json& data)>& take);

private:
    ApiOptions options_;
    std::unique_ptr<httplib::Client> client_;
};

// To stdout: as JSON in one line, whatever bytes it holds.
void print_json(const nlohmann::json& value);

}  // namespace leafcutter::server
