#include "server/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "drivers/device.h"
#include "server/http/host_names.h"
#include "server/webhook/post.h"

namespace leafcutter::server {

namespace {

[[noreturn]] void fail(const toml::source_region& where, const std::string& what) {
    const std::string file = where.path ? *where.path : std::string("configuration");
    throw BadConfig(fmt::format("{}:{}: {}", file, where.begin.line, what));
}

template <typename T>
T value_of(const toml::node& node, const std::string& key, const char* kind) {
    const auto value = node.value_exact<T>();
    if (!value) {
        fail(node.source(), fmt::format("{}: must be {}", key, kind));
    }
    return *value;
}

unsigned count_of(const toml::node& node, const std::string& key, std::int64_t most) {
    const auto value = value_of<std::int64_t>(node, key, "a whole number");
    if (value < 1 || value > most) {
        fail(node.source(), fmt::format("{}: must be 1 to {}", key, most));
    }
    return static_cast<unsigned>(value);
}

std::array<double, 2> bed_of(const toml::node& node) {
    const toml::array* sides = node.as_array();
    std::array<double, 2> bed{};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto side =
            sides != nullptr && sides->size() == 2 ? (*sides)[i].value<double>() : std::nullopt;
        if (!side) {
            fail(node.source(), "bed_mm: must be [width, height]");
        }
        bed.at(i) = *side;
    }
    return bed;
}

DeviceRecord device_of(const toml::table& table) {
    DeviceRecord device;
    for (const auto& [key, node] : table) {
        if (key == "id") {
            device.id = value_of<std::string>(node, "id", "a string");
        } else if (key == "name") {
            device.name = value_of<std::string>(node, "name", "a string");
        } else if (key == "uri") {
            device.uri = value_of<std::string>(node, "uri", "a string");
        } else if (key == "auto_start") {
            device.auto_start = value_of<bool>(node, "auto_start", "true or false");
        } else if (key == "bed_mm") {
            device.bed_mm = bed_of(node);
        } else {
            fail(node.source(), fmt::format("device.{}: there is no such key", key.str()));
        }
    }
    device.name = device.name.empty() ? device.id : device.name;
    check_device(device);
    return device;
}

std::vector<std::string> words_of(const toml::node& node, const std::string& key) {
    const toml::array* words = node.as_array();
    if (words == nullptr) {
        fail(node.source(), key + ": must be a list of strings");
    }
    std::vector<std::string> result;
    for (const toml::node& word : *words) {
        result.push_back(value_of<std::string>(word, key, "a list of strings"));
    }
    return result;
}

void check_webhook(const WebhookConfig& webhook, const toml::source_region& where) {
    if (!target_of(webhook.url)) {
        fail(where, "webhook.url: must be http://… or https://…");
    }
    constexpr std::size_t kShortestSecret = 16;
    if (webhook.secret.size() < kShortestSecret) {
        fail(where, "webhook.secret: must have 16 bytes at least");
    }
    for (const std::string& event : webhook.events) {
        if (event != "job" && event != "cut") {
            fail(where, "webhook.events: must be some of \"job\" and \"cut\"");
        }
    }
}

WebhookConfig webhook_of(const toml::table& table) {
    WebhookConfig webhook;
    for (const auto& [key, node] : table) {
        if (key == "url") {
            webhook.url = value_of<std::string>(node, "url", "a string");
        } else if (key == "secret") {
            webhook.secret = value_of<std::string>(node, "secret", "a string");
        } else if (key == "events") {
            webhook.events = words_of(node, "events");
        } else if (key == "allow_private") {
            webhook.allow_private = value_of<bool>(node, "allow_private", "true or false");
        } else {
            fail(node.source(), fmt::format("webhook.{}: there is no such key", key.str()));
        }
    }
    check_webhook(webhook, table.source());
    return webhook;
}

// [[key]] tables, each read by `read`.
template <typename Read>
void read_tables(const toml::node& node, const std::string& key, Read read) {
    const toml::array* tables = node.as_array();
    if (tables == nullptr) {
        fail(node.source(), fmt::format("{}: must be written as [[{}]]", key, key));
    }
    for (const toml::node& each : *tables) {
        const toml::table* table = each.as_table();
        if (table == nullptr) {
            fail(each.source(), key + ": must be a table");
        }
        read(*table);
    }
}

StopPolicy stop_policy_of(const toml::node& node) {
    const auto word = value_of<std::string>(node, "stop_policy", "a string");
    if (word == "pause") {
        return StopPolicy::Pause;
    }
    if (word == "finish") {
        return StopPolicy::Finish;
    }
    if (word == "abort") {
        return StopPolicy::Abort;
    }
    fail(node.source(), "stop_policy: must be pause, finish or abort");
}

LogFormat log_format_of(const toml::node& node) {
    const auto word = value_of<std::string>(node, "log_format", "a string");
    if (word != "text" && word != "json") {
        fail(node.source(), "log_format: must be text or json");
    }
    return word == "json" ? LogFormat::Json : LogFormat::Text;
}

NodeRole node_role_of(const toml::node& node) {
    const auto role = node_role_named(value_of<std::string>(node, "role", "a string"));
    if (!role) {
        fail(node.source(), "role: must be all, api, worker or station");
    }
    return *role;
}

bool read_fleet_key(std::string_view key, const toml::node& node, Config& config) {
    struct Word {
        std::string_view name;
        std::string* text;
    };
    const Word words[] = {{"store", &config.store},
                          {"node", &config.node},
                          {"advertise", &config.advertise},
                          {"fleet_key", &config.fleet_key}};
    for (const auto& [name, text] : words) {
        if (key == name) {
            *text = value_of<std::string>(node, std::string(name), "a string");
            return true;
        }
    }
    if (key == "role") {
        config.role = node_role_of(node);
        return true;
    }
    return false;
}

bool read_count(std::string_view key, const toml::node& node, Config& config) {
    struct Count {
        std::string_view name;
        unsigned* count;
        std::int64_t most;
    };
    const Count counts[] = {{"http_workers", &config.http_workers, 256},
                            {"compute_workers", &config.compute_workers, 256},
                            {"threads_per_job", &config.threads_per_job, 256},
                            {"job_memory_mb", &config.job_memory_mb, 1 << 24},
                            {"job_minutes", &config.job_minutes, 60 * 24 * 30},
                            {"lease_s", &config.lease_s, 3600}};
    for (const auto& [name, count, most] : counts) {
        if (key == name) {
            *count = count_of(node, std::string(name), most);
            return true;
        }
    }
    return false;
}

void read_key(std::string_view key, const toml::node& node, Config& config) {
    if (key == "listen") {
        config.listen = parse_listen(value_of<std::string>(node, "listen", "a string"));
    } else if (key == "state") {
        config.state = value_of<std::string>(node, "state", "a string");
    } else if (key == "hosts") {
        config.hosts = words_of(node, "hosts");
    } else if (key == "trusted_proxies") {
        config.trusted_proxies = words_of(node, "trusted_proxies");
    } else if (key == "stop_policy") {
        config.stop_policy = stop_policy_of(node);
    } else if (key == "log_format") {
        config.log_format = log_format_of(node);
    } else if (key == "device") {
        read_tables(node, "device", [&config](const toml::table& table) {
            config.devices.push_back(device_of(table));
        });
    } else if (key == "webhook") {
        read_tables(node, "webhook", [&config](const toml::table& table) {
            config.webhooks.push_back(webhook_of(table));
        });
    } else if (!read_count(key, node, config) && !read_fleet_key(key, node, config)) {
        fail(node.source(), fmt::format("{}: there is no such key", key));
    }
}

}  // namespace

ListenAddress parse_listen(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    ListenAddress listen;
    const char* end = text.data() + text.size();
    const auto parsed = colon == std::string::npos
                            ? std::from_chars_result{end, std::errc::invalid_argument}
                            : std::from_chars(text.data() + colon + 1, end, listen.port);
    if (parsed.ec != std::errc() || parsed.ptr != end || listen.port < 0 || listen.port > 65535) {
        throw BadConfig(fmt::format("listen: {} is no ADDRESS:PORT", text));
    }
    std::string address = text.substr(0, colon);
    if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
        address = address.substr(1, address.size() - 2);
    }
    if (!address.empty()) {
        listen.address = address == "localhost" ? "127.0.0.1" : address;
    }
    return listen;
}

void check_fleet(Config& config) {
    if (config.store.empty()) {
        if (config.role != NodeRole::All) {
            throw BadConfig(fmt::format(
                "role: a node that is only {} needs others: name their database with store",
                to_string(config.role)));
        }
        return;
    }
    if (!config.store.starts_with("postgresql://") && !config.store.starts_with("postgres://")) {
        throw BadConfig("store: must be postgresql://USER@HOST/DATABASE");
    }
    constexpr std::size_t kShortestKey = 16;
    if (config.fleet_key.size() < kShortestKey) {
        throw BadConfig("fleet_key: must have 16 letters at least, the same on every node");
    }
    if (config.node.empty()) {
        config.node = lower_host_name();
    }
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    };
    if (config.node.empty() || config.node.size() > 64 ||
        !std::all_of(config.node.begin(), config.node.end(), is_plain)) {
        throw BadConfig("node: must be 1 to 64 of a-z, 0-9, '-', '_' and '.'");
    }
    if (!config.advertise.empty() && !target_of(config.advertise)) {
        throw BadConfig("advertise: must be http://HOST:PORT");
    }
}

bool is_loopback(const std::string& address) {
    return address == "localhost" || address == "::1" || address.starts_with("127.");
}

Config read_config(const std::filesystem::path& file) {
    Config config;
    try {
        const toml::table table = toml::parse_file(file.string());
        for (const auto& [key, node] : table) {
            read_key(key.str(), node, config);
        }
    } catch (const toml::parse_error& error) {
        fail(error.source(), std::string(error.description()));
    }
    return config;
}

std::filesystem::path default_state_dir() {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): read once, before any thread exists.
    if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0') {
        return std::filesystem::path(state) / "leafcutter";
    }
    // NOLINTNEXTLINE(concurrency-mt-unsafe): likewise.
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
        return std::filesystem::path(home) / ".local/state/leafcutter";
    }
    throw BadConfig("there is no home folder to keep the state in: name one with --state");
}

void check_device(const DeviceRecord& device) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    };
    constexpr std::size_t kLongest = 64;
    if (device.id.empty() || device.id.size() > kLongest ||
        !std::all_of(device.id.begin(), device.id.end(), is_plain)) {
        throw BadConfig("id: must be 1 to 64 of a-z, 0-9, - and _");
    }
    if (!drivers::is_device_uri(device.uri)) {
        throw BadConfig(
            "uri: must be grbl:PORT, grbl:tcp://HOST:PORT, marlin:… or smoothie:… alike, "
            "lihuiyu:usb?bus=N&address=N, sim:grbl, sim:marlin, sim:smoothie or sim:lihuiyu");
    }
    for (const double side : device.bed_mm) {
        if (!std::isfinite(side) || side <= 0.0) {
            throw BadConfig("bed_mm: both sides must be > 0");
        }
    }
}

void check_remote_device(const DeviceRecord& device, const std::filesystem::path& burn_logs) {
    check_device(device);
    constexpr std::string_view kOption = "burn=";
    const std::string_view uri = device.uri;
    for (std::size_t at = uri.find(kOption); at != std::string_view::npos;
         at = uri.find(kOption, at + 1)) {
        const std::size_t begin = at + kOption.size();
        const std::filesystem::path log = uri.substr(begin, uri.find('&', begin) - begin);
        if (log.lexically_normal() != log || log.parent_path() != burn_logs ||
            !log.has_filename()) {
            throw BadConfig("uri: burn must be a file in " + burn_logs.string());
        }
    }
}

}  // namespace leafcutter::server
