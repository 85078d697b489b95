// Work of many threads that one thread commits in groups: one sync to disk carries all that waits.

#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/latency_histogram.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

class CommitQueue {
public:
    struct Request {
        const SqlDatabase::Work* work = nullptr;
        WriteOrder order = WriteOrder::Alone;
        std::exception_ptr error;  // Set by whoever commits.
        bool done = false;
    };
    using Group = std::vector<Request*>;

    // `commit` is called by the queue's thread with a group that is not empty, and `afterwards`
    // when those who asked have heard of it. They throw nothing.
    CommitQueue(std::function<void(const Group&)> commit, std::function<void()> afterwards);

    // Returns when all that waits is committed.
    ~CommitQueue();
    CommitQueue(const CommitQueue&) = delete;
    CommitQueue& operator=(const CommitQueue&) = delete;

    // Returns when `work` is committed; throws what it or the commit threw. Throws StoreError after
    // the end.
    void run(const SqlDatabase::Work& work, WriteOrder order);

    // Returns at once; of the same key the newest work counts, and nobody hears of its failure.
    void post(const std::string& key, SqlDatabase::Work work);

    // Of every group.
    const LatencyHistogram& latency() const { return latency_; }

private:
    void loop(const std::stop_token& stop);

    const std::function<void(const Group&)> commit_;
    const std::function<void()> afterwards_;
    LatencyHistogram latency_;

    std::mutex mutex_;  // Guards the members below.
    std::condition_variable_any arrived_;
    std::condition_variable finished_;
    Group waiting_;
    std::map<std::string, SqlDatabase::Work> posted_;
    bool closed_ = false;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
