// Every call of the API: parse, call, write. What they throw is translated by the edge.

#pragma once

#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

class App;

// jobs.cpp
Response create_job(App& app, Request& request);
Response list_jobs(App& app, Request& request);
Response show_job(App& app, Request& request);
Response delete_job(App& app, Request& request);
Response recompute_job(App& app, Request& request);
Response put_blob(App& app, Request& request);
Response show_blob(App& app, Request& request);

// queue.cpp
Response show_queue(App& app, Request& request);
Response pause_queue(App& app, Request& request);
Response resume_queue(App& app, Request& request);
Response change_job(App& app, Request& request);
Response retry_job(App& app, Request& request);

// recut.cpp
Response recut_job(App& app, Request& request);

// test_cards.cpp
Response create_test_card(App& app, Request& request);

// artifacts.cpp
Response list_artifacts(App& app, Request& request);
Response show_artifact(App& app, Request& request);
Response show_mesh(App& app, Request& request);
Response show_package(App& app, Request& request);

// cuts.cpp
Response create_cut(App& app, Request& request);
Response list_cuts(App& app, Request& request);
Response show_cut(App& app, Request& request);
Response start_cut(App& app, Request& request);
Response confirm_sheet(App& app, Request& request);
Response pause_cut(App& app, Request& request);
Response resume_cut(App& app, Request& request);
Response finish_cut(App& app, Request& request);
Response abort_cut(App& app, Request& request);

// devices.cpp
Response list_devices(App& app, Request& request);
Response show_device(App& app, Request& request);
Response put_device(App& app, Request& request);
Response delete_device(App& app, Request& request);
Response command_device(App& app, Request& request);
Response list_settings(App& app, Request& request);
Response list_ports(App& app, Request& request);

// materials.cpp
Response list_materials(App& app, Request& request);
Response show_material(App& app, Request& request);
Response put_material(App& app, Request& request);
Response delete_material(App& app, Request& request);
Response import_materials(App& app, Request& request);

// stock.cpp
Response list_stock(App& app, Request& request);
Response import_stock(App& app, Request& request);
Response show_stock(App& app, Request& request);
Response put_stock(App& app, Request& request);
Response delete_stock(App& app, Request& request);

// presets.cpp
Response list_presets(App& app, Request& request);
Response import_presets(App& app, Request& request);
Response show_preset(App& app, Request& request);
Response put_preset(App& app, Request& request);
Response delete_preset(App& app, Request& request);

// storage.cpp
Response show_retention(App& app, Request& request);
Response change_retention(App& app, Request& request);
Response list_backups(App& app, Request& request);
Response make_backup(App& app, Request& request);

// session.cpp
Response show_session(App& app, Request& request);
Response log_in(App& app, Request& request);
Response log_out(App& app, Request& request);

// accounts.cpp
Response list_users(App& app, Request& request);
Response add_user(App& app, Request& request);
Response show_user(App& app, Request& request);
Response change_user(App& app, Request& request);
Response delete_user(App& app, Request& request);
Response list_keys(App& app, Request& request);
Response add_key(App& app, Request& request);
Response delete_key(App& app, Request& request);
Response list_audit(App& app, Request& request);

// octoprint.cpp
Response octoprint_version(App& app, Request& request);
Response octoprint_upload(App& app, Request& request);

// fleet.cpp
Response show_fleet(App& app, Request& request);
Response pause_node(App& app, Request& request);
Response drain_node(App& app, Request& request);
Response resume_node(App& app, Request& request);
Response forget_node(App& app, Request& request);

// events.cpp
Response stream_events(App& app, Request& request);
Response stream_job_events(App& app, Request& request);

// health.cpp
Response show_health(App& app, Request& request);
Response show_readiness(App& app, Request& request);
Response show_metrics(App& app, Request& request);
Response show_version(App& app, Request& request);
Response show_openapi(App& app, Request& request);

}  // namespace leafcutter::server
