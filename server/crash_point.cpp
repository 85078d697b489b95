#include "server/crash_point.h"

#include <atomic>
#include <charconv>
#include <cstdlib>
#include <string>
#include <unistd.h>

namespace leafcutter::server {

namespace {

struct Wanted {
    std::string name;
    int count = 1;
};

Wanted wanted_crash() {
    Wanted wanted;
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nobody changes the environment.
    const char* text = std::getenv("LEAFCUTTER_CRASH");
    if (text == nullptr) {
        return wanted;
    }
    wanted.name = text;
    const std::size_t colon = wanted.name.rfind(':');
    if (colon != std::string::npos) {
        std::from_chars(wanted.name.data() + colon + 1, wanted.name.data() + wanted.name.size(),
                        wanted.count);
        wanted.name.resize(colon);
    }
    return wanted;
}

}  // namespace

void crash_point(std::string_view name) {
    static const Wanted wanted = wanted_crash();
    static std::atomic<int> passed{0};
    if (wanted.name.empty() || wanted.name != name || ++passed != wanted.count) {
        return;
    }
    constexpr int kAsKilled = 137;
    ::_exit(kAsKilled);
}

}  // namespace leafcutter::server
