// Runs a simulated machine behind a link, in one thread of its own, and keeps its beam log.

#pragma once

#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/sim_link.h"

namespace leafcutter::drivers {

struct SimHostOptions {
    GrblMachineOptions machine;
    double speed = 1.0;     // Simulated seconds per second; 0: as fast as it can be computed.
    std::string burn_path;  // Beam log as JSON lines; empty: none is written.
    std::vector<Fault> faults;
};

class SimHost {
public:
    // Takes the link over. Throws std::invalid_argument for a speed below 0 or a log that can't be
    // written.
    SimHost(std::unique_ptr<SimLink> link, const SimHostOptions& options);
    SimHost(const SimHost&) = delete;
    SimHost& operator=(const SimHost&) = delete;
    ~SimHost();

    std::string address() const { return address_; }
    std::vector<BurntPiece> burnt() const;
    double beam_power() const;

private:
    void run(const std::stop_token& stop);
    void turn(double wall_s);
    double time_to_pass(double wall_s) const;

    std::unique_ptr<SimLink> link_;  // Of the thread alone, once that runs.
    std::string address_;
    double speed_;
    std::ofstream burn_file_;
    mutable std::mutex mutex_;  // Guards machine_.
    FaultyMachine machine_;
    bool unplugged_ = false;
    std::jthread thread_;  // Last: it ends before what it uses.
};

}  // namespace leafcutter::drivers
