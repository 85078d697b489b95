// Files that were put into the binary when it was built: the API's description and the dashboard.

#pragma once

#include <span>
#include <string_view>

namespace leafcutter::server {

struct EmbeddedFile {
    std::string_view path;  // "openapi.json", "dashboard/index.html".
    std::string_view bytes;
};

// Written by server/http/embed_files.cmake.
std::span<const EmbeddedFile> embedded_files();

// Null if there is none of that path.
const EmbeddedFile* find_embedded(std::string_view path);

}  // namespace leafcutter::server
