#include "fab/guide/depth_image.h"

#include <algorithm>
#include <limits>

namespace leafcutter::fab::guide {

DepthImage::DepthImage(const std::vector<std::array<int, 4>>& quads,
                       const std::vector<Eigen::Vector3d>& projected,
                       int pixels)
    : quads_(quads), points_(projected) {
    if (projected.empty()) {
        return;
    }
    Eigen::Vector3d low = projected.front();
    Eigen::Vector3d high = low;
    for (const Eigen::Vector3d& point : projected) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const double longest = std::max((high - low).head<2>().maxCoeff(), 1e-12);
    pixel_ = longest / pixels;
    width_ = static_cast<int>((high.x() - low.x()) / pixel_) + 2;
    height_ = static_cast<int>((high.y() - low.y()) / pixel_) + 2;
    for (Eigen::Vector3d& point : points_) {
        point.x() = (point.x() - low.x()) / pixel_;
        point.y() = (point.y() - low.y()) / pixel_;
    }
    const std::size_t size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    nearest_.assign(size, -1);
    std::vector<double> depth(size, -std::numeric_limits<double>::infinity());
    for (std::size_t quad = 0; quad < quads.size(); ++quad) {
        rasterise(static_cast<int>(quad), [&](std::size_t pixel, double z) {
            if (z > depth[pixel]) {
                depth[pixel] = z;
                nearest_[pixel] = static_cast<int>(quad);
            }
        });
    }
}

}  // namespace leafcutter::fab::guide
