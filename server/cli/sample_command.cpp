// `leafcutter sample NAME [--faces N] -o FILE`: writes a built-in sample surface.

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "geometry/io/mesh_writer.h"
#include "geometry/samples.h"
#include "server/cli/command.h"

namespace leafcutter::server {

namespace {

struct SampleOptions {
    std::string name;
    int faces = 8000;
    std::string output;
};

using Writer = std::string (*)(const geometry::TriangleMesh&);

// Settled before any work starts.
Writer writer_for(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& letter : ending) {
        letter = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
    }
    if (ending == ".obj") {
        return geometry::write_obj;
    }
    if (ending == ".off") {
        return geometry::write_off;
    }
    if (ending == ".ply") {
        return [](const geometry::TriangleMesh& mesh) { return geometry::write_ply(mesh); };
    }
    throw UsageError(fmt::format("{}: name a file that ends in .obj, .off or .ply", path));
}

void write_sample(const SampleOptions& options) {
    const Writer write = writer_for(options.output);
    const std::string text = write(geometry::make_sample(options.name, options.faces));
    std::ofstream file(options.output, std::ios::binary | std::ios::trunc);
    file << text << std::flush;
    if (!file) {
        throw UsageError(fmt::format("{}: can't be written", options.output));
    }
}

std::string known_names() {
    return fmt::format("{}", fmt::join(geometry::sample_names(), ", "));
}

}  // namespace

void add_sample_command(CLI::App& app, const CommonOptions& /*common*/) {
    CLI::App* command = app.add_subcommand("sample", "Writes a built-in sample surface");
    const auto options = std::make_shared<SampleOptions>();  // Lives as long as the callback.
    command->add_option("name", options->name, "One of: " + known_names())->required();
    command->add_option("--faces", options->faces, "About so many triangles")
        ->capture_default_str();
    command->add_option("-o,--output", options->output, "File to write: .obj .off .ply")
        ->required();
    command->callback([options] { write_sample(*options); });
}

}  // namespace leafcutter::server
