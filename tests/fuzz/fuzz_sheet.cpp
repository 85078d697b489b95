// A G-code file, to the reader that finds the outlines on a sheet: nothing but the typed error
// comes out of it.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "fab/cut/sheet_reader.h"
#include "geometry/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using leafcutter::geometry::Error;
    using leafcutter::geometry::ErrorKind;
    try {
        leafcutter::fab::read_sheet({reinterpret_cast<const char*>(data), size});
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::SelfCheck) {
            std::abort();
        }
    }
    return 0;
}
