#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "server/http/head.h"

namespace leafcutter::server {
namespace {

int verdict(const std::string& head) {
    const auto vetted = vet_head(head, {});
    const auto* refusal = std::get_if<Refusal>(&vetted);
    return refusal == nullptr ? 0 : refusal->status;
}

std::string with(const std::string& headers) {
    return "POST /api/v1/jobs HTTP/1.1\r\nHost: localhost:8080\r\n" + headers + "\r\n";
}

TEST(Head, ReadsPathQueryAndHeaders) {
    const auto vetted = vet_head(
        "GET /a%20b/c?x=1&y=%41 HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nX-Name:  v \r\n\r\n", {});
    const auto& head = std::get<VettedHead>(vetted);
    EXPECT_EQ(head.request.path, "/a b/c");
    EXPECT_EQ(head.request.query.at("x"), "1");
    EXPECT_EQ(head.request.query.at("y"), "A");
    EXPECT_EQ(head.request.header("x-name"), "v");
    EXPECT_TRUE(head.keep_alive);
}

TEST(Head, RefusesEveryAmbiguousBody) {
    EXPECT_EQ(verdict(with("Content-Length: 5\r\n")), 0);
    EXPECT_EQ(verdict(with("Content-Length: 5\r\nContent-Length: 5\r\n")), 400);
    EXPECT_EQ(verdict(with("Content-Length: -1\r\n")), 400);
    EXPECT_EQ(verdict(with("Content-Length: +5\r\n")), 400);
    EXPECT_EQ(verdict(with("Content-Length: 99999999999999999999\r\n")), 400);
    EXPECT_EQ(verdict(with("Transfer-Encoding: chunked\r\n")), 411);
    EXPECT_EQ(verdict(with("Transfer-Encoding : chunked\r\n")), 400);
    EXPECT_EQ(verdict(with("Content-Encoding: gzip\r\n")), 415);
}

TEST(Head, RefusesMoreThanOneRange) {
    EXPECT_EQ(verdict(with("Range: bytes=0-1\r\n")), 0);
    EXPECT_EQ(verdict(with("Range: bytes=0-1,2-3\r\n")), 416);
}

TEST(Head, AnswersOnlyToItsOwnNames) {
    EXPECT_EQ(verdict("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"), 0);
    EXPECT_EQ(verdict("GET / HTTP/1.1\r\nHost: [::1]:8080\r\n\r\n"), 0);
    EXPECT_EQ(verdict("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"), 421);
    EXPECT_EQ(verdict("GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n"), 400);
    EXPECT_EQ(verdict("GET / HTTP/1.1\r\n\r\n"), 400);
}

TEST(Head, BelievesOnlyTrustedProxies) {
    HeadRules rules;
    rules.trusted_proxies = {"10.0.0.1", "10.0.0.2"};
    const std::string head = with(
        "X-Forwarded-For: 1.2.3.4, 9.9.9.9, 10.0.0.2\r\nX-Forwarded-Proto: https\r\n"
        "Origin: https://localhost:8080\r\n");
    const auto through = std::get<VettedHead>(vet_head(head, rules, "10.0.0.1"));
    EXPECT_EQ(through.request.remote, "9.9.9.9");
    EXPECT_TRUE(through.request.is_secure);
    const auto direct = vet_head(head, rules, "9.9.9.9");
    EXPECT_EQ(std::get<Refusal>(direct).status, 403) << "the origin is of another scheme";
}

TEST(Head, RefusesOtherSitesUnsafeMethods) {
    EXPECT_EQ(verdict(with("Origin: http://localhost:8080\r\n")), 0);
    EXPECT_EQ(verdict(with("Origin: http://evil.example\r\n")), 403);
    EXPECT_EQ(verdict(with("Origin: null\r\n")), 403);
    EXPECT_EQ(verdict(with("Sec-Fetch-Site: cross-site\r\n")), 403);
    EXPECT_EQ(verdict("GET / HTTP/1.1\r\nHost: localhost\r\nOrigin: http://evil.example\r\n\r\n"),
              0);
}

TEST(Head, RefusesReservedNamesFoldedLinesAndControlLetters) {
    EXPECT_EQ(verdict(with("REMOTE_ADDR: 1.2.3.4\r\n")), 400);
    EXPECT_EQ(verdict(with("X: a\r\n b\r\n")), 400);
    EXPECT_EQ(verdict(with("X: a\nY: b\r\n")), 400);
    EXPECT_EQ(verdict(with(std::string("X: a\0b\r\n", 8))), 400);
    EXPECT_EQ(verdict("GET /%00 HTTP/1.1\r\nHost: localhost\r\n\r\n"), 400);
    EXPECT_EQ(verdict("GET /%zz HTTP/1.1\r\nHost: localhost\r\n\r\n"), 400);
}

TEST(Head, HoldsItsLimits) {
    std::string many;
    for (int i = 0; i < 70; ++i) {
        many += "X-" + std::to_string(i) + ": v\r\n";
    }
    EXPECT_EQ(verdict(with(many)), 431);
    EXPECT_EQ(verdict(with("X: " + std::string(20000, 'a') + "\r\n")), 431);
    EXPECT_EQ(verdict("GET /" + std::string(1100, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              414);
}

TEST(Head, AnyTruncationIsRefusedWithoutACrash) {
    const std::string whole = with("Content-Length: 5\r\nOrigin: http://localhost:8080\r\n");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_NE(verdict(whole.substr(0, size)), 0) << size;
    }
}

}  // namespace
}  // namespace leafcutter::server
