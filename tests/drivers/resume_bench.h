// A program in a simulated machine that is interrupted somewhere, and finished from what its
// journal tells.

#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "drivers/burn/remainder.h"
#include "tests/drivers/burn_check.h"
#include "tests/drivers/stepped_machine.h"

namespace leafcutter::drivers {

// Rings that are cut twice, a curve that crosses itself, long lines there and back, travel between.
inline std::string mixed_job(double feed) {
    std::string text = fmt::format("G21\nG90\nM4 S0\nG0 X20 Y20 S0\nG1 X20 Y20 S400 F{}\n", feed);
    const auto ring = [&](double x, double y, double radius, int turns, double twist) {
        constexpr int kSides = 48;
        for (int i = 0; i <= kSides * turns; ++i) {
            const double angle = 2.0 * M_PI * i / kSides;
            text += fmt::format("{} X{:.3f} Y{:.3f}{}\n", i == 0 ? "G0" : "G1",
                                x + radius * std::cos(angle), y + radius * std::sin(twist * angle),
                                i == 1 ? " S400" : (i == 0 ? " S0" : ""));
        }
    };
    ring(40, 40, 12, 2, 1);
    ring(80, 40, 3, 2, 1);
    ring(60, 90, 20, 1, 2);
    for (int i = 0; i < 4; ++i) {
        text += fmt::format("G0 X20 Y{} S0\nG1 X110 S300\nG1 X20\n", 130 + i);
    }
    text += "G0 X100 Y20 S0\nG2 X120 Y40 I10 J10 S500\nG3 X100 Y20 I-10 J-10\n";
    return text + "M5 S0\nG0 X0 Y0\n";
}

// The program under way in a machine, followed as the daemon follows it.
class ResumeBench {
public:
    explicit ResumeBench(std::string program,
                         std::vector<Fault> faults = {},
                         const GrblOptions& session = {})
        : program_(std::move(program)),
          path_(std::make_shared<BeamPath>(program_)),
          journal_(std::make_shared<KeptJournal>()),
          bench_({}, std::move(faults), session) {
        EXPECT_TRUE(bench_.attach());
        begun_s_ = bench_.now_s();
        follower_ = std::make_unique<BeamFollower>(
            path_, journal_, [this] { return bench_.now_s() - begun_s_ + unnoticed_s_; },
            bench_.session().status().planner_blocks);
        bench_.watch = follower_.get();
        bench_.session().allow_lines(0);
        bench_.session().start(program_);
    }

    SteppedMachine& bench() { return bench_; }
    GrblMachine& machine() { return bench_.machine(); }
    GrblSession& session() { return bench_.session(); }
    const BeamPath& path() const { return *path_; }
    BeamFollower& follower() { return *follower_; }
    KeptJournal& journal() { return *journal_; }

    bool run_for(double seconds) {
        const double end = bench_.now_s() + seconds;
        return bench_.run_until([&] { return bench_.now_s() >= end; }, seconds + 1.0);
    }

    // Nobody is there any more; the machine does what it has.
    void drain() {
        while (!machine().at_rest()) {
            machine().advance(0.05);
        }
    }

    // As the daemon does it: two more reports after the end, and the journal is closed.
    void settle() {
        const std::size_t reports = session().status().reports;
        bench_.run_until([&] { return session().status().reports >= reports + 2; }, 3.0);
        follower_->end(session().progress(), session().status());
    }

    // Its power goes, and the host notices by its silence.
    void lose_power() {
        JobProgress progress = session().progress();
        progress.outcome = JobOutcome::LinkLost;
        unnoticed_s_ = 2.0;
        follower_->end(progress, {});
        machine().power_cycle();
    }

    // The machine met again: what it says of its position.
    void find() {
        const Axes& at = machine().position_mm();
        journal_->note(
            {.kind = JournalRecord::Kind::Found, .at_mm = {at[0], at[1]}, .end = BeamEnd::Stands});
    }

    // Through its text form, as from a disk.
    BeamKnowledge knowledge() {
        journal_->journal.header.planner_blocks = session().status().planner_blocks;
        std::string text = write_record(journal_->journal.header);
        for (const JournalRecord& record : journal_->journal.records) {
            text += write_record(record);
        }
        return knowledge_of(*path_, read_journal(text).value());
    }

    double burnt() { return burnt_mm(machine().beam_log().pieces()); }

    // Finishes in a machine that was homed. Returns what was burnt twice, or, below 0, not at all.
    double finish(double burnt_mm_said) {
        const std::string rest = remainder_program(program_, burnt_mm_said);
        const double first = burnt();
        EXPECT_LT(worst_deviation(*path_, machine().beam_log().pieces()), 0.02);
        double second = 0.0;
        if (!rest.empty()) {
            SteppedMachine again;
            EXPECT_TRUE(again.attach());
            again.session().start(rest);
            EXPECT_TRUE(again.finish_job(3000.0));
            EXPECT_EQ(again.session().progress().outcome, JobOutcome::Done)
                << again.session().progress().reason;
            const auto& pieces = again.machine().beam_log().pieces();
            second = burnt_mm(pieces);
            EXPECT_LT(worst_deviation(*path_, pieces, path_->burn_mm() - second), 0.02);
            EXPECT_EQ(again.machine().beam_power(), 0.0);
        }
        return first + second - path_->burn_mm();
    }

private:
    std::string program_;
    std::shared_ptr<BeamPath> path_;
    std::shared_ptr<KeptJournal> journal_;
    SteppedMachine bench_;
    double begun_s_ = 0.0;
    double unnoticed_s_ = 0.0;
    std::unique_ptr<BeamFollower> follower_;
};

}  // namespace leafcutter::drivers
