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

bool same_secret(std::string_view a, std::string_view b) {
    return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace leafcutter::server
