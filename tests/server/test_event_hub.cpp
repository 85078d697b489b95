// No listener misses an event, whatever happens to the store and however much there is at once.

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/http/event_hub.h"

namespace leafcutter::server {
namespace {

// A log of events in memory that can be out of reach.
class Log {
public:
    EventSource source() {
        EventSource source;
        source.last_seq = [this] { return last_.load(); };
        source.stored_after = [this](std::int64_t after, int limit) {
            if (failures_.fetch_sub(1) > 0) {
                throw std::runtime_error("out of reach");
            }
            std::vector<StoredEvent> events;
            for (std::int64_t seq = after + 1; seq <= last_ && seq <= after + limit; ++seq) {
                events.push_back({seq, "job", "", std::string(bytes_, 'x')});
            }
            return events;
        };
        source.passing = [](const std::string&, const std::string&) {
            return std::optional<PassingEvent>();
        };
        source.snapshot = [](std::int64_t, const std::optional<std::string>&) {
            return std::string("{}");
        };
        source.may_listen = [](const Caller&) { return true; };
        return source;
    }

    std::atomic<std::int64_t> last_{0};
    std::atomic<int> failures_{0};
    std::size_t bytes_ = 10;
};

// Reads until it was told of `last`; all the ids it was told of.
std::vector<std::int64_t> ids_until(int fd, std::int64_t last) {
    std::string text;
    std::vector<std::int64_t> ids;
    std::size_t at = 0;
    std::vector<char> buffer(65536);
    while (ids.empty() || ids.back() != last) {
        const ssize_t size = ::recv(fd, buffer.data(), buffer.size(), 0);
        if (size <= 0) {
            break;
        }
        text.append(buffer.data(), static_cast<std::size_t>(size));
        for (std::size_t found = text.find("id: ", at);
             found != std::string::npos && text.find('\n', found) != std::string::npos;
             found = text.find("id: ", at)) {
            at = found + 4;
            ids.push_back(std::stoll(text.substr(at)));
        }
    }
    return ids;
}

std::vector<std::int64_t> counted(std::int64_t first, std::int64_t last) {
    std::vector<std::int64_t> numbers;
    for (std::int64_t number = first; number <= last; ++number) {
        numbers.push_back(number);
    }
    return numbers;
}

class EventHubTest : public ::testing::Test {
protected:
    EventHubTest() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_), 0); }
    ~EventHubTest() override { ::close(ends_[0]); }

    void listen_after(std::int64_t seen) {
        EventSubscription subscription;
        subscription.last_seen = seen;
        hub_.adopt(ends_[1], subscription);
    }

    Log log_;
    int ends_[2] = {-1, -1};
    EventHub hub_{log_.source()};
};

TEST_F(EventHubTest, WhoComesBackDuringAnOutageMissesNothing) {
    log_.last_ = 20;
    hub_.start();
    hub_.wake();
    log_.failures_ = 3;
    listen_after(5);
    while (log_.failures_ > 0) {
        hub_.wake();
    }
    log_.last_ = 25;
    hub_.wake();
    EXPECT_EQ(ids_until(ends_[0], 25), counted(6, 25));
}

TEST_F(EventHubTest, MoreAtOnceThanABufferHoldsHasNoGap) {
    log_.bytes_ = 5000;
    hub_.start();
    listen_after(0);
    while (hub_.clients() == 0) {
    }
    log_.last_ = 150;  // In one round, ten times what is kept for a slow client.
    hub_.wake();
    const std::vector<std::int64_t> ids = ids_until(ends_[0], 150);
    // Either all of it, or a beginning and then the end of the stream, to come back with.
    EXPECT_EQ(ids, counted(1, static_cast<std::int64_t>(ids.size())));
    EXPECT_GT(ids.size(), 10U);
}

}  // namespace
}  // namespace leafcutter::server
