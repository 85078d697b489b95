// Union-find whose representative is always the smallest member. Internal to geometry.

#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace leafcutter::geometry {

class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }

    std::uint32_t find(std::uint32_t member) {
        while (parent_[member] != member) {
            parent_[member] = parent_[parent_[member]];  // Path halving.
            member = parent_[member];
        }
        return member;
    }

    // Returns whether the two were apart.
    bool unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a == b) {
            return false;
        }
        parent_[a < b ? b : a] = a < b ? a : b;
        return true;
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace leafcutter::geometry
