#include "fab/package/scissors_files.h"

#include <utility>

#include <fmt/format.h>

#include "fab/export/scissors.h"

namespace leafcutter::fab {

std::vector<PackageFile> scissors_files(const JobResult& job) {
    ScissorsDrawing drawing = write_scissors(job);
    std::vector<PackageFile> files;
    files.push_back({"strips.svg", std::move(drawing.all)});
    for (std::size_t i = 0; i < drawing.pages.size(); ++i) {
        files.push_back(
            {fmt::format("scissors/page-{:03}.svg", i + 1), std::move(drawing.pages[i])});
    }
    return files;
}

}  // namespace leafcutter::fab
