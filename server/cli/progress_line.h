// Progress of a long command: one line that is rewritten on a terminal, JSON lines with --json,
// nothing in a pipe. All of it on stderr.

#pragma once

#include <string>
#include <string_view>

#include "server/cli/command.h"

namespace leafcutter::server {

class ProgressLine {
public:
    explicit ProgressLine(const CommonOptions& common);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    // `fraction` of the whole work, in [0, 1].
    void show(std::string_view stage, double fraction);

    // Takes the line away; called by the destructor, too.
    void clear();

private:
    enum class Style { Silent, Terminal, Json };

    Style style_ = Style::Silent;
    int percent_ = -1;
    std::string stage_;
};

}  // namespace leafcutter::server
