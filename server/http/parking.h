// Where connections wait, a thousand on one thread, until a whole head of a request has come: slow
// and silent clients cost a buffer here, never a worker.

#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <vector>

namespace leafcutter::server {

struct ParkingLimits {
    std::chrono::milliseconds head_time{5000};   // From a head's first byte to its last.
    std::chrono::milliseconds body_time{10000};  // For a body that is waited for here.
    std::chrono::milliseconds idle_time{30000};  // Between two requests.
    std::chrono::milliseconds drain_time{1000};  // For the last bytes of a refused client.
    std::size_t connections = 1024;  // More: one goes for each that comes.
};

class Parking {
public:
    // Called by the parking thread with a connection and what has been read of it: a whole head and
    // perhaps more. The callee owns the connection then.
    using Ready = std::function<void(int fd, std::string bytes)>;

    // Called for a head that grew too large or too slow; the callee owns the connection then.
    using TooMuch = std::function<void(int fd, int status)>;

    Parking(const ParkingLimits& limits, Ready ready, TooMuch too_much);
    ~Parking();
    Parking(const Parking&) = delete;
    Parking& operator=(const Parking&) = delete;

    // Takes a connection over; `bytes` were read from it already. Any thread.
    void park(int fd, std::string bytes = {});

    // The same for one whose head is whole: it is ready when `wanted` bytes have come in all.
    void park_for_body(int fd, std::string bytes, std::size_t wanted);

    // Takes a connection over whose answer is written: says so, reads on for a moment so that the
    // answer is not lost with what is still coming, and closes.
    void drain(int fd);

private:
    using Clock = std::chrono::steady_clock;

    enum class Stay { Waiting, Draining };

    struct Guest {
        std::string bytes;
        Clock::time_point leaves;
        Stay stay = Stay::Waiting;
        std::size_t wanted = 0;  // 0: a head.
    };

    struct Arrival {
        int fd = -1;
        Guest guest;
    };

    void loop(const std::stop_token& stop);
    void admit_arrivals();
    void serve(int fd);
    void take_if_whole(int fd, Guest& guest);
    void expel_late_ones();
    void send_one_away();
    void leave(int fd);
    void arrive(int fd, Guest guest);

    const ParkingLimits limits_;
    const Ready ready_;
    const TooMuch too_much_;
    int epoll_ = -1;
    int wakeup_ = -1;
    std::unordered_map<int, Guest> guests_;  // Of the thread alone.

    std::mutex mutex_;  // Guards arrivals_.
    std::vector<Arrival> arrivals_;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
