#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/transport.h"
#include "server/queue/device_fleet.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::server {
namespace {

using drivers::JobOutcome;
using drivers::MachineState;
using namespace std::chrono_literals;

// What a scripted machine is told and says, shared with its test; outlives every link to it.
class Script {
public:
    // The state the machine shows, and whether it answers at all.
    void shows(MachineState state) {
        const std::scoped_lock lock(mutex_);
        status_.state = state;
    }
    void plugged(bool there) {
        const std::scoped_lock lock(mutex_);
        plugged_ = there;
    }
    void ends(JobOutcome outcome) {
        const std::scoped_lock lock(mutex_);
        progress_.outcome = outcome;
        status_.state = MachineState::Idle;
    }
    void refuses(std::string why) {
        const std::scoped_lock lock(mutex_);
        refusal_ = std::move(why);
    }

    drivers::DeviceStatus status() const {
        const std::scoped_lock lock(mutex_);
        return status_;
    }
    drivers::JobProgress progress() const {
        const std::scoped_lock lock(mutex_);
        return progress_;
    }
    std::size_t started() const {
        const std::scoped_lock lock(mutex_);
        return programs_.size();
    }
    std::string last_program() const {
        const std::scoped_lock lock(mutex_);
        return programs_.back();
    }
    int opened() const {
        const std::scoped_lock lock(mutex_);
        return opened_;
    }

    void open() {
        const std::scoped_lock lock(mutex_);
        if (!plugged_) {
            throw drivers::LinkLost("no such port");
        }
        ++opened_;
        progress_.outcome = JobOutcome::Done;  // Opening resets the controller.
        status_.state = MachineState::Idle;
    }
    void start(std::string program) {
        const std::scoped_lock lock(mutex_);
        if (!refusal_.empty()) {
            throw drivers::Refused(refusal_);
        }
        programs_.push_back(std::move(program));
        progress_ = {JobOutcome::Running, 100, 40, 30, ""};
        status_.state = MachineState::Run;
    }
    void run_once() const {
        const std::scoped_lock lock(mutex_);
        if (!plugged_) {
            throw drivers::LinkLost("the port is gone");
        }
    }

private:
    mutable std::mutex mutex_;  // Guards all members.
    drivers::DeviceStatus status_{.state = MachineState::Idle, .message = {}, .firmware = {}};
    drivers::JobProgress progress_;
    std::vector<std::string> programs_;
    std::string refusal_;
    bool plugged_ = true;
    int opened_ = 0;
};

class ScriptedDevice final : public drivers::Device {
public:
    explicit ScriptedDevice(Script& script) : script_(script) { script_.open(); }

    std::string uri() const override { return "grbl:test"; }
    drivers::DeviceStatus status() const override { return script_.status(); }
    drivers::JobProgress progress() const override { return script_.progress(); }
    void start(std::string program) override { script_.start(std::move(program)); }
    void hold() override { script_.shows(MachineState::Hold); }
    void resume() override { script_.shows(MachineState::Run); }
    void cancel() override {
        if (script_.progress().outcome == JobOutcome::Running) {
            script_.ends(JobOutcome::Aborted);
        }
    }
    void stop() override { cancel(); }
    void home() override {}
    void unlock() override {}
    void jog(const drivers::Jog&) override {}
    void jog_cancel() override {}
    void console(std::string) override {}
    void run_once(std::chrono::milliseconds) override {
        std::this_thread::sleep_for(1ms);  // As a real one waits for its wire.
        script_.run_once();
    }

private:
    Script& script_;
};

bool eventually(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(2ms);
    }
    return true;
}

class DeviceRunnerTest : public ::testing::Test {
protected:
    DeviceRunnerTest() {
        store = std::make_unique<Store>(folder.path(), [] {});
        record.id = "laser";
        record.uri = "grbl:test";
    }

    void run(FirstContact contact = FirstContact::AtOnce) {
        runner = std::make_unique<DeviceRunner>(record, *store, hooks(), contact);
    }
    void run_until_ready() {
        run();
        ASSERT_TRUE(eventually([this] { return runner->is_ready(); }));
    }
    DeviceHooks hooks() {
        return {[this](std::string_view) { return std::make_unique<ScriptedDevice>(script); },
                [](const std::string&) {},
                [this](const std::string& cut) {
                    const std::scoped_lock lock(mutex);
                    told.push_back(cut);
                }};
    }

    std::string blob(const std::string& text) {
        const auto writer = store->blobs.begin();
        writer->write(text);
        return writer->finish().sha256;
    }
    CutRecord add_cut(int sheets) {
        NewJob wanted;
        wanted.name = wanted.file.name = "head.obj";
        wanted.file.sha256 = sha256_of("abc");
        wanted.params_json = "{}";
        const JobRecord job = store->jobs.add(wanted, std::nullopt).job;
        store->jobs.claim();
        ComputedJob result;
        result.summary_json = "{}";
        for (int number = 1; number <= sheets; ++number) {
            const std::string text = "G1 X" + std::to_string(number) + " Y2 S10\n";
            result.sheets.push_back({number, "paper", blob(text), 1.0, false});
        }
        EXPECT_TRUE(store->jobs.finish({job.id}, result));
        return store->cuts.add(job.id, {{record.id, {}}}).front();
    }
    void arm(const CutRecord& cut) {
        EXPECT_TRUE(store->cuts.arm(store->cuts.find(cut.id).value()));
        runner->wake();
    }
    CutRecord cutting(int sheets = 1) {
        CutRecord cut = add_cut(sheets);
        arm(cut);
        EXPECT_TRUE(reaches(cut, CutState::Cutting));
        EXPECT_TRUE(eventually([this] { return script.started() == 1; }));
        return cut;
    }
    CutState state_of(const CutRecord& cut) { return store->cuts.find(cut.id)->state; }
    bool reaches(const CutRecord& cut, CutState state) {
        return eventually([&] { return state_of(cut) == state; });
    }
    bool is_told_of(const CutRecord& cut) {
        const std::scoped_lock lock(mutex);
        return std::find(told.begin(), told.end(), cut.id) != told.end();
    }
    void forget_told() {
        const std::scoped_lock lock(mutex);
        told.clear();
    }

    test::TempDir folder;
    std::unique_ptr<Store> store;
    Script script;
    DeviceRecord record;
    std::mutex mutex;  // Guards `told`.
    std::vector<std::string> told;
    std::unique_ptr<DeviceRunner> runner;
};

TEST_F(DeviceRunnerTest, ALinkLostInMidCutInterruptsItAndKeepsTheMachineAlone) {
    run_until_ready();
    const CutRecord cut = cutting();
    script.plugged(false);
    ASSERT_TRUE(reaches(cut, CutState::Interrupted));
    const CutRecord over = store->cuts.find(cut.id).value();
    EXPECT_EQ(over.lines_acknowledged, 30);
    EXPECT_NE(over.reason.find("30 of 100"), std::string::npos) << over.reason;
    EXPECT_NE(over.reason.find("the port is gone"), std::string::npos) << over.reason;
    script.plugged(true);
    // The cut's end is told before the runner lets go of it.
    EXPECT_TRUE(eventually([this] { return !runner->current_cut(); }));
    EXPECT_EQ(script.opened(), 1);
    EXPECT_TRUE(
        eventually([this] { return runner->status().message.find("reset") != std::string::npos; }));
    runner->reset();
    EXPECT_TRUE(eventually([this] { return runner->is_ready(); }));
    EXPECT_EQ(script.started(), 1U);
}

TEST_F(DeviceRunnerTest, AnIdleMachineWhoseLinkWasLostIsTakenBackByItself) {
    run_until_ready();
    script.plugged(false);
    ASSERT_TRUE(eventually([this] { return !runner->is_ready(); }));
    script.plugged(true);
    EXPECT_TRUE(eventually([this] { return runner->is_ready(); }));
}

TEST_F(DeviceRunnerTest, ACutArmedWithoutAMachineNeverFiresWhenItComes) {
    const CutRecord cut = add_cut(1);
    ASSERT_TRUE(store->cuts.arm(cut));
    run_until_ready();
    EXPECT_TRUE(reaches(cut, CutState::Waiting));
    EXPECT_EQ(script.started(), 0U);
}

TEST_F(DeviceRunnerTest, ACutArmedForAMachineInAlarmGoesBackToTheQueue) {
    run_until_ready();
    const CutRecord cut = add_cut(1);
    script.shows(MachineState::Alarm);
    arm(cut);
    ASSERT_TRUE(eventually([&] { return !store->cuts.find(cut.id)->reason.empty(); }));
    EXPECT_EQ(state_of(cut), CutState::Waiting);
    EXPECT_NE(store->cuts.find(cut.id)->reason.find("alarm"), std::string::npos);
    EXPECT_FALSE(runner->is_ready());
    EXPECT_EQ(script.started(), 0U);
}

TEST_F(DeviceRunnerTest, AnAlarmInMidCutFailsItAndTheQueueWaits) {
    record.auto_start = true;
    run_until_ready();
    const CutRecord first = add_cut(1);
    const CutRecord second = add_cut(1);
    runner->wake();
    ASSERT_TRUE(reaches(first, CutState::Cutting));
    ASSERT_TRUE(eventually([this] { return script.started() == 1; }));
    script.ends(JobOutcome::Failed);
    script.shows(MachineState::Alarm);
    ASSERT_TRUE(reaches(first, CutState::Failed));
    EXPECT_EQ(state_of(second), CutState::Waiting);
    EXPECT_EQ(script.started(), 1U);
}

TEST_F(DeviceRunnerTest, AMachineOfItsOwnWaitsForAWordAfterACutThatEndedEarly) {
    record.auto_start = true;
    run_until_ready();
    const CutRecord first = add_cut(1);
    const CutRecord second = add_cut(1);
    runner->wake();
    ASSERT_TRUE(eventually([this] { return script.started() == 1; }));
    EXPECT_TRUE(runner->abort(first.id));
    ASSERT_TRUE(reaches(first, CutState::Aborted));
    ASSERT_TRUE(eventually([this] { return runner->is_ready(); }));
    runner->wake();
    runner.reset();  // It has looked at its queue once more by then, and a new daemon waits, too.
    EXPECT_EQ(state_of(second), CutState::Waiting);
    run_until_ready();
    runner->wake();
    runner.reset();
    EXPECT_EQ(state_of(second), CutState::Waiting);
    EXPECT_EQ(script.started(), 1U);
    run_until_ready();
    runner->reset();
    EXPECT_TRUE(reaches(second, CutState::Cutting));
}

TEST_F(DeviceRunnerTest, TheRestOfACutIsInOneHandAndNeverGoesByItself) {
    record.auto_start = true;
    run_until_ready();
    const CutRecord cut = add_cut(2);
    runner->wake();
    ASSERT_TRUE(eventually([this] { return script.started() == 1; }));
    EXPECT_TRUE(runner->abort(cut.id));
    ASSERT_TRUE(reaches(cut, CutState::Aborted));
    const CutRecord over = store->cuts.find(cut.id).value();
    EXPECT_TRUE(store->cuts.may_be_finished(over));
    const std::string program = blob("G1 X5 Y5 S10 F600\n");
    const auto rest = store->cuts.add_rest(over, program);
    ASSERT_TRUE(rest);
    EXPECT_EQ(rest->program_sha256, program);
    EXPECT_EQ(rest->sheets, over.sheets);
    EXPECT_FALSE(store->cuts.may_be_finished(over));
    EXPECT_FALSE(store->cuts.add_rest(over, program));
    runner->reset();
    runner->wake();
    EXPECT_FALSE(store->cuts.last_begun_on(record.id)->is_rest());
    // Withdrawn before it began, it leaves the rest to another.
    ASSERT_TRUE(store->cuts.move(rest->id, CutState::Waiting, CutState::Aborted));
    EXPECT_TRUE(store->cuts.may_be_finished(over));
    const auto again = store->cuts.add_rest(over, program);
    ASSERT_TRUE(again);
    arm(*again);
    ASSERT_TRUE(eventually([this] { return script.started() == 2; }));
    EXPECT_EQ(script.last_program(), "G1 X5 Y5 S10 F600\n");
    EXPECT_TRUE(runner->abort(again->id));
    ASSERT_TRUE(reaches(*again, CutState::Aborted));
    EXPECT_FALSE(store->cuts.may_be_finished(over));
    EXPECT_TRUE(store->cuts.may_be_finished(store->cuts.find(again->id).value()));
}

TEST_F(DeviceRunnerTest, ACutKeepsWhatItsJournalKnowsOfTheBeam) {
    run_until_ready();
    const CutRecord cut = add_cut(1);
    BeamRecord beam;
    beam.least_mm = 1.5;
    beam.most_mm = 2.25;
    beam.total_mm = 100.0;
    beam.line = 7;
    beam.at_mm = {-3.0, 4.5};
    beam.certain = true;
    store->cuts.record_beam(cut.id, beam);
    const BeamRecord kept = store->cuts.find(cut.id)->beam.value();
    EXPECT_EQ(kept.least_mm, 1.5);
    EXPECT_EQ(kept.most_mm, 2.25);
    EXPECT_EQ(kept.line, 7);
    EXPECT_EQ(kept.at_mm, beam.at_mm);
    EXPECT_TRUE(kept.certain);
    EXPECT_FALSE(kept.position_kept);
}

TEST_F(DeviceRunnerTest, WhatTheMachineDoesIsWhatTheCutIs) {
    run_until_ready();
    const CutRecord cut = cutting();
    script.shows(MachineState::Hold);
    EXPECT_TRUE(reaches(cut, CutState::Paused));
    script.shows(MachineState::Run);
    EXPECT_TRUE(reaches(cut, CutState::Cutting));
    script.shows(MachineState::Door);
    EXPECT_TRUE(reaches(cut, CutState::Paused));
    EXPECT_TRUE(runner->abort(cut.id));
    EXPECT_TRUE(reaches(cut, CutState::Aborted));
    EXPECT_FALSE(runner->abort(cut.id));
    EXPECT_FALSE(runner->pause(cut.id));
}

TEST_F(DeviceRunnerTest, AProgramTheMachineRefusesFailsTheCutWithItsReason) {
    run_until_ready();
    script.refuses("line 7: beyond the bed");
    const CutRecord cut = add_cut(1);
    arm(cut);
    ASSERT_TRUE(reaches(cut, CutState::Failed));
    EXPECT_EQ(store->cuts.find(cut.id)->reason, "line 7: beyond the bed");
}

TEST_F(DeviceRunnerTest, EverySheetButTheFirstWaitsForItsWord) {
    run_until_ready();
    const CutRecord cut = cutting(2);
    EXPECT_EQ(script.last_program(), "G1 X1 Y2 S10\n");
    script.ends(JobOutcome::Done);
    ASSERT_TRUE(reaches(cut, CutState::AwaitingSheet));
    runner->wake();
    ASSERT_TRUE(eventually([this] { return runner->is_ready(); }));
    EXPECT_EQ(script.started(), 1U);
    arm(cut);
    ASSERT_TRUE(eventually([this] { return script.started() == 2; }));
    EXPECT_EQ(script.last_program(), "G1 X2 Y2 S10\n");
    script.ends(JobOutcome::Done);
    EXPECT_TRUE(reaches(cut, CutState::Done));
}

TEST_F(DeviceRunnerTest, AMachineOfItsOwnFinishesABegunCutBeforeOlderOnes) {
    run_until_ready();
    const CutRecord older = add_cut(1);
    const CutRecord begun = cutting(2);
    script.ends(JobOutcome::Done);
    ASSERT_TRUE(reaches(begun, CutState::AwaitingSheet));
    runner.reset();
    record.auto_start = true;
    run();
    ASSERT_TRUE(reaches(begun, CutState::Cutting));
    EXPECT_EQ(state_of(older), CutState::Waiting);
}

TEST_F(DeviceRunnerTest, AStoppedDaemonInterruptsItsCutWithTheMachineHeld) {
    run_until_ready();
    const CutRecord cut = cutting();
    runner.reset();
    EXPECT_EQ(state_of(cut), CutState::Interrupted);
    EXPECT_EQ(script.progress().outcome, JobOutcome::Aborted);
}

TEST_F(DeviceRunnerTest, NothingStartsWhileAFrameIsTraced) {
    run_until_ready();
    const CutRecord cut = add_cut(1);
    runner->frame();
    EXPECT_FALSE(runner->is_ready());
    ASSERT_TRUE(eventually([this] { return script.started() == 1; }));
    EXPECT_EQ(script.last_program().find('S'), script.last_program().find("S0"));
    EXPECT_FALSE(runner->is_ready());
    script.ends(JobOutcome::Done);
    EXPECT_TRUE(eventually([this] { return runner->is_ready(); }));
    EXPECT_EQ(state_of(cut), CutState::Waiting);
}

TEST_F(DeviceRunnerTest, AMachineToBeLookedAtIsOpenedOnlyAfterAReset) {
    run(FirstContact::AfterReset);
    EXPECT_NE(runner->status().message.find("reset"), std::string::npos);
    EXPECT_THROW(runner->home(), drivers::Refused);
    EXPECT_EQ(script.opened(), 0);
    runner->reset();
    EXPECT_TRUE(eventually([this] { return runner->is_ready(); }));
}

TEST_F(DeviceRunnerTest, ThoseWhoWaitAreToldWhenTheMachineIsTaken) {
    run_until_ready();
    const CutRecord waiting = add_cut(1);
    forget_told();
    const CutRecord busy = cutting();
    EXPECT_TRUE(eventually([&] { return is_told_of(waiting); }));
    forget_told();
    script.ends(JobOutcome::Done);
    ASSERT_TRUE(reaches(busy, CutState::Done));
    EXPECT_TRUE(eventually([&] { return is_told_of(waiting); }));
}

TEST_F(DeviceRunnerTest, AFleetKeepsAMachineAtWorkAsItIs) {
    store->devices.put(record);
    store->devices.remove("sim");
    DeviceFleet fleet(*store, hooks());
    const CutRecord cut = add_cut(1);
    auto laser = fleet.find(record.id);
    ASSERT_TRUE(eventually([&] { return laser->is_ready(); }));
    ASSERT_TRUE(store->cuts.arm(cut));
    laser->wake();
    laser.reset();
    ASSERT_TRUE(reaches(cut, CutState::Cutting));
    EXPECT_THROW(fleet.put(record), drivers::Refused);
    EXPECT_THROW(fleet.remove(record.id), drivers::Refused);
    EXPECT_EQ(state_of(cut), CutState::Cutting);
    fleet.stop_all();
    EXPECT_EQ(state_of(cut), CutState::Interrupted);
}

}  // namespace
}  // namespace leafcutter::server
