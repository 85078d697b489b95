// Independent pieces of work on the threads that a Context allows.

#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
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

}  // namespace leafcutter::geometry
