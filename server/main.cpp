#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "server/cli/command.h"

namespace leafcutter::server {
namespace {

int run(int argc, char** argv) {
    CLI::App app("Leafcutter: weaves any surface from laser-cut strips");
    app.set_version_flag("--version", LEAFCUTTER_VERSION);
    app.require_subcommand(1);
    CommonOptions common;
    app.add_flag("--json", common.json, "Errors and progress as JSON lines");
    app.fallthrough();
    add_inspect_command(app, common);
    add_sample_command(app, common);
    add_weave_command(app, common);
    add_compute_command(app, common);
    add_serve_command(app, common);
    add_store_command(app, common);
    add_user_command(app, common);
    add_health_command(app, common);
    add_backup_command(app, common);
    add_stock_command(app, common);
    add_presets_command(app, common);
    add_submit_command(app, common);
    add_jobs_command(app, common);
    add_cuts_command(app, common);
    add_send_command(app, common);
    add_simulate_command(app, common);
    add_devices_command(app, common);
    add_audit_command(app, common);
    add_burn_picture_command(app, common);
    add_nest_command(app, common);
    add_materials_command(app, common);
    add_recut_command(app, common);
    add_test_card_command(app, common);

    try {
        app.parse(argc, argv);
        return kDone;
    } catch (const CLI::ParseError& error) {
        const bool asked_for_help = error.get_exit_code() == 0;
        app.exit(error);
        return asked_for_help ? kDone : kRefused;
    } catch (const std::exception& error) {
        return report_error(error, common);
    }
}

}  // namespace
}  // namespace leafcutter::server

int main(int argc, char** argv) {
    try {
        return leafcutter::server::run(argc, argv);
    } catch (...) {
        std::fputs("leafcutter: out of memory, or a mistake of ours\n", stderr);
        return leafcutter::server::kFailed;
    }
}
