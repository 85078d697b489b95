// `leafcutter burn-picture LOG -o FILE`: what a simulated beam burnt, drawn.

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "server/burn_log.h"
#include "server/cli/burn_picture.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"

namespace leafcutter::server {

namespace {

struct PictureOptions {
    std::vector<std::string> logs;
    std::string output;
};

void draw(const PictureOptions& options) {
    constexpr std::size_t kMaxBytes = std::size_t{4} << 30U;
    std::vector<drivers::BurntPiece> pieces;
    for (const std::string& path : options.logs) {
        const std::vector<std::byte> bytes = read_input_file(path, kMaxBytes);
        const std::vector<drivers::BurntPiece> more =
            read_burnt_pieces({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        pieces.insert(pieces.end(), more.begin(), more.end());
    }
    write_burn_picture(options.output, pieces);
}

}  // namespace

void add_burn_picture_command(CLI::App& app, const CommonOptions& /*common*/) {
    CLI::App* command =
        app.add_subcommand("burn-picture", "Draws what a simulated machine burnt, from its log");
    const auto options = std::make_shared<PictureOptions>();  // Lives as long as the callback.
    command->add_option("logs", options->logs, "Beam logs, one above the other")->required();
    command->add_option("-o,--output", options->output, "File to write: .svg or .png")->required();
    command->callback([options] { draw(*options); });
}

}  // namespace leafcutter::server
