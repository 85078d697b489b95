// The HTTP server: cpp-httplib's listening and writing behind a front that vets every head, parks
// every idle connection, budgets every body, and hands event streams to the hub. Stock cpp-httplib
// 0.11 can be killed or frozen by single requests; here it parses nothing that a client wrote.

#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "server/http/event_hub.h"
#include "server/http/head.h"
#include "server/http/parking.h"
#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

// The address can't be listened on; the message says why and what to do.
class CannotListen : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct EdgeOptions {
    std::string address = "127.0.0.1";
    int port = 8080;  // 0: any free one.
    unsigned workers = 8;
    HeadRules rules;
    ParkingLimits parking;
    int most_fd = 1 << 20;  // Of a connection: other files must find room.
    std::size_t most_streams = 1 << 20;
    std::int64_t most_body_bytes = 256LL << 20;

    // Bodies up to this are waited for among the parked connections, so that a slow one holds no
    // worker up.
    std::int64_t parked_body_bytes = 16384;

    // Larger bodies, and files above this, take one of workers - 2 bulk places: two workers are
    // always left for a stop or a hold.
    std::int64_t bulk_file_bytes = 262144;

    std::chrono::milliseconds patience{10000};  // For any single read or write.
    std::int64_t least_bytes_per_s = 16384;     // Of a body, after `patience`.
};

using RequestHandler = std::function<Response(Request&)>;

class Edge {
public:
    // Takes the address, answers nobody yet. `handler` is called from the workers; what it throws
    // is translated to a problem. Throws CannotListen.
    Edge(const EdgeOptions& options, RequestHandler handler, EventHub& hub);

    // Ends every connection but those of the hub.
    ~Edge();
    Edge(const Edge&) = delete;
    Edge& operator=(const Edge&) = delete;

    void start();
    int port() const;

private:
    class Server;

    std::unique_ptr<Server> server_;
};

}  // namespace leafcutter::server
