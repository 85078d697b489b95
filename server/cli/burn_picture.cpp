#include "server/cli/burn_picture.h"

#include <fstream>
#include <stdexcept>

#include "drivers/sim/burn_picture.h"
#include "server/cli/command.h"

namespace leafcutter::server {

void check_picture_path(const std::string& path) {
    if (!path.ends_with(".svg") && !path.ends_with(".png")) {
        throw UsageError(path + ": a picture is an .svg or a .png");
    }
}

void write_burn_picture(const std::string& path, std::span<const drivers::BurntPiece> pieces) {
    check_picture_path(path);
    const std::string bytes =
        path.ends_with(".svg") ? drivers::burn_svg(pieces) : drivers::burn_png(pieces);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.flush();
    if (!file) {
        throw std::runtime_error(path + ": can't be written");
    }
}

}  // namespace leafcutter::server
