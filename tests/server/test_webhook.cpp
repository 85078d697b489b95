#include <string>

#include <gtest/gtest.h>

#include "server/auth/secrets.h"
#include "server/webhook/post.h"
#include "server/webhook/webhook.h"

namespace leafcutter::server {
namespace {

TEST(Webhook, NeverMeansThePrivateNetwork) {
    for (const char* address : {"127.0.0.1",
                                "10.1.2.3",
                                "172.31.0.1",
                                "192.168.1.1",
                                "169.254.169.254",
                                "0.0.0.0",
                                "100.64.0.1",
                                "224.0.0.1",
                                "255.255.255.255",
                                "::1",
                                "::",
                                "fe80::1",
                                "fe80::1%eth0",
                                "fd00::1",
                                "::ffff:8.8.8.8",
                                "::ffff:127.0.0.1",
                                "2002:7f00:1::",
                                "2001:0:1::",
                                "64:ff9b::1",
                                "ff02::1",
                                "",
                                "example",
                                "1.2.3",
                                "0x7f.1"}) {
        EXPECT_TRUE(is_private_address(address)) << address;
    }
    for (const char* address : {"8.8.8.8", "172.32.0.1", "100.128.0.1", "2606:4700::1111"}) {
        EXPECT_FALSE(is_private_address(address)) << address;
    }
}

TEST(Webhook, ReadsAddressesStrictly) {
    const auto target = target_of("https://[2606:4700::1]:8443/a/b?c=d");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->host, "2606:4700::1");
    EXPECT_EQ(target->port, 8443);
    EXPECT_EQ(target->path, "/a/b?c=d");
    EXPECT_EQ(target_of("http://host")->path, "/");
    EXPECT_EQ(target_of("http://host?q")->path, "/?q");
    for (const char* wrong : {"", "host", "ftp://host/", "http://", "http:///x", "http://host:/",
                              "http://host:0/", "http://host:99999/", "http://u:p@host/",
                              "http://host/#x", "http://ho st/", "http://host\r\nX: y/"}) {
        EXPECT_FALSE(target_of(wrong)) << wrong;
    }
}

// RFC 4231, test case 2.
TEST(Webhook, SignsAsHmacSha256) {
    EXPECT_EQ(hmac_sha256("Jefe", "what do ya want for nothing?"),
              "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
    EXPECT_EQ(webhook_signature("k", 7, "b"), "sha256=" + hmac_sha256("k", "7.b"));
}

TEST(Webhook, WaitsLongerAfterEveryFailure) {
    EXPECT_EQ(webhook_back_off(1).count(), 1);
    EXPECT_EQ(webhook_back_off(4).count(), 8);
    EXPECT_EQ(webhook_back_off(500).count(), 3600);
}

TEST(Webhook, RefusesAPrivateAddressBeforeAnyConnection) {
    const PostResult result = post_json("http://localhost:9/", "{}", {}, false);
    EXPECT_FALSE(result.taken);
    EXPECT_NE(result.trouble.find("private"), std::string::npos);
}

}  // namespace
}  // namespace leafcutter::server
