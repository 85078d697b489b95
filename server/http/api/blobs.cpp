// Meshes on their way in, named by the SHA-256 of their bytes: whole, or piece by piece.

#include <array>
#include <charconv>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/job_intake.h"
#include "server/http/api/lookup.h"
#include "server/http/problem.h"
#include "server/store/partial_blob.h"

namespace leafcutter::server {

namespace {

constexpr std::int64_t kMostBytes = 256LL << 20;

// Of a Content-Range: "bytes 0-99/500", or "bytes */500", which only asks how much is here.
struct Piece {
    std::int64_t first = 0;
    std::int64_t bytes = 0;
    std::int64_t whole = 0;
};

// Takes a number off the front of `text` and what has to follow it.
std::optional<std::int64_t> take_number(std::string_view& text, std::string_view follower) {
    std::int64_t number = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
    if (parsed.ec != std::errc() || number < 0 || !text.starts_with(follower)) {
        return std::nullopt;
    }
    text.remove_prefix(follower.size());
    return number;
}

std::optional<Piece> piece_from(std::string_view text) {
    constexpr std::string_view kUnit = "bytes ";
    constexpr std::string_view kQuestion = "*/";
    if (!text.starts_with(kUnit)) {
        return std::nullopt;
    }
    text.remove_prefix(kUnit.size());
    Piece piece;
    if (text.starts_with(kQuestion)) {
        text.remove_prefix(kQuestion.size());
    } else {
        const auto first = take_number(text, "-");
        const auto last = first ? take_number(text, "/") : std::nullopt;
        if (!last || *last < *first) {
            return std::nullopt;
        }
        piece.first = *first;
        piece.bytes = *last - *first + 1;
    }
    const auto whole = take_number(text, "");
    if (!whole || !text.empty() || piece.first + piece.bytes > *whole) {
        return std::nullopt;
    }
    piece.whole = *whole;
    return piece;
}

Piece piece_in(const Request& request, const std::string& header) {
    const auto piece = piece_from(header);
    if (!piece || piece->bytes != request.body.bytes) {
        throw HttpProblem(400, "bad-range",
                          "Content-Range: must be bytes FIRST-LAST/SIZE, as long as the body, or "
                          "bytes */SIZE without one");
    }
    if (piece->whole > kMostBytes) {
        throw HttpProblem(413, "too-large", "the whole is larger than 256 MB");
    }
    return *piece;
}

void skip_body(Request& request) {
    std::array<char, 65536> room;
    while (request.body.read(room) > 0) {
    }
}

// How much is here, so that the next piece begins there.
Response part_taken(std::int64_t here) {
    Response response;
    response.status = 202;
    response.headers["Upload-Offset"] = std::to_string(here);
    return response;
}

HttpProblem sent_by_another() {
    return HttpProblem(409, "busy", "another connection sends this blob just now");
}

// Asking must not keep a piece that comes at the same moment from being taken.
Response tell_offset(App& app, const std::string& sha256) {
    const auto here = PartialBlob::bytes_here(app.store().blobs, sha256);
    if (!here) {
        throw sent_by_another();
    }
    return part_taken(*here);
}

HttpProblem upload_gap(std::int64_t here) {
    HttpProblem gap(409, "upload-gap", fmt::format("{} bytes are here: go on from there", here));
    gap.headers["Upload-Offset"] = std::to_string(here);
    return gap;
}

Response take_piece(App& app, Request& request, const std::string& sha256, const Piece& piece) {
    PartialBlob part(app.store().blobs, sha256);
    if (!part.is_ours()) {
        throw sent_by_another();
    }
    if (piece.first > part.bytes()) {
        throw upload_gap(part.bytes());
    }
    check_room(app, piece.whole - part.bytes());
    part.cut_to(piece.first);
    std::array<char, 65536> room;
    while (const std::size_t size = request.body.read(room)) {
        part.write({room.data(), size});
    }
    if (part.bytes() < piece.whole) {
        return part_taken(part.bytes());
    }
    if (!part.finish()) {
        throw HttpProblem(422, "bad-digest", "the bytes have another SHA-256 than the name says");
    }
    Response response;
    response.status = 201;
    return response;
}

Response take_whole(App& app, Request& request, const std::string& sha256) {
    check_room(app, request.body.bytes);
    const std::unique_ptr<BlobWriter> writer = app.store().blobs.begin();
    std::array<char, 65536> room;
    while (const std::size_t size = request.body.read(room)) {
        writer->write({room.data(), size});
    }
    if (writer->digest().sha256 != sha256) {
        throw HttpProblem(422, "bad-digest", "the bytes have another SHA-256 than the name says");
    }
    writer->finish();
    Response response;
    response.status = 201;
    return response;
}

}  // namespace

Response show_blob(App& app, Request& request) {
    const std::string& wanted = request.capture("sha256");
    const Blobs& blobs = app.store().blobs;
    if (!is_sha256(wanted) || !blobs.is_here(wanted)) {  // Asking others is the asker's business.
        throw HttpProblem(404, "no-blob", "there is no blob of that name here");
    }
    Response response;
    response.content_type = "application/octet-stream";
    auto file = std::make_shared<FileHandle>(blobs.open(wanted));
    response.file = FilePart{std::move(file), 0, blobs.size(wanted).value_or(0)};
    return response;
}

Response put_blob(App& app, Request& request) {
    const std::string& wanted = request.capture("sha256");
    if (!is_sha256(wanted)) {
        throw HttpProblem(422, "bad-digest", "the name must be a SHA-256 in lower-case hex");
    }
    const auto range = request.header("content-range");
    const std::optional<Piece> piece =
        range ? std::optional(piece_in(request, std::string(*range))) : std::nullopt;
    if (app.store().blobs.is_here(wanted)) {
        skip_body(request);  // Known already; the bytes have to go somewhere.
        Response response;
        response.status = 204;
        return response;
    }
    if (!piece) {
        return take_whole(app, request, wanted);
    }
    const bool asks = piece->bytes == 0;
    return asks ? tell_offset(app, wanted) : take_piece(app, request, wanted, *piece);
}

}  // namespace leafcutter::server
