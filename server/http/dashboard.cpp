#include "server/http/dashboard.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "server/http/embedded.h"

namespace leafcutter::server {

namespace {

constexpr std::string_view kWithoutDashboard =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Leafcutter</title>"
    "<h1>Leafcutter</h1><p>The daemon runs. This binary was built without its dashboard "
    "(LEAFCUTTER_WEB=OFF); the <a href=\"/api/v1/openapi.json\">API</a> is complete.</p></html>\n";

std::string_view media_type_of(std::string_view path) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTypes{
        {{".html", "text/html; charset=utf-8"},
         {".js", "text/javascript; charset=utf-8"},
         {".css", "text/css; charset=utf-8"},
         {".svg", "image/svg+xml"},
         {".png", "image/png"},
         {".ico", "image/x-icon"},
         {".json", "application/json"},
         {".woff2", "font/woff2"},
         {".webmanifest", "application/manifest+json"}}};
    for (const auto& [ending, type] : kTypes) {
        if (path.ends_with(ending)) {
            return type;
        }
    }
    return "application/octet-stream";
}

}  // namespace

const EmbeddedFile* find_embedded(std::string_view path) {
    const auto files = embedded_files();
    const auto found = std::find_if(files.begin(), files.end(),
                                    [path](const EmbeddedFile& file) { return file.path == path; });
    return found == files.end() ? nullptr : &*found;
}

std::optional<Response> dashboard_file(const Request& request) {
    const bool is_page = request.path == "/";
    const std::string path = "dashboard" + (is_page ? "/index.html" : request.path);
    const EmbeddedFile* file = find_embedded(path);
    if (file == nullptr && !is_page) {
        return std::nullopt;
    }
    Response response;
    response.content_type = media_type_of(path);
    response.body = file == nullptr ? kWithoutDashboard : file->bytes;
    // Names under /assets/ carry a hash of their content.
    response.headers["Cache-Control"] =
        request.path.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache";
    return response;
}

}  // namespace leafcutter::server
