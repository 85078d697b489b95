// The files of a finished job.

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/conditional.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/problem.h"
#include "server/http/zip.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

std::optional<std::int64_t> number_in(std::string_view text) {
    std::int64_t number = 0;
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, number);
    const bool good = !text.empty() && parsed.ec == std::errc() && parsed.ptr == end && number >= 0;
    return good ? std::optional(number) : std::nullopt;
}

struct ByteRange {
    std::int64_t first = 0;
    std::int64_t last = 0;
};

HttpProblem beyond_the_end(std::int64_t size) {
    HttpProblem problem(416, "bad-range", fmt::format("the file has {} bytes", size));
    problem.headers["Content-Range"] = fmt::format("bytes */{}", size);
    return problem;
}

// One range of RFC 9110, section 14.1.2; nothing for a header that is to be ignored. Throws
// HttpProblem (416).
std::optional<ByteRange> range_in(const Request& request, std::int64_t size) {
    const std::string header = request.header("range").value_or("");
    constexpr std::string_view kUnit = "bytes=";
    const std::size_t dash = header.find('-');
    if (!header.starts_with(kUnit) || dash == std::string::npos) {
        return std::nullopt;
    }
    const auto from = number_in(std::string_view(header).substr(kUnit.size(), dash - kUnit.size()));
    const auto to = number_in(std::string_view(header).substr(dash + 1));
    const bool open = header.size() == dash + 1;
    ByteRange range;
    if (from && (to || open)) {
        range = {*from, std::min(to.value_or(size - 1), size - 1)};
    } else if (!from && to && dash == kUnit.size()) {
        range = {std::max<std::int64_t>(0, size - *to), size - 1};
    } else {
        return std::nullopt;
    }
    if (range.first > range.last) {
        throw beyond_the_end(size);
    }
    return range;
}

std::string file_name_of(const std::string& path) {
    return path.substr(path.rfind('/') + 1);
}

// Names come from users: plain letters for old clients, RFC 8187 for all others.
std::string attachment(const std::string& name) {
    std::string plain;
    std::string encoded;
    for (const char c : name) {
        const bool safe = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                          (c >= 'A' && c <= 'Z') || c == '-' || c == '_' || c == '.';
        plain += safe ? c : '_';
        encoded += safe ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return fmt::format("attachment; filename=\"{}\"; filename*=UTF-8''{}", plain, encoded);
}

struct ServedFile {
    std::string name;
    std::string sha256;
    std::int64_t bytes = 0;
    std::string media_type;
};

// A stored file, all of it or the range that is asked for; none of it if the asker has it already.
Response file_response(App& app, const Request& request, const ServedFile& served) {
    Response response;
    response.headers["ETag"] = fmt::format("\"{}\"", served.sha256);
    response.headers["Accept-Ranges"] = "bytes";
    response.headers["Cache-Control"] = "private, no-cache";
    const std::string seen = request.header("if-none-match").value_or("");
    if (seen == "*" || seen.find(served.sha256) != std::string::npos) {
        response.status = 304;
        return response;
    }
    response.content_type = served.media_type;
    response.headers["Content-Disposition"] = attachment(served.name);
    auto file = std::make_shared<FileHandle>(app.store().blobs.open(served.sha256));
    response.file = FilePart{std::move(file), 0, served.bytes};
    const auto range = range_in(request, served.bytes);
    const std::string validator = request.header("if-range").value_or(response.headers["ETag"]);
    if (range && validator == response.headers["ETag"]) {
        response.status = 206;
        response.file->offset = range->first;
        response.file->bytes = range->last - range->first + 1;
        response.headers["Content-Range"] =
            fmt::format("bytes {}-{}/{}", range->first, range->last, served.bytes);
    }
    return response;
}

}  // namespace

Response list_artifacts(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    json artifacts = json::array();
    for (const ArtifactRecord& artifact : app.store().jobs.artifacts(job.id)) {
        artifacts.push_back({{"path", artifact.path},
                             {"bytes", artifact.bytes},
                             {"sha256", artifact.sha256},
                             {"media_type", artifact.media_type}});
    }
    return json_response(paged("artifacts", std::move(artifacts), "path", request));
}

Response show_artifact(App& app, Request& request) {
    const auto artifact = app.store().jobs.artifact(request.capture("id"), request.capture("path"));
    if (!artifact) {
        throw HttpProblem(404, "no-such-artifact", "the job has no such file");
    }
    return file_response(
        app, request,
        {file_name_of(artifact->path), artifact->sha256, artifact->bytes, artifact->media_type});
}

Response show_mesh(App& app, Request& request) {
    const SourceFile file = find_job(app, request).file;
    if (file.sha256.empty() || !app.store().blobs.size(file.sha256)) {
        throw HttpProblem(404, "no-mesh", "the job has no mesh, or it is no longer kept");
    }
    return file_response(app, request,
                         {file.name, file.sha256, file.bytes, "application/octet-stream"});
}

Response show_package(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    const std::vector<ArtifactRecord> artifacts = app.store().jobs.artifacts(job.id);
    if (artifacts.empty()) {
        throw HttpProblem(409, "not-ready", fmt::format("the job is {}", to_string(job.state)));
    }
    FileHandle zip = app.store().blobs.scratch();
    const std::int64_t bytes = write_zip(app.store().blobs, artifacts, zip);
    Response response;
    response.content_type = "application/zip";
    response.headers["Content-Disposition"] = attachment(job.name + ".zip");
    response.file = FilePart{std::make_shared<FileHandle>(std::move(zip)), 0, bytes};
    return response;
}

}  // namespace leafcutter::server
