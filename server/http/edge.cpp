#include "server/http/edge.h"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <netdb.h>
#include <semaphore>
#include <sys/socket.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <httplib.h>
#include <spdlog/spdlog.h>

#include "server/http/connection.h"
#include "server/http/harden.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

// What the library reads as a request: a head that we wrote, whose every byte is known. It writes
// to the connection.
class VettedStream : public httplib::Stream {
public:
    VettedStream(Connection& connection, std::string head)
        : connection_(connection), head_(std::move(head)) {}

    bool is_readable() const override { return read_ < head_.size(); }
    bool is_writable() const override { return true; }
    ssize_t read(char* data, size_t size) override {
        const std::size_t part = std::min(size, head_.size() - read_);
        std::memcpy(data, head_.data() + read_, part);
        read_ += part;
        return static_cast<ssize_t>(part);
    }
    ssize_t write(const char* data, size_t size) override {
        return connection_.write_all(data, size) ? static_cast<ssize_t>(size) : -1;
    }
    void get_remote_ip_and_port(std::string& ip, int& port) const override {
        ip.clear();
        port = 0;
    }
    void get_local_ip_and_port(std::string& ip, int& port) const override {
        ip.clear();
        port = 0;
    }
    socket_t socket() const override { return connection_.fd(); }

private:
    Connection& connection_;
    std::string head_;
    std::size_t read_ = 0;
};

// Numeric, as getnameinfo writes it; empty if the connection is gone.
std::string address_of_peer(int fd) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    std::array<char, NI_MAXHOST> text{};
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    if (::getpeername(fd, generic, &size) != 0 ||
        ::getnameinfo(generic, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0) {
        return {};
    }
    const std::string_view mapped = "::ffff:";  // IPv4 on a socket of both kinds.
    std::string result = text.data();
    return result.starts_with(mapped) ? result.substr(mapped.size()) : result;
}

// The library's accept loop hands over connections; parking them takes no thread.
class InlineQueue : public httplib::TaskQueue {
public:
    void enqueue(std::function<void()> task) override { task(); }
    void shutdown() override {}
};

bool send_file_piece(const FilePart& part,
                     std::size_t offset,
                     std::size_t length,
                     httplib::DataSink& sink) {
    std::array<char, 65536> buffer;
    const std::size_t wanted = std::min(length, buffer.size());
    const ssize_t size = ::pread(part.file->fd(), buffer.data(), wanted,
                                 static_cast<off_t>(offset) + static_cast<off_t>(part.offset));
    return size > 0 && sink.write(buffer.data(), static_cast<std::size_t>(size));
}

void fill(httplib::Response& out, const Response& in) {
    out.status = in.status;
    for (const auto& [name, value] : in.headers) {
        out.set_header(name.c_str(), value);
    }
    if (in.events) {
        // The head goes out; the stream itself is the hub's, who takes the connection over.
        out.set_chunked_content_provider("text/event-stream",
                                         [](std::size_t, httplib::DataSink&) { return false; });
    } else if (in.file && in.file->bytes > 0) {
        out.set_content_provider(
            static_cast<std::size_t>(in.file->bytes), in.content_type.c_str(),
            [part = *in.file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                return send_file_piece(part, offset, length, sink);
            });
    } else if (in.status != 204) {
        out.set_content(in.body, in.content_type.c_str());
    }
}

}  // namespace

class Edge::Server : public httplib::Server {
public:
    Server(const EdgeOptions& options, RequestHandler handler, EventHub& hub)
        : options_(options),
          handler_(std::move(handler)),
          hub_(hub),
          bulk_places_(static_cast<int>(std::max(3U, options.workers)) - 2),
          parking_(
              options.parking,
              [this](int fd, std::string bytes) {
                  enqueue({fd, std::move(bytes)});
              },
              [this](int fd, int status) { refuse(fd, status); }) {
        new_task_queue = [] { return new InlineQueue; };
        set_keep_alive_timeout(options.parking.idle_time.count() / 1000);
        set_pre_routing_handler([this](const httplib::Request&, httplib::Response& out) {
            answer(*in_hand, out);
            return HandlerResponse::Handled;
        });
        listen_on();
    }

    void start() {
        for (unsigned i = 0; i < std::max(3U, options_.workers); ++i) {
            workers_.emplace_back([this](const std::stop_token& token) { work(token); });
        }
        acceptor_ = std::jthread([this] {
            listen_after_bind();
            accept_ended_ = true;
        });
    }

    ~Server() override {
        if (acceptor_.joinable()) {
            while (!is_running() && !accept_ended_) {
                std::this_thread::yield();  // stop() has no effect on a loop that did not begin.
            }
            stop();
            acceptor_.join();
        }
        for (std::jthread& worker : workers_) {
            worker.request_stop();
        }
        workers_.clear();
        for (const Task& task : tasks_) {
            ::close(task.fd);
        }
    }

    int port() const { return port_; }

private:
    struct Task {
        int fd = -1;
        std::string bytes;
    };

    // One request in the hands of a worker.
    struct Exchange {
        Connection& connection;
        VettedHead& head;
        std::optional<EventSubscription> events;
    };

    bool process_and_close_socket(socket_t fd) override {
        if (const int low = with_low_number(fd, options_.most_fd); low >= 0) {
            parking_.park(low);
        }
        return true;
    }

    void listen_on() {
        // Without SO_REUSEPORT, which would let a second daemon share the port silently.
        set_socket_options([](socket_t fd) {
            const int yes = 1;
            ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        set_tcp_nodelay(true);
        port_ = options_.port;
        bool bound = false;
        if (options_.port == 0) {
            port_ = bind_to_any_port(options_.address);
            bound = port_ > 0;
        } else {
            bound = bind_to_port(options_.address, options_.port);
        }
        if (!bound) {
            throw CannotListen(fmt::format(
                "cannot listen on {}:{}: {}; is another daemon running? "
                "name another address with --listen",
                options_.address, options_.port, std::generic_category().message(errno)));
        }
        constexpr int kBacklog = 512;
        ::listen(svr_sock_, kBacklog);
    }

    void enqueue(Task task) {
        {
            const std::scoped_lock lock(mutex_);
            tasks_.push_back(std::move(task));
        }
        arrived_.notify_one();
    }

    void work(const std::stop_token& token) {
        while (true) {
            Task task;
            {
                std::unique_lock lock(mutex_);
                if (!arrived_.wait(lock, token, [this] { return !tasks_.empty(); })) {
                    return;
                }
                task = std::move(tasks_.front());
                tasks_.pop_front();
            }
            try {
                serve(task);
            } catch (const std::exception& error) {  // A thread's top: one connection is lost.
                spdlog::error("http worker: {}", error.what());
                ::close(task.fd);
            }
        }
    }

    void serve(Task& task) {
        const std::size_t end = task.bytes.find("\r\n\r\n") + 4;
        auto vetted = vet_head(std::string_view(task.bytes).substr(0, end), options_.rules,
                               address_of_peer(task.fd));
        if (const auto* refusal = std::get_if<Refusal>(&vetted)) {
            refuse(task.fd, *refusal);
            return;
        }
        VettedHead& head = std::get<VettedHead>(vetted);
        const std::size_t whole = end + static_cast<std::size_t>(head.request.body.bytes);
        if (head.request.body.bytes <= options_.parked_body_bytes && task.bytes.size() < whole) {
            wait_for_body(task, whole, head.expects_continue);
            return;
        }
        Connection connection(task.fd, task.bytes.substr(end),
                              {options_.patience, options_.least_bytes_per_s});
        connection.expect_body(head.request.body.bytes, head.expects_continue);
        Exchange exchange{connection, head, std::nullopt};
        in_hand = &exchange;
        VettedStream stream(
            connection, fmt::format("{} / HTTP/1.1\r\nHost: localhost\r\nConnection: {}\r\n\r\n",
                                    head.request.method, head.keep_alive ? "keep-alive" : "close"));
        bool closed = false;
        const bool written = process_request(stream, !head.keep_alive, closed, nullptr);
        in_hand = nullptr;
        if (exchange.events) {
            hub_.adopt(task.fd, *exchange.events);
        } else if (written && !closed && head.keep_alive && connection.body_left() == 0) {
            parking_.park(task.fd, connection.take_early());
        } else {
            parking_.drain(task.fd);
        }
    }

    void wait_for_body(Task& task, std::size_t whole, bool expects_continue) {
        constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
        if (expects_continue) {
            // Few enough bytes for any empty buffer; a client that has it full gets no answer.
            ::send(task.fd, kContinue.data(), kContinue.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        }
        parking_.park_for_body(task.fd, std::move(task.bytes), whole);
    }

    void answer(Exchange& exchange, httplib::Response& out) {
        Response response = respond(exchange);
        harden(response);
        if (response.events && hub_.clients() >= options_.most_streams) {
            response = problem_response({503, "busy", "too many streams of live events"});
        }
        if (response.events && exchange.head.request.method != "HEAD") {
            exchange.events = response.events;
        }
        if (exchange.connection.body_left() > 0) {
            exchange.head.keep_alive = false;  // An unread body would be taken for a request.
            response.headers["Connection"] = "close";
        }
        fill(out, response);
    }

    Response respond(Exchange& exchange) {
        Request& request = exchange.head.request;
        if (request.body.bytes > options_.most_body_bytes) {
            return problem_response({413, "too-large", "the body is larger than 256 MB"});
        }
        request.body.read = [&connection = exchange.connection](std::span<char> room) {
            return connection.read_body(room);
        };
        const bool is_bulk = request.body.bytes > options_.parked_body_bytes;
        if (is_bulk && !bulk_places_.try_acquire()) {
            return problem_response({503, "busy", "too many large transfers at once"});
        }
        Response response;
        try {
            response = handler_(request);
        } catch (const std::exception& error) {
            response = response_to(error);
        }
        if (is_bulk) {
            bulk_places_.release();
        }
        return take_bulk_place_for_file(std::move(response));
    }

    // A large answer keeps its worker busy until the last byte: the place is freed with the file.
    Response take_bulk_place_for_file(Response response) {
        if (!response.file || response.file->bytes <= options_.bulk_file_bytes) {
            return response;
        }
        if (!bulk_places_.try_acquire()) {
            return problem_response({503, "busy", "too many large transfers at once"});
        }
        const std::shared_ptr<FileHandle> file = response.file->file;
        response.file->file = std::shared_ptr<FileHandle>(
            file.get(), [this, file](FileHandle*) { bulk_places_.release(); });
        return response;
    }

    void refuse(int fd, int status) {
        const std::string code = status == 408   ? "too-slow"
                                 : status == 503 ? "busy"
                                                 : "head-too-large";
        refuse(fd, Refusal{status, code, "the request was not taken"});
    }

    // Written by hand and without waiting: a refused client gets no more of our time.
    void refuse(int fd, const Refusal& refusal) {
        const Response response = problem_response({refusal.status, refusal.code, refusal.detail});
        const std::string text = fmt::format(
            "HTTP/1.1 {} Refused\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
            "X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n{}",
            response.status, response.content_type, response.body.size(), response.body);
        [[maybe_unused]] const ssize_t sent =
            ::send(fd, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        parking_.drain(fd);
    }

    static thread_local Exchange* in_hand;  // The worker's; the library's handler can't carry it.

    const EdgeOptions options_;
    const RequestHandler handler_;
    EventHub& hub_;
    int port_ = 0;
    std::counting_semaphore<> bulk_places_;
    std::atomic<bool> accept_ended_{false};

    std::mutex mutex_;  // Guards tasks_.
    std::condition_variable_any arrived_;
    std::deque<Task> tasks_;

    Parking parking_;
    std::vector<std::jthread> workers_;
    std::jthread acceptor_;
};

thread_local Edge::Server::Exchange* Edge::Server::in_hand = nullptr;

Edge::Edge(const EdgeOptions& options, RequestHandler handler, EventHub& hub)
    : server_(std::make_unique<Server>(options, std::move(handler), hub)) {}

Edge::~Edge() = default;

void Edge::start() {
    server_->start();
}

int Edge::port() const {
    return server_->port();
}

}  // namespace leafcutter::server
