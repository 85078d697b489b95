// Kerf tests and grids of power and speed: jobs without a mesh, ready at once.

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/conditional.h"
#include "server/http/api/handlers.h"
#include "server/http/api/job_intake.h"
#include "server/http/json_body.h"

namespace leafcutter::server {

using nlohmann::json;

Response create_test_card(App& app, Request& request) {
    const json wish = read_json_object(request);
    const std::string text = dump_json(wish);
    const ComputeOutput output =
        app.parts().test_card(text, texts_of(app.store().materials.list()));
    NewJob job;
    job.name = text_field_or(wish, "name", "");
    if (job.name.empty()) {
        job.name = fmt::format("{} test: {}", wish.at("kind").get<std::string>(),
                               wish.at("material").get<std::string>());
    }
    const BlobId wished = app.store().blobs.put(text);
    job.file = {"test-card.json", wished.bytes, wished.sha256};
    job.params_json = "{}";
    return take_ready_job(app, std::move(job), output);
}

}  // namespace leafcutter::server
