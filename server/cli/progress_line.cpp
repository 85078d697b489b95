#include "server/cli/progress_line.h"

#include <cmath>
#include <cstdio>
#include <unistd.h>

#include <fmt/format.h>

namespace leafcutter::server {

ProgressLine::ProgressLine(const CommonOptions& common) {
    if (common.json) {
        style_ = Style::Json;
    } else if (isatty(STDERR_FILENO) != 0) {
        style_ = Style::Terminal;
    }
}

ProgressLine::~ProgressLine() {
    clear();
}

void ProgressLine::show(std::string_view stage, double fraction) {
    const int percent = static_cast<int>(std::lround(100.0 * fraction));
    if (style_ == Style::Silent || (percent == percent_ && stage == stage_)) {
        return;
    }
    percent_ = percent;
    stage_ = stage;
    if (style_ == Style::Json) {
        fmt::print(stderr, "{{\"stage\":\"{}\",\"fraction\":{:.2f}}}\n", stage, fraction);
    } else {
        fmt::print(stderr, "\r\x1b[K{:3} %  {}", percent, stage);
    }
    std::fflush(stderr);
}

void ProgressLine::clear() {
    if (style_ == Style::Terminal && percent_ >= 0) {
        fmt::print(stderr, "\r\x1b[K");
        std::fflush(stderr);
        percent_ = -1;
    }
}

}  // namespace leafcutter::server
