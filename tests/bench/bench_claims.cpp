// How fast nodes claim and settle jobs on PostgreSQL, beside what that server does of the bare
// statements in the same run, and how long an event takes from one node to another.
//
// bench_claims [SECONDS=4]: a table on stdout. One claim and settlement are two commits.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "server/store/blobs.h"
#include "server/store/postgres/connection.h"
#include "server/store/postgres/engine.h"
#include "tests/support/pg_server.h"

namespace leafcutter::server {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begun) {
    return std::chrono::duration<double>(Clock::now() - begun).count();
}

// Calls `step` on so many threads for so long; steps per second. False ends a thread.
double rate_of(int threads, double seconds, const std::function<bool(int thread)>& step) {
    std::atomic<int> steps{0};
    const Clock::time_point begun = Clock::now();
    {
        std::vector<std::jthread> workers;
        for (int i = 0; i < threads; ++i) {
            workers.emplace_back([&, i] {
                while (seconds_since(begun) < seconds && step(i)) {
                    ++steps;
                }
            });
        }
    }
    return steps / seconds_since(begun);
}

constexpr int kQueued = 20000;
constexpr std::chrono::seconds kPatience{10};

// The claim and the settlement alone, on a table with nothing else.
class BareQueue {
public:
    explicit BareQueue(const std::string& uri) : uri_(uri) {
        PgConnection connection(uri_, kPatience);
        connection.run(
            "CREATE TABLE bare(id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, state text NOT "
            "NULL, attempt int NOT NULL DEFAULT 0, fence bigint NOT NULL DEFAULT 0, owner text, "
            "lease_until timestamptz);"
            "CREATE INDEX bare_ready ON bare(id) WHERE state = 'queued';"
            "INSERT INTO bare(state) SELECT 'queued' FROM generate_series(1, 200000);"
            "ANALYZE bare");
    }

    double rate(int clients, double seconds) const {
        std::vector<std::unique_ptr<PgConnection>> connections;
        for (int i = 0; i < clients; ++i) {
            connections.push_back(std::make_unique<PgConnection>(uri_, kPatience));
        }
        return rate_of(clients, seconds, [&connections](int client) {
            PgConnection& connection = *connections[static_cast<std::size_t>(client)];
            const PgRows claimed = connection.run(
                "UPDATE bare SET state = 'leased', owner = $1, fence = fence + 1, attempt = "
                "attempt + 1, lease_until = now() + interval '30 s' WHERE id = (SELECT id FROM "
                "bare WHERE state = 'queued' ORDER BY id FOR UPDATE SKIP LOCKED LIMIT 1) "
                "RETURNING id, fence",
                {std::to_string(client)});
            if (claimed.size() == 0) {
                return false;
            }
            connection.run("UPDATE bare SET state = 'done' WHERE id = $1 AND fence = $2",
                           {std::string(claimed.at(0, 0)), std::string(claimed.at(0, 1))});
            return true;
        });
    }

private:
    const std::string uri_;
};

NewJob some_job() {
    return {"plate.off", {"plate.off", 360, sha256_of("plate")}, "{}"};
}

// Each node claims and settles with so many threads; the queue is filled before.
double rate_of_nodes(const std::string& uri, int nodes, int threads_each, double seconds) {
    std::vector<std::unique_ptr<Engine>> engines;
    for (int i = 0; i < nodes; ++i) {
        engines.push_back(
            open_postgres(uri, {fmt::format("n{}", i), std::chrono::seconds(30)}, {}).engine);
    }
    return rate_of(nodes * threads_each, seconds, [&](int thread) {
        JobStore& jobs = engines[static_cast<std::size_t>(thread % nodes)]->jobs();
        const auto job = jobs.claim();
        if (!job) {
            return false;
        }
        ComputedJob result;
        result.summary_json = "{}";
        return jobs.finish({job->id, job->fence}, result);
    });
}

void fill(const std::string& uri) {
    const auto engine = open_postgres(uri, {"filler", std::chrono::seconds(30)}, {}).engine;
    engine->jobs().add(some_job(), std::nullopt);
    PgConnection connection(uri, kPatience);
    connection.run(fmt::format(
        "INSERT INTO job(id, name, state, created_ms, updated_ms, file_name, file_bytes, "
        "file_sha256, params) SELECT id || '-' || n, name, state, created_ms, updated_ms, "
        "file_name, file_bytes, file_sha256, params FROM job, generate_series(1, {}) AS n; "
        "UPDATE job SET place = ordinal; ANALYZE job",
        kQueued));
}

// From the call that adds a job at one node until another one has read its event.
std::vector<double> event_delays_ms(const std::string& uri, int count) {
    std::mutex mutex;
    std::condition_variable changed;
    bool news = false;
    PgHooks hooks;
    hooks.on_change = [&] {
        const std::scoped_lock lock(mutex);
        news = true;
        changed.notify_one();
    };
    const NodeScope scope{"teller", std::chrono::seconds(30)};
    const auto teller = open_postgres(uri, scope, {}).engine;
    const auto listener = open_postgres(uri, {"listener", std::chrono::seconds(30)}, hooks).engine;
    std::vector<double> delays;
    for (int i = 0; i < count; ++i) {
        const std::int64_t before = listener->events().last_seq();
        const Clock::time_point begun = Clock::now();
        teller->jobs().add(some_job(), std::nullopt);
        while (listener->events().after(before, 1).empty()) {
            std::unique_lock lock(mutex);
            changed.wait_for(lock, std::chrono::seconds(5), [&news] { return news; });
            news = false;
        }
        constexpr double kMilli = 1e3;
        delays.push_back(kMilli * seconds_since(begun));
    }
    std::sort(delays.begin(), delays.end());
    return delays;
}

void run(double seconds) {
    test::PgServer& server = test::PgServer::shared();
    server.create_space("bench");
    const std::string uri = server.uri("bench");
    fill(uri);
    const BareQueue bare(uri);
    std::printf("| at a time | PostgreSQL bare, jobs/s | Leafcutter, jobs/s | ratio |\n");
    std::printf("|---|---|---|---|\n");
    for (const int clients : {1, 4, 8}) {
        const double yardstick = bare.rate(clients, seconds);
        const double ours = rate_of_nodes(uri, clients, 1, seconds);
        std::printf("| %d nodes | %.0f | %.0f | %.2f |\n", clients, yardstick, ours,
                    ours / yardstick);
    }
    const double one_node = rate_of_nodes(uri, 1, 8, seconds);
    std::printf("| 1 node, 8 workers | | %.0f | |\n", one_node);
    const std::vector<double> delays = event_delays_ms(uri, 200);
    std::printf("event at another node: median %.1f ms, 99 %% %.1f ms, longest %.1f ms\n",
                delays[delays.size() / 2], delays[delays.size() * 99 / 100], delays.back());
}

}  // namespace
}  // namespace leafcutter::server

int main(int argc, char** argv) {
    if (!leafcutter::test::PgServer::is_installed()) {
        std::fprintf(stderr, "PostgreSQL 15 is not installed\n");
        return 77;
    }
    leafcutter::server::run(argc > 1 ? std::stod(argv[1]) : 4.0);
    return 0;
}
