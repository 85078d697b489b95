#include "fab/nest/raster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace leafcutter::fab {

namespace {

constexpr int kWordBits = 64;

// x where the row at height y meets the boundary of `ring`, sorted.
std::vector<double> crossings(const Ring& ring, double y) {
    std::vector<double> xs;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d& a = ring[i];
        const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
        if ((a.y() <= y) != (b.y() <= y)) {
            xs.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
        }
    }
    std::sort(xs.begin(), xs.end());
    return xs;
}

void add_boundary_cells(const Ring& ring, double cell_mm, std::vector<Stencil::Cell>& cells) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d a = ring[i] / cell_mm;
        const Eigen::Vector2d b = ring[(i + 1) % ring.size()] / cell_mm;
        const int steps = 1 + static_cast<int>((b - a).norm());
        for (int k = 0; k < steps; ++k) {
            const Eigen::Vector2d p = a + (b - a) * k / steps;
            cells.push_back(
                {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))});
        }
    }
}

// Sparse points inside, so that wide pieces don't swallow what was laid before them.
void add_inner_cells(const Ring& ring, double cell_mm, std::vector<Stencil::Cell>& cells) {
    constexpr int kStep = 4;
    const int rows = static_cast<int>(bounds(ring).high.y() / cell_mm);
    for (int row = kStep / 2; row <= rows; row += kStep) {
        const std::vector<double> xs = crossings(ring, row * cell_mm);
        for (std::size_t i = 0; i + 1 < xs.size(); i += 2) {
            const int last = static_cast<int>(xs[i + 1] / cell_mm);
            for (int x = static_cast<int>(std::ceil(xs[i] / cell_mm)); x <= last; x += kStep) {
                cells.push_back({x, row});
            }
        }
    }
}

// Reorders so that every prefix is spread evenly: steps of about the golden section of the length.
std::vector<Stencil::Cell> spread(const std::vector<Stencil::Cell>& cells) {
    const std::size_t count = cells.size();
    constexpr double kGolden = 0.6180339887498949;
    std::size_t step =
        std::max<std::size_t>(1, static_cast<std::size_t>(kGolden * static_cast<double>(count)));
    while (std::gcd(step, count) != 1) {
        ++step;
    }
    std::vector<Stencil::Cell> out(count);
    for (std::size_t i = 0, at = 0; i < count; ++i, at = (at + step) % count) {
        out[i] = cells[at];
    }
    return out;
}

}  // namespace

Stencil make_stencil(const Ring& ring, double cell_mm) {
    Stencil stencil;
    add_boundary_cells(ring, cell_mm, stencil.cells);
    add_inner_cells(ring, cell_mm, stencil.cells);
    const auto same = [](const Stencil::Cell& a, const Stencil::Cell& b) {
        return a.x == b.x && a.y == b.y;
    };
    stencil.cells.erase(std::unique(stencil.cells.begin(), stencil.cells.end(), same),
                        stencil.cells.end());
    for (const Stencil::Cell& cell : stencil.cells) {
        stencil.width = std::max(stencil.width, cell.x);
        stencil.height = std::max(stencil.height, cell.y);
    }
    stencil.cells = spread(stencil.cells);
    return stencil;
}

SheetRaster::SheetRaster(const Eigen::Vector2d& extent, double cell_mm)
    : cell_mm_(cell_mm),
      columns_(static_cast<int>(std::ceil(extent.x() / cell_mm)) + 2),
      rows_(static_cast<int>(std::ceil(extent.y() / cell_mm)) + 2),
      stride_(static_cast<std::size_t>(columns_ / kWordBits) + 3),
      bits_(stride_ * static_cast<std::size_t>(rows_), 0) {}

void SheetRaster::block_span(int row, const Span& x_mm) {
    if (row < 0 || row >= rows_) {
        return;
    }
    const int first = std::max(0, static_cast<int>(std::ceil(x_mm.from / cell_mm_)));
    const int last = std::min(columns_ - 1, static_cast<int>(std::floor(x_mm.to / cell_mm_)));
    if (first > last) {
        return;
    }
    std::uint64_t* words = bits_.data() + static_cast<std::size_t>(row) * stride_;
    const int first_word = first / kWordBits;
    const int last_word = last / kWordBits;
    const std::uint64_t head = ~std::uint64_t{0} << (first % kWordBits);
    const std::uint64_t tail = ~std::uint64_t{0} >> (kWordBits - 1 - last % kWordBits);
    if (first_word == last_word) {
        words[first_word] |= head & tail;
        return;
    }
    words[first_word] |= head;
    std::fill(words + first_word + 1, words + last_word, ~std::uint64_t{0});
    words[last_word] |= tail;
}

void SheetRaster::block_capsule(const Eigen::Vector2d& a,
                                const Eigen::Vector2d& b,
                                double reach_mm) {
    const double length = (b - a).norm();
    const Eigen::Vector2d along =
        length > 0.0 ? Eigen::Vector2d((b - a) / length) : Eigen::Vector2d(1.0, 0.0);
    const Eigen::Vector2d aside(-along.y() * reach_mm, along.x() * reach_mm);
    const Ring body = {a + aside, a - aside, b - aside, b + aside};
    const int first = static_cast<int>(std::ceil((std::min(a.y(), b.y()) - reach_mm) / cell_mm_));
    const int last = static_cast<int>(std::floor((std::max(a.y(), b.y()) + reach_mm) / cell_mm_));
    for (int row = std::max(0, first); row <= std::min(rows_ - 1, last); ++row) {
        const double y = row * cell_mm_;
        double from = std::numeric_limits<double>::infinity();
        double to = -from;
        for (const Eigen::Vector2d& end : {a, b}) {
            const double square = reach_mm * reach_mm - (y - end.y()) * (y - end.y());
            if (square >= 0.0) {
                from = std::min(from, end.x() - std::sqrt(square));
                to = std::max(to, end.x() + std::sqrt(square));
            }
        }
        for (const double x : crossings(body, y)) {
            from = std::min(from, x);
            to = std::max(to, x);
        }
        if (from <= to) {
            block_span(row, {from, to});
        }
    }
}

void SheetRaster::block_inside(const Ring& ring) {
    const Box box = bounds(ring);
    const int last = std::min(rows_ - 1, static_cast<int>(box.high.y() / cell_mm_));
    for (int row = std::max(0, static_cast<int>(box.low.y() / cell_mm_)); row <= last; ++row) {
        const std::vector<double> xs = crossings(ring, row * cell_mm_);
        for (std::size_t i = 0; i + 1 < xs.size(); i += 2) {
            block_span(row, {xs[i], xs[i + 1]});
        }
    }
}

void SheetRaster::block(const Ring& ring, double reach_mm) {
    block_inside(ring);
    for (std::size_t i = 0; i < ring.size(); ++i) {
        block_capsule(ring[i], ring[(i + 1) % ring.size()], reach_mm);
    }
}

bool SheetRaster::free_positions(const Stencil& stencil,
                                 int row,
                                 int last,
                                 std::vector<std::uint64_t>& blocked) const {
    const std::size_t count = static_cast<std::size_t>(last / kWordBits) + 1;
    blocked.assign(count, 0);
    blocked.back() =
        last % kWordBits == kWordBits - 1 ? 0 : ~std::uint64_t{0} << (last % kWordBits + 1);
    std::uint64_t* out = blocked.data();
    constexpr std::size_t kBatch = 8;
    for (std::size_t start = 0; start < stencil.cells.size(); start += kBatch) {
        const std::size_t end = std::min(stencil.cells.size(), start + kBatch);
        for (std::size_t i = start; i < end; ++i) {
            const Stencil::Cell& cell = stencil.cells[i];
            const std::uint64_t* words = bits_.data() +
                                         static_cast<std::size_t>(row + cell.y) * stride_ +
                                         static_cast<std::size_t>(cell.x / kWordBits);
            const int shift = cell.x % kWordBits;
            for (std::size_t w = 0; w < count; ++w) {
                out[w] |= (words[w] >> shift) | ((words[w + 1] << 1) << (kWordBits - 1 - shift));
            }
        }
        std::uint64_t all = ~std::uint64_t{0};
        for (std::size_t w = 0; w < count; ++w) {
            all &= out[w];
        }
        if (all == ~std::uint64_t{0}) {
            return false;
        }
    }
    return true;
}

}  // namespace leafcutter::fab
