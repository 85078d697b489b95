#include "server/store/postgres/database.h"

#include <condition_variable>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/crash_point.h"
#include "server/store/postgres/errors.h"
#include "server/store/postgres/schema.h"
#include "server/store/postgres/session.h"

namespace leafcutter::server {

using namespace std::chrono_literals;

namespace {

constexpr auto kPatience = 4s;  // For an answer.
constexpr auto kSilence = 1s;   // After which the link is tried.
constexpr auto kSlice = 50ms;   // A stop waits no longer.
constexpr auto kTryAgain = 300ms;

// Whoever writes alone holds it for itself, those who write beside each other share it.
constexpr int kWriteLock = 0x1eafc;

std::string begin_statement(WriteOrder order) {
    return fmt::format("BEGIN; SELECT pg_advisory_xact_lock{}({})",
                       order == WriteOrder::Beside ? "_shared" : "", kWriteLock);
}

WriteOrder order_of(const CommitQueue::Group& group) {
    for (const CommitQueue::Request* request : group) {
        if (request->order == WriteOrder::Alone) {
            return WriteOrder::Alone;
        }
    }
    return WriteOrder::Beside;
}

bool pause(const std::stop_token& stop, std::chrono::milliseconds time) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    return !never.wait_for(lock, stop, time, [&stop] { return stop.stop_requested(); });
}

// A server that was started together with us may need a moment.
std::unique_ptr<PgConnection> first_connection(const std::string& uri) {
    constexpr auto kMost = 20s;
    const auto until = std::chrono::steady_clock::now() + kMost;
    while (true) {
        try {
            return std::make_unique<PgConnection>(uri, kPatience);
        } catch (const PgError& error) {
            if (std::chrono::steady_clock::now() >= until) {
                throw DatabaseUnusable(fmt::format("the database: {}", error.what()));
            }
        }
        pause({}, kTryAgain);
    }
}

}  // namespace

PgDatabase::PgDatabase(std::string uri, PgHooks hooks)
    : uri_(std::move(uri)), hooks_(std::move(hooks)), writer_(first_connection(uri_)) {
    where_ = writer_->where();
    try {
        migrate(*writer_);
    } catch (const PgError& error) {
        throw DatabaseUnusable(fmt::format("the database {}: {}", where_, error.what()));
    }
    queue_ =
        std::make_unique<CommitQueue>([this](const CommitQueue::Group& group) { commit(group); },
                                      [this] {
                                          if (hooks_.on_change) {
                                              hooks_.on_change();
                                          }
                                      });
    watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

PgDatabase::~PgDatabase() {
    watcher_.request_stop();
    watcher_.join();
    queue_.reset();
}

std::string PgDatabase::trouble() const {
    const std::scoped_lock lock(mutex_);
    return trouble_;
}

void PgDatabase::note_lost(const char* why) const {
    const std::scoped_lock lock(mutex_);
    idle_readers_.clear();
    if (trouble_.empty()) {
        trouble_ = fmt::format("the database {} is out of reach: {}", where_, why);
        spdlog::warn(trouble_);
    }
}

void PgDatabase::note_back() {
    const std::scoped_lock lock(mutex_);
    if (!trouble_.empty()) {
        spdlog::info("the database {} is back", where_);
        trouble_.clear();
    }
}

void PgDatabase::check_reachable() const {
    const std::scoped_lock lock(mutex_);
    if (!trouble_.empty()) {
        throw StoreError(StoreTrouble::Busy, trouble_);
    }
}

void PgDatabase::write(const Work& work, WriteOrder order) {
    check_reachable();
    try {
        queue_->run(work, order);
    } catch (const PgError& error) {
        throw store_error_of(error);
    }
}

void PgDatabase::write_soon(const std::string& key, const Work& work) {
    if (trouble().empty()) {
        queue_->post(key, work);
    }
}

void PgDatabase::pass_on(const std::string& key, const std::string& text) {
    constexpr std::size_t kLongest = 7900;  // A notice's payload ends at 8000 bytes.
    if (text.size() > kLongest) {
        return;
    }
    write_soon(fmt::format("passing {}", key), [text](SqlSession& session) {
        SqlStatement notify(session, "SELECT pg_notify('leafcutter_passing', ?)");
        notify.bind(1, text);
        notify.step();
    });
}

void PgDatabase::commit(const CommitQueue::Group& group) {
    if (try_commit(group)) {
        return;
    }
    // They stood in somebody's way: one by one.
    for (CommitQueue::Request* request : group) {
        constexpr int kTries = 3;
        request->error = nullptr;
        for (int i = 0; i < kTries && !try_commit({request}); ++i) {
            request->error = nullptr;
        }
    }
}

// False for a conflict with others: nothing was done, and the same may be tried again.
bool PgDatabase::try_commit(const CommitQueue::Group& group) {
    bool again = false;
    try {
        if (!writer_) {
            writer_ = std::make_unique<PgConnection>(uri_, kPatience);
        }
        writer_->run(begin_statement(order_of(group)));
        PgSession session(*writer_);
        for (CommitQueue::Request* request : group) {
            const std::size_t told = session.events();
            writer_->run(request == group.front() ? "SAVEPOINT request"
                                                  : "RELEASE request; SAVEPOINT request");
            try {
                (*request->work)(session);
            } catch (const PgError& error) {
                if (error.is_lost() || is_conflict(error)) {
                    throw;
                }
                request->error = std::current_exception();
            } catch (...) {  // Travels to whoever asked; the others of the group go on.
                request->error = std::current_exception();
            }
            if (request->error) {
                writer_->run("ROLLBACK TO request");
                session.forget_events_after(told);
            }
        }
        const bool told = session.write_events();
        crash_point("commit.before");
        writer_->run(told ? fmt::format("NOTIFY {}; COMMIT", kEventChannel) : "COMMIT");
        crash_point("commit.after");
        return true;
    } catch (const PgError& error) {
        const std::exception_ptr thrown = std::current_exception();
        again = is_conflict(error);
        // Whatever state the connection is in: a new one has none.
        writer_.reset();
        if (error.is_lost()) {
            note_lost(error.what());
        }
        for (CommitQueue::Request* request : group) {
            request->error = thrown;
        }
    }
    return !again;
}

std::unique_ptr<PgConnection> PgDatabase::take_reader() const {
    {
        const std::scoped_lock lock(mutex_);
        if (!idle_readers_.empty()) {
            std::unique_ptr<PgConnection> reader = std::move(idle_readers_.back());
            idle_readers_.pop_back();
            return reader;
        }
    }
    return std::make_unique<PgConnection>(uri_, kPatience);
}

void PgDatabase::read(const Work& work) const {
    check_reachable();
    try {
        std::unique_ptr<PgConnection> reader = take_reader();
        reader->run("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
        PgSession session(*reader);
        work(session);
        reader->run("COMMIT");
        const std::scoped_lock lock(mutex_);
        idle_readers_.push_back(std::move(reader));
    } catch (const PgError& error) {
        if (error.is_lost()) {
            note_lost(error.what());
        }
        throw store_error_of(error);
    }
}

void PgDatabase::watch(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            listen(stop);
        } catch (const PgError& error) {
            note_lost(error.what());
        }
        pause(stop, kTryAgain);
    }
}

void PgDatabase::listen(const std::stop_token& stop) {
    PgConnection listener(uri_, kPatience);
    listener.run("LISTEN leafcutter_events; LISTEN leafcutter_passing");
    note_back();
    tell({{kEventChannel, ""}});  // What happened meanwhile was announced to nobody.
    auto heard = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
        const std::vector<PgNotice> notices = listener.notices(kSlice);
        const auto now = std::chrono::steady_clock::now();
        // Another connection may have been lost alone: an old one, after an outage.
        const bool doubted = !trouble().empty();
        if (doubted || now - heard >= kSilence) {
            listener.run("SELECT 1");
            heard = now;
        }
        if (doubted) {
            note_back();
        }
        tell(notices);
    }
}

void PgDatabase::tell(const std::vector<PgNotice>& notices) {
    bool changed = false;
    for (const PgNotice& notice : notices) {
        if (notice.channel == kEventChannel) {
            changed = true;
        } else if (hooks_.on_passing) {
            hooks_.on_passing(notice.payload);
        }
    }
    if (changed && hooks_.on_change) {
        hooks_.on_change();
    }
}

}  // namespace leafcutter::server
