#include "server/http/head.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include <fmt/format.h>

namespace leafcutter::server {

namespace {

constexpr std::array<std::string_view, 7> kMethods{"GET",   "HEAD",   "POST",   "PUT",
                                                   "PATCH", "DELETE", "OPTIONS"};

Refusal bad_request(std::string detail) {
    return {400, "bad-request", std::move(detail)};
}

bool is_token_letter(char c) {
    constexpr std::string_view kOthers = "!#$%&'*+-.^_`|~";
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           kOthers.find(c) != std::string_view::npos;
}

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string lowered(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), lower);
    return result;
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Takes one line off the front; nothing unless it ends with CR LF and has no other control letter.
std::optional<std::string_view> next_line(std::string_view& text) {
    const std::size_t end = text.find("\r\n");
    if (end == std::string_view::npos) {
        return std::nullopt;
    }
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 2);
    const bool clean = std::all_of(line.begin(), line.end(), [](char c) {
        return c == '\t' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
    });
    return clean ? std::optional(line) : std::nullopt;
}

std::optional<Refusal> read_query(std::string_view text, Request& request) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('&'), text.size());
        const std::string_view pair = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t equals = std::min(pair.find('='), pair.size());
        const auto name = percent_decoded(pair.substr(0, equals));
        const auto value = percent_decoded(pair.substr(std::min(equals + 1, pair.size())));
        if (!name || !value) {
            return bad_request("broken escape in the query");
        }
        request.query[*name] = *value;
    }
    return std::nullopt;
}

std::optional<Refusal> read_target(std::string_view target, Request& request) {
    if (target.size() > HeadRules::kLongestPath) {
        return Refusal{414, "uri-too-long", "the path is longer than 1 kB"};
    }
    if (target.empty() || target.front() != '/' || target.find('#') != std::string_view::npos) {
        return bad_request("the request target is no path");
    }
    const std::size_t question = std::min(target.find('?'), target.size());
    const auto path = percent_decoded(target.substr(0, question));
    if (!path) {
        return bad_request("broken escape in the path");
    }
    request.path = *path;
    return read_query(target.substr(std::min(question + 1, target.size())), request);
}

std::optional<Refusal> read_request_line(std::string_view line, VettedHead& head) {
    const std::size_t first = line.find(' ');
    const std::size_t last = line.rfind(' ');
    if (first == std::string_view::npos || first == last) {
        return bad_request("the request line is malformed");
    }
    const std::string_view method = line.substr(0, first);
    const std::string_view version = line.substr(last + 1);
    const std::string_view target = line.substr(first + 1, last - first - 1);
    if (version != "HTTP/1.1" && version != "HTTP/1.0") {
        return Refusal{505, "http-version", "only HTTP/1.1 is spoken here"};
    }
    if (std::find(kMethods.begin(), kMethods.end(), method) == kMethods.end()) {
        return Refusal{501, "method-unknown", "this method is not known here"};
    }
    if (target.find(' ') != std::string_view::npos) {
        return bad_request("the request target is no path");
    }
    head.request.method = method;
    head.keep_alive = version == "HTTP/1.1";
    return read_target(target, head.request);
}

std::optional<Refusal> read_header(std::string_view line, Request& request) {
    const std::size_t colon = line.find(':');
    const std::string_view name = line.substr(0, std::min(colon, line.size()));
    const bool is_token = !name.empty() && std::all_of(name.begin(), name.end(), is_token_letter);
    if (colon == std::string_view::npos || !is_token) {
        return bad_request("a header line is malformed");  // Folded lines end up here too.
    }
    const std::string key = lowered(name);
    if (key.starts_with("remote_") || key.starts_with("local_")) {
        return bad_request("this header's name is reserved");
    }
    const std::string value(trimmed(line.substr(colon + 1)));
    const auto [place, is_new] = request.headers.emplace(key, value);
    if (is_new) {
        return std::nullopt;
    }
    constexpr std::array<std::string_view, 11> kOnce{"host",
                                                     "content-length",
                                                     "transfer-encoding",
                                                     "content-type",
                                                     "content-encoding",
                                                     "range",
                                                     "authorization",
                                                     "cookie",
                                                     "x-api-key",
                                                     "x-forwarded-proto",
                                                     "origin"};
    if (std::find(kOnce.begin(), kOnce.end(), key) != kOnce.end()) {
        return bad_request(fmt::format("the header {} came twice", key));
    }
    place->second += ", " + value;
    return std::nullopt;
}

std::optional<Refusal> judge_host(const Request& request, const HeadRules& rules) {
    const auto host = request.header("host");
    if (!host) {
        return bad_request("the Host header is missing");
    }
    std::string name = lowered(*host);
    const std::size_t colon = name.rfind(':');
    if (colon != std::string::npos && name.find(']', colon) == std::string::npos) {
        name.resize(colon);
    }
    // A page of another site that lets its name point here (DNS rebinding) ends at this line.
    if (std::find(rules.hosts.begin(), rules.hosts.end(), name) == rules.hosts.end()) {
        return Refusal{421, "misdirected", "this daemon does not answer to that host name"};
    }
    return std::nullopt;
}

std::optional<Refusal> judge_origin(const Request& request) {
    if (request.method == "GET" || request.method == "HEAD" || request.method == "OPTIONS") {
        return std::nullopt;
    }
    const Refusal foreign{403, "cross-origin", "a page of another site may not do this"};
    const auto origin = request.header("origin");
    const std::string_view scheme = request.is_secure ? "https" : "http";
    if (origin &&
        lowered(*origin) != fmt::format("{}://{}", scheme, lowered(request.headers.at("host")))) {
        return foreign;
    }
    const std::string site = request.header("sec-fetch-site").value_or("none");
    if (!origin && site != "none" && site != "same-origin") {
        return foreign;
    }
    return std::nullopt;
}

// Who is at the other end, as far as it can be believed: the last hop that no proxy of ours is.
void see_through_proxies(Request& request, const HeadRules& rules, const std::string& peer) {
    const auto is_trusted = [&rules](std::string_view address) {
        return std::find(rules.trusted_proxies.begin(), rules.trusted_proxies.end(), address) !=
               rules.trusted_proxies.end();
    };
    request.remote = peer;
    if (!is_trusted(peer)) {
        return;
    }
    request.is_secure = lowered(request.header("x-forwarded-proto").value_or("")) == "https";
    const std::string forwarded = request.header("x-forwarded-for").value_or("");
    std::string_view hops = forwarded;
    while (!hops.empty() && is_trusted(request.remote)) {
        const std::size_t comma = hops.rfind(',');
        const std::string_view hop =
            comma == std::string_view::npos ? hops : hops.substr(comma + 1);
        hops = comma == std::string_view::npos ? "" : hops.substr(0, comma);
        request.remote = trimmed(hop);
    }
}

std::optional<Refusal> judge_body(VettedHead& head) {
    Request& request = head.request;
    if (request.header("transfer-encoding")) {
        return Refusal{411, "length-required", "say the body's size in Content-Length"};
    }
    if (const auto coding = request.header("content-encoding"); coding && *coding != "identity") {
        return Refusal{415, "content-encoding", "compressed bodies are not taken"};
    }
    const auto length = request.header("content-length");
    if (!length) {
        return std::nullopt;
    }
    const char* end = length->data() + length->size();
    const auto parsed = std::from_chars(length->data(), end, request.body.bytes);
    const bool digits =
        std::all_of(length->begin(), length->end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || parsed.ec != std::errc() || parsed.ptr != end) {
        return bad_request("Content-Length is no number");
    }
    const auto expect = request.header("expect");
    if (expect && lowered(*expect) != "100-continue") {
        return Refusal{417, "expectation", "only 100-continue can be expected"};
    }
    head.expects_continue = expect.has_value();
    return std::nullopt;
}

std::optional<Refusal> judge_range(const Request& request) {
    const auto range = request.header("range");
    if (range && range->find(',') != std::string::npos) {
        return Refusal{416, "one-range", "only one range at a time"};
    }
    return std::nullopt;
}

}  // namespace

std::variant<VettedHead, Refusal> vet_head(std::string_view text,
                                           const HeadRules& rules,
                                           const std::string& peer) {
    if (text.size() > HeadRules::kMostBytes) {
        return Refusal{431, "head-too-large", "the head is larger than 16 kB"};
    }
    VettedHead head;
    const auto first = next_line(text);
    if (!first) {
        return bad_request("the request line is malformed");
    }
    if (auto refusal = read_request_line(*first, head)) {
        return *refusal;
    }
    std::size_t headers = 0;
    while (true) {
        const auto line = next_line(text);
        if (!line) {
            return bad_request("a header line is malformed");
        }
        if (line->empty()) {
            break;
        }
        if (++headers > HeadRules::kMostHeaders) {
            return Refusal{431, "too-many-headers", "more than 64 headers"};
        }
        if (auto refusal = read_header(*line, head.request)) {
            return *refusal;
        }
    }
    see_through_proxies(head.request, rules, peer);
    std::optional<Refusal> refusal = judge_host(head.request, rules);
    refusal = refusal ? refusal : judge_origin(head.request);
    refusal = refusal ? refusal : judge_body(head);
    refusal = refusal ? refusal : judge_range(head.request);
    if (refusal) {
        return *refusal;
    }
    if (lowered(head.request.header("connection").value_or("")).find("close") !=
        std::string::npos) {
        head.keep_alive = false;
    }
    return head;
}

}  // namespace leafcutter::server
