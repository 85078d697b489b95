// Burnt lines, to be looked up by where they lie and grouped by what they touch.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::fab {

struct StrokeLine {
    Eigen::Vector2d from;
    Eigen::Vector2d to;

    double length() const { return (to - from).norm(); }
};

// Finds burnt lines by where they lie.
class LineIndex {
public:
    // `lines` outlives the index.
    explicit LineIndex(const std::vector<StrokeLine>& lines) : lines_(lines) {
        for (std::size_t i = 0; i < lines.size(); ++i) {
            cells_[cell_of((lines[i].from + lines[i].to) / 2.0)].push_back(i);
        }
    }

    struct Hit {
        std::size_t line = 0;
        bool turned = false;
    };

    // The line whose ends lie within `miss` of those of `wanted`.
    std::optional<Hit> find(const StrokeLine& wanted, double miss) const {
        const auto [x, y] = cell_of((wanted.from + wanted.to) / 2.0);
        for (std::int64_t i = x - 1; i <= x + 1; ++i) {
            for (std::int64_t j = y - 1; j <= y + 1; ++j) {
                const auto cell = cells_.find({i, j});
                if (cell == cells_.end()) {
                    continue;
                }
                for (const std::size_t k : cell->second) {
                    if (near(lines_[k].from, wanted.from, miss) &&
                        near(lines_[k].to, wanted.to, miss)) {
                        return Hit{k, false};
                    }
                    if (near(lines_[k].from, wanted.to, miss) &&
                        near(lines_[k].to, wanted.from, miss)) {
                        return Hit{k, true};
                    }
                }
            }
        }
        return std::nullopt;
    }

private:
    static constexpr double kCellMm = 1.0;  // More than any miss.
    using Cell = std::pair<std::int64_t, std::int64_t>;
    struct CellHash {
        std::size_t operator()(const Cell& cell) const {
            return static_cast<std::size_t>(cell.first * 73856093 ^ cell.second * 19349663);
        }
    };

    static Cell cell_of(const Eigen::Vector2d& point) {
        return {std::llround(point.x() / kCellMm), std::llround(point.y() / kCellMm)};
    }
    static bool near(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double miss) {
        return (a - b).squaredNorm() <= miss * miss;
    }

    const std::vector<StrokeLine>& lines_;
    std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells_;
};

// Lines that touch each other, directly or over others; each list sorted, in order of their firsts.
std::vector<std::vector<std::size_t>> connected(const std::vector<StrokeLine>& lines);

}  // namespace leafcutter::fab
