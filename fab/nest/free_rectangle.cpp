#include "fab/nest/free_rectangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fab/nest/collision.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

constexpr int kCells = 256;  // Along the longer side.

class FreeCells {
public:
    explicit FreeCells(std::span<const Ring> rings) : rings_(rings), box_(bounds(rings.front())) {
        const Eigen::Vector2d size = box_.size();
        cell_ = size.maxCoeff() / kCells;
        columns_ = std::max(1, static_cast<int>(size.x() / cell_));
        rows_ = std::max(1, static_cast<int>(size.y() / cell_));
        blocked_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
        for (const Ring& ring : rings) {
            for (std::size_t i = 0; i < ring.size(); ++i) {
                block(ring[i], ring[(i + 1) % ring.size()]);
            }
        }
        for (int row = 0; row < rows_; ++row) {
            block_outside(row);
        }
    }

    // By columns of free cells that end in a row: the widest run for each height.
    Box largest() const {
        std::vector<int> height(static_cast<std::size_t>(columns_), 0);
        double best_area = 0.0;
        Box best;
        for (int row = 0; row < rows_; ++row) {
            for (int column = 0; column < columns_; ++column) {
                int& tall = height[static_cast<std::size_t>(column)];
                tall = is_blocked(row, column) ? 0 : tall + 1;
            }
            try_row(row, height, best_area, best);
        }
        return best;
    }

private:
    void try_row(int row, const std::vector<int>& height, double& best_area, Box& best) const {
        std::vector<int> open;  // Columns of rising height.
        for (int column = 0; column <= columns_; ++column) {
            const int here = column < columns_ ? height[static_cast<std::size_t>(column)] : -1;
            while (!open.empty() && height[static_cast<std::size_t>(open.back())] >= here) {
                const int tall = height[static_cast<std::size_t>(open.back())];
                open.pop_back();
                const int from = open.empty() ? 0 : open.back() + 1;
                const double area = static_cast<double>(column - from) * tall;
                if (area > best_area) {
                    best_area = area;
                    best.low = box_.low + cell_ * Eigen::Vector2d(from, row + 1 - tall);
                    best.high = box_.low + cell_ * Eigen::Vector2d(column, row + 1);
                }
            }
            open.push_back(column);
        }
    }

    bool is_blocked(int row, int column) const {
        return blocked_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(column)] != 0;
    }

    void block_cells(int row, double from, double to) {
        if (row < 0 || row >= rows_) {
            return;
        }
        const int first = std::max(0, static_cast<int>(std::floor(from)));
        const int last = std::min(columns_ - 1, static_cast<int>(std::floor(to)));
        for (int column = first; column <= last; ++column) {
            blocked_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                     static_cast<std::size_t>(column)] = 1;
        }
    }

    // All cells that an edge passes.
    void block(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
        Eigen::Vector2d a = (from - box_.low) / cell_;
        Eigen::Vector2d b = (to - box_.low) / cell_;
        if (a.y() > b.y()) {
            std::swap(a, b);
        }
        const int first = static_cast<int>(std::floor(a.y()));
        const int last = static_cast<int>(std::floor(b.y()));
        for (int row = first; row <= last; ++row) {
            const double rise = b.y() - a.y();
            const double s = rise > 0.0 ? std::clamp((row - a.y()) / rise, 0.0, 1.0) : 0.0;
            const double t = rise > 0.0 ? std::clamp((row + 1 - a.y()) / rise, 0.0, 1.0) : 1.0;
            const double x0 = a.x() + s * (b.x() - a.x());
            const double x1 = a.x() + t * (b.x() - a.x());
            block_cells(row, std::min(x0, x1), std::max(x0, x1));
        }
    }

    // Cells that no edge passes lie inside or outside as a whole.
    void block_outside(int row) {
        bool known = false;
        bool outside = false;
        for (int column = 0; column < columns_; ++column) {
            if (is_blocked(row, column)) {
                known = false;
                continue;
            }
            if (!known) {
                known = true;
                outside = is_outside(box_.low + cell_ * Eigen::Vector2d(column + 0.5, row + 0.5));
            }
            if (outside) {
                block_cells(row, column, column);
            }
        }
    }

    bool is_outside(const Eigen::Vector2d& point) const {
        return !contains(rings_.front(), point) ||
               std::any_of(rings_.begin() + 1, rings_.end(),
                           [&](const Ring& ring) { return contains(ring, point); });
    }

    std::span<const Ring> rings_;
    Box box_;
    double cell_ = 0.0;
    int columns_ = 0;
    int rows_ = 0;
    std::vector<char> blocked_;
};

// Whether any of a segment lies inside the open box (Liang and Barsky, "A new concept and method
// for line clipping", ACM Transactions on Graphics 3(1), 1984).
bool passes(const Box& box, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    double from = 0.0;
    double to = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double along = b[axis] - a[axis];
        const double low = box.low[axis] - a[axis];
        const double high = box.high[axis] - a[axis];
        if (along == 0.0) {
            if (low >= 0.0 || high <= 0.0) {
                return false;
            }
            continue;
        }
        from = std::max(from, std::min(low / along, high / along));
        to = std::min(to, std::max(low / along, high / along));
    }
    return from < to;
}

bool is_clear(std::span<const Ring> rings, const Box& box) {
    for (const Ring& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            if (passes(box, ring[i], ring[(i + 1) % ring.size()])) {
                return false;
            }
        }
    }
    return true;
}

// Moves one side of the box out by at most `most`.
void push_out(std::span<const Ring> rings, double& side, double by, Box& box) {
    constexpr int kHalvings = 24;
    const double start = side;
    double good = 0.0;
    double step = by;
    for (int i = 0; i < kHalvings; ++i) {
        side = start + good + step;
        good += is_clear(rings, box) ? step : 0.0;
        step *= 0.5;
    }
    side = start + good;
}

}  // namespace

FreeRectangle largest_rectangle_in(std::span<const Ring> rings) {
    Box box = FreeCells(rings).largest();
    const Eigen::Vector2d size = box.size();
    if (!(size.minCoeff() > 0.0)) {
        return {};
    }
    const double cell = bounds(rings.front()).size().maxCoeff() / kCells;
    for (const int axis : {0, 1}) {
        push_out(rings, box.low[axis], -2.0 * cell, box);
        push_out(rings, box.high[axis], 2.0 * cell, box);
    }
    return {box.low, {box.size().x(), box.size().y()}};
}

}  // namespace leafcutter::fab
