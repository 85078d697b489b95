#include "server/http/api/metrics_text.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <unistd.h>

#include <fmt/format.h>

#include "drivers/device.h"
#include "server/app.h"
#include "server/store/queue_ages.h"

namespace leafcutter::server {

namespace {

std::string header(std::string_view name, std::string_view type, std::string_view help) {
    return fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

std::string gauge(std::string_view name, std::string_view help, double value) {
    return fmt::format("{}{} {}\n", header(name, "gauge", help), name, value);
}

std::string queue_lines(App& app) {
    std::string text = header("leafcutter_jobs", "gauge", "Jobs by state.");
    for (const JobState state : {JobState::Queued, JobState::Computing, JobState::Ready,
                                 JobState::Done, JobState::Failed, JobState::Cancelled}) {
        text += fmt::format("leafcutter_jobs{{state=\"{}\"}} {}\n", to_string(state),
                            app.store().jobs.count(state));
    }
    text += header("leafcutter_cuts", "gauge", "Cuts by state.");
    for (const CutState state : {CutState::Waiting, CutState::Armed, CutState::Cutting,
                                 CutState::Paused, CutState::AwaitingSheet, CutState::Done,
                                 CutState::Aborted, CutState::Failed, CutState::Interrupted}) {
        text += fmt::format("leafcutter_cuts{{state=\"{}\"}} {}\n", to_string(state),
                            app.store().cuts.count(state));
    }
    constexpr double kMilli = 1e-3;
    const QueueAges ages = app.store().queue_ages();
    text += header("leafcutter_queue_age_seconds", "gauge", "Wait of the longest-waiting one.");
    text += fmt::format("leafcutter_queue_age_seconds{{queue=\"jobs\"}} {}\n",
                        kMilli * static_cast<double>(ages.oldest_job_ms));
    text += fmt::format("leafcutter_queue_age_seconds{{queue=\"cuts\"}} {}\n",
                        kMilli * static_cast<double>(ages.oldest_cut_ms));
    return text;
}

std::string device_lines(App& app) {
    std::string text =
        header("leafcutter_device_connected", "gauge", "Whether the machine's link is up.");
    std::string cutting = header("leafcutter_device_cutting", "gauge", "Whether a cut is in work.");
    for (const auto& runner : app.fleet().all()) {
        const bool connected = runner->status().state != drivers::MachineState::Disconnected;
        text += fmt::format("leafcutter_device_connected{{device=\"{}\"}} {}\n",
                            runner->record().id, connected ? 1 : 0);
        cutting += fmt::format("leafcutter_device_cutting{{device=\"{}\"}} {}\n",
                               runner->record().id, runner->current_cut() ? 1 : 0);
    }
    return text + cutting;
}

std::string event_lines(App& app) {
    const std::int64_t last = app.store().events.last_seq();
    std::string text = gauge("leafcutter_event_clients", "Open event streams.",
                             static_cast<double>(app.hub().clients()));
    text += header("leafcutter_event_seq", "counter", "Number of the last event.");
    text += fmt::format("leafcutter_event_seq {}\n", last);
    if (app.webhooks().empty()) {
        return text;
    }
    text += header("leafcutter_webhook_behind", "gauge", "Events that a webhook was not told of.");
    std::string failures =
        header("leafcutter_webhook_failures", "gauge", "Failures since a webhook's last success.");
    for (std::size_t i = 0; i < app.webhooks().size(); ++i) {
        const Webhook& webhook = *app.webhooks()[i];
        text += fmt::format("leafcutter_webhook_behind{{webhook=\"{}\"}} {}\n", i + 1,
                            last - webhook.told());
        failures += fmt::format("leafcutter_webhook_failures{{webhook=\"{}\"}} {}\n", i + 1,
                                webhook.failures());
    }
    return text + failures;
}

double resident_bytes() {
    std::ifstream file("/proc/self/statm");
    double total_pages = 0.0;
    double resident_pages = 0.0;
    file >> total_pages >> resident_pages;
    return resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

std::string process_lines(App& app) {
    std::error_code ignored;
    const auto room = std::filesystem::space(app.store().folder.path(), ignored);
    std::string text = gauge("process_resident_memory_bytes", "Memory in use.", resident_bytes());
    text += gauge("leafcutter_disk_free_bytes", "Room in the state folder's file system.",
                  ignored ? 0.0 : static_cast<double>(room.available));
    text += gauge("leafcutter_database_healthy", "Whether the database takes changes.",
                  app.store().trouble().empty() ? 1.0 : 0.0);
    text += header("leafcutter_build_info", "gauge", "The version, as a label.");
    text += fmt::format("leafcutter_build_info{{version=\"{}\"}} 1\n", LEAFCUTTER_VERSION);
    return text;
}

}  // namespace

std::string metrics_text(App& app) {
    return queue_lines(app) + device_lines(app) + event_lines(app) + process_lines(app) +
           header("leafcutter_commit_seconds", "histogram", "Commits of the database, with sync.") +
           app.store().commit_latency().text("leafcutter_commit_seconds", "") +
           app.http_metrics().text();
}

}  // namespace leafcutter::server
