// One file per command of the `leafcutter` binary; each adds itself to the command line here.

#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace leafcutter::server {

// Exit statuses of the binary.
using ExitStatus = int;
inline constexpr ExitStatus kDone = 0;
inline constexpr ExitStatus kFailed = 1;
inline constexpr ExitStatus kRefused = 2;
inline constexpr ExitStatus kDeviceFailed = 3;

// Options that every command shares.
struct CommonOptions {
    bool json = false;  // Errors and progress as JSON lines on stderr.
};

// The arguments were refused; exit status 2.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// A machine failed while we drove it; exit status 3.
class DeviceFailed : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Prints `error` as one line on stderr and returns the exit status it stands for.
int report_error(const std::exception& error, const CommonOptions& common);

// Each adds its subcommand, whose callback does the work and throws what went wrong.
void add_inspect_command(CLI::App& app, const CommonOptions& common);
void add_weave_command(CLI::App& app, const CommonOptions& common);
void add_sample_command(CLI::App& app, const CommonOptions& common);
void add_nest_command(CLI::App& app, const CommonOptions& common);
void add_materials_command(CLI::App& app, const CommonOptions& common);
void add_test_card_command(CLI::App& app, const CommonOptions& common);
void add_recut_command(CLI::App& app, const CommonOptions& common);
void add_audit_command(CLI::App& app, const CommonOptions& common);
void add_burn_picture_command(CLI::App& app, const CommonOptions& common);
void add_compute_command(CLI::App& app, const CommonOptions& common);
void add_cuts_command(CLI::App& app, const CommonOptions& common);
void add_jobs_command(CLI::App& app, const CommonOptions& common);
void add_serve_command(CLI::App& app, const CommonOptions& common);
void add_user_command(CLI::App& app, const CommonOptions& common);
void add_health_command(CLI::App& app, const CommonOptions& common);
void add_backup_command(CLI::App& app, const CommonOptions& common);
void add_stock_command(CLI::App& app, const CommonOptions& common);
void add_presets_command(CLI::App& app, const CommonOptions& common);
void add_store_command(CLI::App& app, const CommonOptions& common);
void add_submit_command(CLI::App& app, const CommonOptions& common);
void add_send_command(CLI::App& app, const CommonOptions& common);
void add_simulate_command(CLI::App& app, const CommonOptions& common);
void add_devices_command(CLI::App& app, const CommonOptions& common);

}  // namespace leafcutter::server
