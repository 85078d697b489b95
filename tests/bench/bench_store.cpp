// The store with as many jobs as a busy workshop has in years: how long it takes to open, to claim
// and to list. Usage: bench_store [JOBS] [QUEUED]

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <thread>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "server/store/store.h"
#include "tests/support/temp_dir.h"

namespace {

using namespace leafcutter::server;
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begun) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begun).count();
}

// Median and worst of some calls.
template <typename Call>
void time_of(const char* what, int times, Call call) {
    std::vector<double> taken;
    for (int i = 0; i < times; ++i) {
        const Clock::time_point begun = Clock::now();
        call();
        taken.push_back(ms_since(begun));
    }
    std::sort(taken.begin(), taken.end());
    fmt::print("{:28} {:9.2f} ms median {:9.2f} ms worst of {}\n", what, taken[taken.size() / 2],
               taken.back(), times);
}

ComputedJob package() {
    ComputedJob result;
    result.summary_json = R"({"quads":100,"strips":20,"pieces":20,"sheets":1})";
    for (int i = 0; i < 20; ++i) {
        result.artifacts.push_back({fmt::format("sheets/part-{}.svg", i), 1000,
                                    sha256_of(std::to_string(i)), "image/svg+xml"});
    }
    SheetRecord sheet;
    sheet.program_sha256 = sha256_of("program");
    result.sheets.push_back(sheet);
    return result;
}

// By many at once, whose jobs share their commits.
void fill(Store& store, int jobs, int queued) {
    constexpr int kClients = 64;
    const ComputedJob result = package();
    std::atomic<int> next{0};
    std::vector<std::jthread> clients;
    for (int client = 0; client < kClients; ++client) {
        clients.emplace_back([&] {
            for (int i = next++; i < jobs; i = next++) {
                const NewJob job{fmt::format("job {}", i), {"a.obj", 3, sha256_of("abc")}, "{}"};
                if (i < jobs - queued) {
                    store.jobs.add_ready(job, result);
                } else {
                    store.jobs.add(job, std::nullopt);
                }
            }
        });
    }
}

// The yardstick: what a claim can't be faster than, as it has to be on disk.
void time_of_disk(const std::filesystem::path& folder) {
    const FileHandle file(
        ::open((folder / "yardstick").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600));
    const std::array<char, 4096> page{};
    time_of("a page to disk (yardstick)", 200, [&] {
        if (::write(file.fd(), page.data(), page.size()) < 0 || ::fdatasync(file.fd()) != 0) {
            fmt::print("the disk fails\n");
        }
    });
}

}  // namespace

int main(int argc, char** argv) {
    const int jobs = argc > 1 ? std::atoi(argv[1]) : 100000;
    const int queued = argc > 2 ? std::atoi(argv[2]) : 10000;
    const leafcutter::test::TempDir folder;
    {
        Store store(folder.path(), [] {});
        const Clock::time_point begun = Clock::now();
        fill(store, jobs, queued);
        fmt::print("{} jobs, {} of them queued: filled in {:.0f} s\n", jobs, queued,
                   ms_since(begun) / 1000.0);
        std::fflush(stdout);
    }
    std::unique_ptr<Store> opened;
    time_of("open", 1, [&] { opened = std::make_unique<Store>(folder.path(), [] {}); });
    time_of("close", 1, [&opened] { opened.reset(); });
    time_of("open again", 1, [&] { opened = std::make_unique<Store>(folder.path(), [] {}); });
    opened.reset();
    time_of_disk(folder.path());
    Store store(folder.path(), [] {});
    time_of("claim", 200, [&store] { store.jobs.claim(); });
    JobQuery page;
    time_of("list 50", 50, [&store, &page] { store.jobs.list(page); });
    page.limit = 200;
    time_of("list 200", 50, [&store, &page] { store.jobs.list(page); });
    page.state = JobState::Ready;
    time_of("list 200 ready", 50, [&store, &page] { store.jobs.list(page); });
    time_of("queue 500", 50, [&store] { store.jobs.queue(500); });
    time_of("queue counts", 50, [&store] { store.jobs.queue_counts(); });
    time_of("backup", 1, [&store] { store.back_up(1); });
    time_of("check", 1, [&store] { store.check(); });
    return 0;
}
