// Meshes for tests, from text and from the shared data.

#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/read_mesh.h"

namespace leafcutter::geometry::test {

inline std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

inline PolygonSoup read_text(std::string_view text, std::string_view name) {
    return read_mesh(bytes_of(text), name);
}

inline std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    return {std::istreambuf_iterator<char>(file), {}};
}

// What `work` throws as an Error; fails the test if it throws none.
template <typename Work>
Error error_of(Work work) {
    try {
        work();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return {ErrorKind::SelfCheck, "none", "no error"};
}

inline std::string code_of(std::string_view text, std::string_view name) {
    return error_of([&] { read_text(text, name); }).code();
}

}  // namespace leafcutter::geometry::test
