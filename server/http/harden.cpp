#include "server/http/harden.h"

namespace leafcutter::server {

void harden(Response& response) {
    auto& headers = response.headers;
    headers.emplace("X-Content-Type-Options", "nosniff");
    headers.emplace("Referrer-Policy", "no-referrer");
    headers.emplace("Content-Security-Policy",
                    "default-src 'self'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
                    "img-src 'self' data: blob:; object-src 'none'; frame-ancestors 'none'; "
                    "base-uri 'none'; form-action 'none'");
    headers.emplace("Cache-Control", "no-store");
}

}  // namespace leafcutter::server
