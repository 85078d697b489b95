#include "server/store/sql/commit_queue.h"

#include <chrono>
#include <deque>
#include <utility>

#include "server/store/store_error.h"

namespace leafcutter::server {

CommitQueue::CommitQueue(std::function<void(const Group&)> commit, std::function<void()> afterwards)
    : commit_(std::move(commit)), afterwards_(std::move(afterwards)) {
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

CommitQueue::~CommitQueue() {
    thread_.request_stop();
    thread_.join();
}

void CommitQueue::run(const SqlDatabase::Work& work, WriteOrder order) {
    Request request;
    request.work = &work;
    request.order = order;
    {
        std::unique_lock lock(mutex_);
        if (closed_) {
            throw StoreError(StoreTrouble::Failed, "the store is closed");
        }
        waiting_.push_back(&request);
        arrived_.notify_one();
        finished_.wait(lock, [&request] { return request.done; });
    }
    if (request.error) {
        std::rethrow_exception(request.error);
    }
}

void CommitQueue::post(const std::string& key, SqlDatabase::Work work) {
    const std::scoped_lock lock(mutex_);
    posted_[key] = std::move(work);
    arrived_.notify_one();
}

void CommitQueue::loop(const std::stop_token& stop) {
    while (true) {
        Group group;
        std::map<std::string, SqlDatabase::Work> posted;
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, stop, [this] { return !waiting_.empty() || !posted_.empty(); });
            if (waiting_.empty() && posted_.empty()) {
                closed_ = true;
                return;
            }
            group.swap(waiting_);
            posted.swap(posted_);
        }
        std::deque<Request> unheard;
        for (const auto& [key, work] : posted) {
            Request& request = unheard.emplace_back();
            request.work = &work;
            request.order = WriteOrder::Beside;
            group.push_back(&request);
        }
        const auto begin = std::chrono::steady_clock::now();
        commit_(group);
        latency_.add(std::chrono::steady_clock::now() - begin);
        {
            const std::scoped_lock lock(mutex_);
            for (Request* request : group) {
                request->done = true;
            }
        }
        finished_.notify_all();
        afterwards_();
    }
}

}  // namespace leafcutter::server
