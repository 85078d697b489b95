#include "fab/package/package.h"

namespace leafcutter::fab {

const PackageFile* Package::find(std::string_view path) const {
    for (const PackageFile& file : files) {
        if (file.path == path) {
            return &file;
        }
    }
    return nullptr;
}

}  // namespace leafcutter::fab
