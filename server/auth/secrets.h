// Passwords and random secrets, by libsodium.

#pragma once

#include <string>
#include <string_view>

namespace leafcutter::server {

// argon2id with libsodium's interactive limits: 64 MB and a good part of 0.1 s.
// Throws std::bad_alloc.
std::string hash_password(std::string_view password);
bool is_password(const std::string& hash, std::string_view password);

// 256 bits of the kernel's randomness, in 43 letters of URL-safe base 64.
std::string new_secret();

// HMAC-SHA256, in lower-case hex.
std::string hmac_sha256(std::string_view key, std::string_view text);

// Equal, in a time that says nothing of where they differ.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace leafcutter::server
