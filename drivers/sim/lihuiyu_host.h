// Runs a simulated Lihuiyu machine behind a link, in one thread of its own, and keeps its beam log.

#pragma once

#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/sim/lihuiyu_machine.h"
#include "drivers/sim/lihuiyu_transport.h"
#include "drivers/sim/sim_link.h"

namespace leafcutter::drivers {

class LihuiyuHost {
public:
    // Takes the link over. Throws std::invalid_argument for a speed below 0 or a log that can't be
    // written.
    LihuiyuHost(std::unique_ptr<SimLink> link, const SimLihuiyuOptions& options);
    LihuiyuHost(const LihuiyuHost&) = delete;
    LihuiyuHost& operator=(const LihuiyuHost&) = delete;
    ~LihuiyuHost();

    std::string address() const { return address_; }
    std::vector<BurntPiece> burnt() const;
    bool beam_on() const;

    // Since the last call.
    std::vector<Violation> take_violations();

private:
    void run(const std::stop_token& stop);
    void turn(double wall_s);

    std::unique_ptr<SimLink> link_;  // Of the thread alone, once that runs.
    std::string address_;
    double speed_;
    std::ofstream burn_file_;
    mutable std::mutex mutex_;  // Guards machine_ and violations_told_.
    LihuiyuMachine machine_;
    std::size_t violations_told_ = 0;
    bool unplugged_ = false;
    std::jthread thread_;  // Last: it ends before what it uses.
};

}  // namespace leafcutter::drivers
