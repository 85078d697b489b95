// Runs a simulated machine behind a link, in one thread of its own, and keeps its beam log.

#pragma once

#include <chrono>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/sim/sim_link.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct SimHostOptions {
    double speed = 1.0;      // Simulated seconds per second; 0: as fast as it can be computed.
    std::string burn_path;   // Beam log as JSON lines; empty: none is written.
    bool keep_burnt = true;  // For burnt(); else a piece is dropped once it is written.
};

class SimHost {
public:
    // Takes link and machine over. Throws std::invalid_argument for a speed below 0 or a log that
    // can't be written.
    SimHost(std::unique_ptr<SimLink> link,
            std::unique_ptr<SimMachine> machine,
            const SimHostOptions& options);
    SimHost(const SimHost&) = delete;
    SimHost& operator=(const SimHost&) = delete;
    ~SimHost();

    std::string address() const { return address_; }
    std::vector<BurntPiece> burnt() const;
    double beam_power() const;

    // Since the last call.
    std::vector<Violation> take_violations();

private:
    void run(const std::stop_token& stop);
    void turn(double wall_s);
    void keep_log();
    std::chrono::milliseconds wait_for_bytes() const;

    std::unique_ptr<SimLink> link_;  // Of the thread alone, once that runs.
    std::string address_;
    double speed_;
    bool keep_burnt_;
    std::ofstream burn_file_;
    mutable std::mutex mutex_;  // Guards *machine_.
    std::unique_ptr<SimMachine> machine_;
    bool unplugged_ = false;
    std::jthread thread_;  // Last: it ends before what it uses.
};

// Opens a beam log to be written from its beginning; an empty path opens none. Throws
// std::invalid_argument.
std::ofstream open_burn_file(const std::string& path);

}  // namespace leafcutter::drivers
