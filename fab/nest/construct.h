// Lays shapes one after the other where their centre of gravity comes lowest: a heap that settles
// under gravity. Long bent strips stack into each other this way like bowls.

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/shape.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// The usable rectangle of a sheet, turned so that gravity points down its y axis.
struct HeapOptions {
    Eigen::Vector2d extent = Eigen::Vector2d::Zero();
    double gap_mm = 0.0;
    double cell_mm = 1.0;          // Of the search raster; results are exact all the same.
    double top_weight = 0.0;       // 0: lowest centre of gravity; 1: lowest top.
    std::vector<Ring> taken = {};  // Parts of each sheet that nothing may lie on.
};

struct Laid {
    std::size_t shape = 0;
    std::size_t sheet = 0;
    Pose pose;
};

struct Heap {
    std::vector<Laid> laid;
    std::vector<std::size_t> left_over;  // Found no room on an empty sheet.
    std::size_t sheets = 0;
    double last_top_mm = 0.0;      // How far up the last sheet is used.
    std::int64_t evaluations = 0;  // Rows of positions tried.

    // Sheets used, the last one counted by its used part.
    double sheets_used(double height_mm) const {
        return sheets == 0 ? 0.0 : static_cast<double>(sheets) - 1.0 + last_top_mm / height_mm;
    }
};

// Lays shapes[order[0]], shapes[order[1]], … each on the first sheet that has room. Throws
// Cancelled after a stop request.
Heap build_heap(std::span<const NestShape> shapes,
                std::span<const std::size_t> order,
                const HeapOptions& options,
                const geometry::Context& context);

}  // namespace leafcutter::fab
