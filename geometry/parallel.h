// Independent pieces of work on the threads that a Context allows.

#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <stop_token>
#include <thread>
#include <vector>

#include "geometry/context.h"

namespace leafcutter::geometry {

// Calls work(i) for every i in [0, count), in any order and from several threads at once. `work`
// may not throw, and may write only what belongs to i: then results don't depend on the thread
// count. Throws Cancelled after a stop request; some calls are then left out.
template <typename Work>
void for_each_index(std::size_t count, const Context& context, const Work& work) {
    constexpr std::size_t kChunk = 64;
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        while (!context.stop.stop_requested()) {
            const std::size_t begin = next.fetch_add(kChunk);
            if (begin >= count) {
                return;
            }
            for (std::size_t i = begin; i < std::min(begin + kChunk, count); ++i) {
                work(i);
            }
        }
    };
    {
        std::vector<std::jthread> others;
        const std::size_t useful = (count + kChunk - 1) / kChunk;
        for (std::size_t i = 1; i < std::min<std::size_t>(context.threads, useful); ++i) {
            others.emplace_back(run);
        }
        run();
    }
    context.check();
}

// Calls work(i, context) for every i in [0, count), largest pieces of work each, in any order and
// from several threads at once. The context handed on has one thread and tells no progress. `work`
// may write only what belongs to i. If some throw, what the smallest i threw goes on to the caller.
template <typename Work>
void for_each_task(std::size_t count, const Context& context, const Work& work) {
    Context own = context;
    own.threads = 1;
    own.progress = nullptr;
    std::vector<std::exception_ptr> failures(count);
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
            try {
                own.check();
                work(i, own);
            } catch (...) {
                failures[i] = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < std::min<std::size_t>(context.threads, count); ++i) {
            others.emplace_back(run);
        }
        run();
    }
    for (const std::exception_ptr& failure : failures) {
        if (failure) {
            std::rethrow_exception(failure);
        }
    }
    context.check();
}

}  // namespace leafcutter::geometry
