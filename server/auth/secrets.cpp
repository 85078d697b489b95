#include "server/auth/secrets.h"

#include <array>
#include <new>
#include <sodium.h>
#include <stdexcept>

namespace leafcutter::server {

namespace {

void begin_sodium() {
    static const int ready = sodium_init();  // Once, and safe from any thread.
    if (ready < 0) {
        throw std::runtime_error("libsodium does not start");
    }
}

}  // namespace

std::string hash_password(std::string_view password) {
    begin_sodium();
    std::array<char, crypto_pwhash_STRBYTES> hash{};
    if (crypto_pwhash_str(hash.data(), password.data(), password.size(),
                          crypto_pwhash_OPSLIMIT_INTERACTIVE,
                          crypto_pwhash_MEMLIMIT_INTERACTIVE) != 0) {
        throw std::bad_alloc();
    }
    return hash.data();
}

bool is_password(const std::string& hash, std::string_view password) {
    begin_sodium();
    return crypto_pwhash_str_verify(hash.c_str(), password.data(), password.size()) == 0;
}

std::string new_secret() {
    begin_sodium();
    constexpr std::size_t kBytes = 32;
    std::array<unsigned char, kBytes> random{};
    randombytes_buf(random.data(), random.size());
    std::array<char, sodium_base64_ENCODED_LEN(kBytes, sodium_base64_VARIANT_URLSAFE_NO_PADDING)>
        text{};
    return sodium_bin2base64(text.data(), text.size(), random.data(), random.size(),
                             sodium_base64_VARIANT_URLSAFE_NO_PADDING);
}

std::string hmac_sha256(std::string_view key, std::string_view text) {
    begin_sodium();
    const auto bytes = [](std::string_view view) {
        return reinterpret_cast<const unsigned char*>(view.data());
    };
    crypto_auth_hmacsha256_state state;
    crypto_auth_hmacsha256_init(&state, bytes(key), key.size());
    crypto_auth_hmacsha256_update(&state, bytes(text), text.size());
    std::array<unsigned char, crypto_auth_hmacsha256_BYTES> code{};
    crypto_auth_hmacsha256_final(&state, code.data());
    std::array<char, 2 * crypto_auth_hmacsha256_BYTES + 1> hex{};
    return sodium_bin2hex(hex.data(), hex.size(), code.data(), code.size());
}

bool same_secret(std::string_view a, std::string_view b) {
    return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace leafcutter::server
