// Pieces of a package cut again: which ones are meant, from what, and the new package.

#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fab/recut.h"
#include "geometry/context.h"

namespace leafcutter::server {

// A package as a place to read files from; throws if there is none of that path.
struct PackageSource {
    std::string name;  // For messages.
    std::function<std::string(const std::string& path)> read;
};

struct RecutWishes {
    std::vector<std::string> pieces;  // "W12.1", a whole strip "W12", "sheet:3", or "all".
    std::optional<fab::SheetSize> sheet = {};
    fab::Ring remnant = {};                   // Outline; empty: none.
    std::string material = {};                // Id; empty: those of the package.
    std::vector<fab::Material> instead = {};  // Of records of the package of the same id.
    double time_s = 0.5;                      // At most, of the time the package took to nest.
};

// `materials` are those that wishes.material may name. What comes is a package of its own: it can
// be audited, and cut again.
//
// Throws geometry::Error: BadOption for a piece, sheet or material that is not there (naming the
// nearest) or no room; BadFile for a package that can't be read; Cancelled.
fab::RecutSummary recut_package(const PackageSource& source,
                                const RecutWishes& wishes,
                                std::span<const fab::Material> materials,
                                const geometry::Context& context);

// Throws for such wishes what recut_package would, but for those that only nesting can refuse.
void check_recut(const PackageSource& source,
                 const RecutWishes& wishes,
                 std::span<const fab::Material> materials);

}  // namespace leafcutter::server
