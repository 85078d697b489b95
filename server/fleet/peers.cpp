#include "server/fleet/peers.h"

#include <algorithm>
#include <array>
#include <unistd.h>

#include <fmt/format.h>
#include <httplib.h>
#include <spdlog/spdlog.h>

#include "server/fleet/node_role.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace {

httplib::Client client_of(const std::string& url, const std::string& key) {
    httplib::Client client(url);
    constexpr int kConnectS = 2;
    constexpr int kAnswerS = 15;
    client.set_connection_timeout(kConnectS);
    client.set_read_timeout(kAnswerS);
    client.set_write_timeout(kAnswerS);
    client.set_bearer_token_auth(key);
    client.set_keep_alive(false);
    return client;
}

std::string blob_path(const std::string& sha256) {
    return fmt::format("/api/v1/blobs/{}", sha256);
}

bool serves_clients(const NodeRecord& node) {
    const auto role = node_role_named(node.role);
    return role && serves(*role);
}

// Verified by its name before it counts.
bool fetch_from(const NodeRecord& node,
                const std::string& key,
                const std::string& sha256,
                const Blobs& blobs) {
    httplib::Client client = client_of(node.url, key);
    const std::unique_ptr<BlobWriter> writer = blobs.begin();
    int status = 0;
    const auto answer = client.Get(
        blob_path(sha256).c_str(),
        [&status](const httplib::Response& head) {
            status = head.status;
            return head.status == 200;
        },
        [&writer](const char* bytes, std::size_t size) {
            writer->write({bytes, size});
            return true;
        });
    if (!answer || status != 200) {
        return false;
    }
    if (writer->digest().sha256 != sha256) {
        spdlog::error("node {} sent other bytes than those of {}", node.id, sha256);
        return false;
    }
    writer->finish();
    return true;
}

}  // namespace

std::vector<NodeRecord> Peers::others() const {
    std::vector<NodeRecord> nodes;
    if (fleet_ == nullptr) {
        return nodes;
    }
    try {
        nodes = fleet_->nodes();
    } catch (const StoreError& error) {
        spdlog::warn("nobody can be asked: {}", error.what());
    }
    nodes.erase(std::remove_if(nodes.begin(), nodes.end(),
                               [this](const NodeRecord& node) {
                                   return node.id == node_ || node.url.empty() ||
                                          node.silent_ms > patience_.count();
                               }),
                nodes.end());
    std::stable_partition(nodes.begin(), nodes.end(), serves_clients);
    return nodes;
}

std::optional<NodeRecord> Peers::living(const std::string& id) const {
    for (NodeRecord& node : others()) {
        if (node.id == id) {
            return std::move(node);
        }
    }
    return std::nullopt;
}

bool Peers::fetch(const std::string& sha256, const Blobs& blobs) const {
    const std::vector<NodeRecord> nodes = others();
    return std::any_of(nodes.begin(), nodes.end(), [&](const NodeRecord& node) {
        return fetch_from(node, key_, sha256, blobs);
    });
}

bool Peers::share(const std::string& sha256, const Blobs& blobs) const {
    for (const NodeRecord& node : others()) {
        if (!serves_clients(node)) {
            continue;
        }
        const FileHandle file = blobs.open(sha256);
        const std::int64_t size = blobs.size(sha256).value_or(0);
        httplib::Client client = client_of(node.url, key_);
        const auto answer = client.Put(
            blob_path(sha256).c_str(), static_cast<std::size_t>(size),
            [&file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                std::array<char, 65536> piece;
                const ssize_t read =
                    ::pread(file.fd(), piece.data(), std::min(length, piece.size()),
                            static_cast<off_t>(offset));
                return read > 0 && sink.write(piece.data(), static_cast<std::size_t>(read));
            },
            "application/octet-stream");
        if (answer && (answer->status == 201 || answer->status == 204)) {
            return true;
        }
    }
    return false;
}

std::optional<PeerAnswer> Peers::call(const NodeRecord& node, const PeerCall& call) const {
    httplib::Client client = client_of(node.url, key_);
    httplib::Request request;
    request.method = call.method;
    request.path = call.path;
    request.body = call.body;
    request.set_header("Authorization", "Bearer " + key_);
    request.set_header(kCallerHeader, call.caller);
    request.set_header(kRoleHeader, call.role);
    request.set_header(kMayFireHeader, call.may_fire ? "yes" : "no");
    for (const auto& [name, value] : call.headers) {
        request.set_header(name.c_str(), value);
    }
    if (!call.body.empty()) {
        request.set_header("Content-Type", "application/json");
    }
    const auto answer = client.send(request);
    if (!answer) {
        return std::nullopt;
    }
    return PeerAnswer{answer->status, answer->get_header_value("Content-Type"), answer->body,
                      answer->get_header_value("ETag")};
}

}  // namespace leafcutter::server
