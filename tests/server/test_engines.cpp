// What every engine below the store keeps to. A new one is added to the list at the end.

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "server/store/blobs.h"
#include "server/store/sqlite/engine.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::server {
namespace {

struct EngineKind {
    const char* name;
    std::function<std::unique_ptr<Engine>(const std::filesystem::path& folder)> open;
};

class EngineTest : public ::testing::TestWithParam<EngineKind> {
protected:
    EngineTest() { open(); }

    void open() {
        store = GetParam().open(folder.path());
        store->jobs().recover();
        interrupted_devices = store->cuts().recover();
    }
    void reopen() {
        store.reset();
        open();
    }

    JobRecord add(const std::string& name = "head.obj") {
        return store->jobs().add({name, {name, 3, sha256_of("abc")}, "{}"}, std::nullopt).job;
    }

    JobRecord add_ready(int sheets) {
        const JobRecord job = add();
        store->jobs().claim();
        ComputedJob result;
        result.summary_json = "{}";
        for (int number = 1; number <= sheets; ++number) {
            const std::string program = sha256_of(std::to_string(number));
            result.sheets.push_back({number, "paper", program, 1.0, false});
        }
        EXPECT_TRUE(store->jobs().finish(job.id, result));
        return store->jobs().find(job.id).value();
    }

    CutRecord armed(const CutRecord& cut) {
        EXPECT_TRUE(store->cuts().arm(cut));
        return store->cuts().find(cut.id).value();
    }

    CutState state_of(const CutRecord& cut) { return store->cuts().find(cut.id)->state; }

    test::TempDir folder;
    std::vector<std::string> order() const {
        std::vector<std::string> names;
        for (const JobRecord& job : store->jobs().queue(100)) {
            names.push_back(job.name);
        }
        return names;
    }

    std::unique_ptr<Engine> store;
    std::vector<std::string> interrupted_devices;
};

TEST_P(EngineTest, JobsAreClaimedOldestFirstAndOnce) {
    const JobRecord first = add();
    const JobRecord second = add();
    EXPECT_EQ(store->jobs().claim()->id, first.id);
    EXPECT_EQ(store->jobs().claim()->id, second.id);
    EXPECT_FALSE(store->jobs().claim());
}

TEST_P(EngineTest, ManyClaimersNeverShareAJob) {
    constexpr int kJobs = 40;
    for (int i = 0; i < kJobs; ++i) {
        add();
    }
    std::mutex mutex;
    std::set<std::string> claimed;
    std::atomic<int> count{0};
    {
        std::vector<std::jthread> claimers;
        for (int i = 0; i < 4; ++i) {
            claimers.emplace_back([&] {
                while (const auto job = store->jobs().claim()) {
                    const std::scoped_lock lock(mutex);
                    claimed.insert(job->id);
                    ++count;
                }
            });
        }
    }
    EXPECT_EQ(count, kJobs);
    EXPECT_EQ(claimed.size(), static_cast<std::size_t>(kJobs));
}

TEST_P(EngineTest, TheSameKeyGivesTheSameJob) {
    const NewJob job{"n", {"n.obj", 3, sha256_of("abc")}, "{}"};
    const AddedJob first = store->jobs().add(job, IdempotencyKey{"k", "hash"});
    const AddedJob again = store->jobs().add(job, IdempotencyKey{"k", "hash"});
    EXPECT_FALSE(first.replayed);
    EXPECT_TRUE(again.replayed);
    EXPECT_EQ(first.job.id, again.job.id);
    EXPECT_THROW(store->jobs().add(job, IdempotencyKey{"k", "other"}), KeyReused);
    EXPECT_EQ(store->jobs().list({}).size(), 1U);
}

TEST_P(EngineTest, AJobCutShortGoesBackToTheQueueAndFailsInTheEnd) {
    const JobRecord job = add();
    for (int attempt = 1; attempt <= JobStore::kMostAttempts; ++attempt) {
        ASSERT_EQ(store->jobs().claim()->attempt, attempt);
        reopen();
    }
    const JobRecord last = store->jobs().find(job.id).value();
    EXPECT_EQ(last.state, JobState::Failed);
    EXPECT_EQ(last.failure->code, "poison-job");
}

TEST_P(EngineTest, AResultForACancelledJobIsDropped) {
    const JobRecord job = add();
    store->jobs().claim();
    EXPECT_TRUE(store->jobs().cancel(job.id));
    EXPECT_FALSE(store->jobs().finish(job.id, {}));
    EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Cancelled);
}

TEST_P(EngineTest, EventNumbersHaveNoGapAndEveryChangeHasOne) {
    const JobRecord job = add();
    store->jobs().claim();
    store->jobs().fail(job.id, {"bad-file", "x", "y"});
    store->jobs().remove(job.id);
    const auto events = store->events().after(0, 100);
    ASSERT_EQ(events.size(), 4U);
    for (std::size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(events[i].seq, static_cast<std::int64_t>(i) + 1);
    }
    EXPECT_EQ(events[2].note, "computing -> failed");
}

TEST_P(EngineTest, AJobIsDoneWhenItsLastSheetIsCut) {
    const JobRecord job = add_ready(2);
    CutRecord cut = store->cuts().add(job.id, {{"sim", {}}}).front();
    EXPECT_EQ(cut.sheets, (std::vector<int>{1, 2}));
    cut = armed(cut);
    ASSERT_TRUE(store->cuts().begin_sheet(cut));
    ASSERT_TRUE(store->cuts().finish_sheet(cut, {}));
    cut = store->cuts().find(cut.id).value();
    EXPECT_EQ(cut.state, CutState::AwaitingSheet);
    EXPECT_EQ(cut.sheet(), 2);
    EXPECT_EQ(cut.program_sha256, sha256_of("2"));
    EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Ready);
    cut = armed(cut);
    ASSERT_TRUE(store->cuts().begin_sheet(cut));
    ASSERT_TRUE(store->cuts().finish_sheet(cut, {}));
    EXPECT_EQ(state_of(cut), CutState::Done);
    EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Done);
}

TEST_P(EngineTest, OnlyOneCutOccupiesADevice) {
    const JobRecord job = add_ready(1);
    const CutRecord first = store->cuts().add(job.id, {{"sim", {}}}).front();
    const CutRecord second = store->cuts().add(job.id, {{"sim", {}}}).front();
    armed(first);
    EXPECT_FALSE(store->cuts().arm(second));
    EXPECT_EQ(state_of(second), CutState::Waiting);
}

TEST_P(EngineTest, ASheetBeginsOncePerArming) {
    const CutRecord cut = armed(store->cuts().add(add_ready(1).id, {{"sim", {}}}).front());
    EXPECT_TRUE(store->cuts().begin_sheet(cut));
    EXPECT_FALSE(store->cuts().begin_sheet(cut));
}

TEST_P(EngineTest, ACutInMidBeamIsInterruptedAndAnArmedOneDisarmedByARestart) {
    const JobRecord job = add_ready(1);
    const CutRecord burning = armed(store->cuts().add(job.id, {{"one", {}}}).front());
    store->cuts().begin_sheet(burning);
    store->cuts().record_progress(burning.id, {100, 40, 30});
    const CutRecord waiting = armed(store->cuts().add(job.id, {{"two", {}}}).front());
    reopen();
    EXPECT_EQ(state_of(burning), CutState::Interrupted);
    EXPECT_EQ(state_of(waiting), CutState::Waiting);
    EXPECT_EQ(interrupted_devices, (std::vector<std::string>{"one"}));
    EXPECT_NE(store->cuts().find(burning.id)->reason.find("30 of 100"), std::string::npos);
}

TEST_P(EngineTest, AJobWithACutUnderWayStays) {
    const JobRecord job = add_ready(1);
    const CutRecord cut = store->cuts().add(job.id, {{"sim", {}}}).front();
    EXPECT_EQ(store->jobs().remove(job.id), Removal::StillInUse);
    store->cuts().move(cut.id, CutState::Waiting, CutState::Aborted);
    EXPECT_EQ(store->jobs().remove(job.id), Removal::Removed);
    EXPECT_EQ(store->jobs().remove(job.id), Removal::NotThere);
}

TEST_P(EngineTest, RefusesSheetsThatAreNotThere) {
    EXPECT_THROW(store->cuts().add(add_ready(1).id, {{"sim", {2}}}), NotCuttable);
    EXPECT_THROW(store->cuts().add(add().id, {{"sim", {}}}), NotCuttable);
}

TEST_P(EngineTest, AMoveThatTheTableForbidsIsAMistakeOfOurs) {
    const CutRecord cut = store->cuts().add(add_ready(1).id, {{"sim", {}}}).front();
    EXPECT_THROW(store->cuts().move(cut.id, CutState::Waiting, CutState::Cutting),
                 std::logic_error);
}

TEST_P(EngineTest, AFreshFolderHasASimulatedMachine) {
    const auto device = store->devices().find("sim");
    ASSERT_TRUE(device);
    EXPECT_EQ(device->uri, "sim:grbl");
    EXPECT_FALSE(device->auto_start);
}

TEST_P(EngineTest, TheQueueGoesByPriorityThenByPlace) {
    const JobRecord a = add("a");
    const JobRecord b = add("b");
    const JobRecord c = add("c");
    EXPECT_TRUE(store->jobs().set_priority(c.id, 7));
    EXPECT_EQ(order(), (std::vector<std::string>{"c", "a", "b"}));
    EXPECT_TRUE(store->jobs().move_to(b.id, 1));
    EXPECT_EQ(order(), (std::vector<std::string>{"b", "c", "a"}));
    EXPECT_EQ(store->jobs().find(b.id)->priority, 7);
    EXPECT_TRUE(store->jobs().move_to(c.id, 100));
    add("d");
    EXPECT_EQ(order(), (std::vector<std::string>{"b", "a", "c", "d"}));
    EXPECT_EQ(store->jobs().claim()->id, b.id);
    EXPECT_FALSE(store->jobs().move_to(b.id, 1));
    EXPECT_FALSE(store->jobs().set_priority("j_none", 1));
}

TEST_P(EngineTest, ManyMovesToOnePlaceNeverRunOutOfRoom) {
    std::vector<std::string> wanted;
    add("first");
    const JobRecord last = add("last");
    constexpr int kMoves = 60;  // More than a gap between two places can be halved.
    for (int i = 0; i < kMoves; ++i) {
        const JobRecord job = add(std::to_string(i));
        ASSERT_TRUE(store->jobs().move_to(job.id, 2));
        wanted.insert(wanted.begin(), job.name);
    }
    wanted.insert(wanted.begin(), "first");
    wanted.push_back(last.name);
    add("later");
    wanted.emplace_back("later");
    EXPECT_EQ(order(), wanted);
}

TEST_P(EngineTest, NobodyClaimsFromAPausedQueue) {
    const JobRecord job = add();
    EXPECT_FALSE(store->jobs().queue_pause());
    store->jobs().pause_queue("inventory");
    EXPECT_FALSE(store->jobs().claim());
    reopen();
    EXPECT_EQ(store->jobs().queue_pause().value_or(""), "inventory");
    EXPECT_FALSE(store->jobs().claim());
    store->jobs().resume_queue();
    EXPECT_EQ(store->jobs().claim()->id, job.id);
}

TEST_P(EngineTest, AJobThatBreaksItsProcessEndsAsADeadLetter) {
    const JobRecord job = add();
    for (int attempt = 1; attempt < JobStore::kMostAttempts; ++attempt) {
        ASSERT_TRUE(store->jobs().claim());
        EXPECT_TRUE(store->jobs().crashed(job.id, "signal 11"));
        EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Queued);
    }
    ASSERT_TRUE(store->jobs().claim());
    EXPECT_TRUE(store->jobs().crashed(job.id, "signal 11"));
    const auto dead = store->jobs().find(job.id);
    EXPECT_EQ(dead->state, JobState::Failed);
    EXPECT_EQ(dead->failure->code, "poison-job");
    EXPECT_EQ(store->jobs().queue_counts().dead_letters, 1);
    JobQuery query;
    query.dead_letters = true;
    add("healthy");
    ASSERT_EQ(store->jobs().list(query).size(), 1U);
    EXPECT_FALSE(store->jobs().crashed(job.id, "late"));
}

TEST_P(EngineTest, ARetryForgetsTheFailureAndKeepsTheCause) {
    const JobRecord job = add();
    EXPECT_FALSE(store->jobs().retry(job.id, "too early"));
    store->jobs().claim();
    store->jobs().fail(job.id, {"internal", "out-of-memory", "too large"});
    EXPECT_TRUE(store->jobs().retry(job.id, "more memory"));
    const auto again = store->jobs().find(job.id);
    EXPECT_EQ(again->state, JobState::Queued);
    EXPECT_FALSE(again->failure);
    EXPECT_EQ(again->attempt, 0);
    EXPECT_EQ(again->retries, 1);
    EXPECT_EQ(again->retry_cause, "more memory");
}

TEST_P(EngineTest, ACutSheetTakesItsStockAndLeavesItsOffcut) {
    StockRecord left;
    left.id = "left";
    left.json = "{}";
    left.material = "paper";
    left.quantity = 2;
    EXPECT_TRUE(store->stock().put(left));
    const JobRecord job = add();
    store->jobs().claim();
    ComputedJob result;
    result.summary_json = "{}";
    for (int number = 1; number <= 2; ++number) {
        SheetRecord sheet;
        sheet.number = number;
        sheet.material = "paper";
        sheet.program_sha256 = sha256_of(std::to_string(number));
        sheet.stock = "left";
        sheet.offcut_json = number == 1 ? R"({"width_mm":5})" : "";
        result.sheets.push_back(sheet);
    }
    store->jobs().finish(job.id, result);
    EXPECT_EQ(store->stock().find("left")->planned, 2);
    CutRecord cut = store->cuts().add(job.id, {{"sim", {1}}}).front();
    cut = armed(cut);
    store->cuts().begin_sheet(cut);
    EXPECT_EQ(store->stock().find("left")->quantity, 2);
    store->cuts().finish_sheet(store->cuts().find(cut.id).value(), {});
    EXPECT_EQ(store->stock().find("left")->quantity, 1);
    EXPECT_EQ(store->stock().find("left")->planned, 1);
    const auto stock = store->stock().list();
    ASSERT_EQ(stock.size(), 2U);
    const StockRecord& offcut = stock[0].id == "left" ? stock[1] : stock[0];
    EXPECT_EQ(offcut.from_job, job.id);
    EXPECT_EQ(offcut.json, R"({"width_mm":5})");
    // The same sheet again, on fresh material: that is nobody's plan.
    CutRecord again = armed(store->cuts().add(job.id, {{"sim", {1}}}).front());
    store->cuts().begin_sheet(again);
    store->cuts().finish_sheet(store->cuts().find(again.id).value(), {});
    EXPECT_EQ(store->stock().find("left")->quantity, 1);
    // The last one of its kind is gone.
    CutRecord last = armed(store->cuts().add(job.id, {{"sim", {2}}}).front());
    store->cuts().begin_sheet(last);
    store->cuts().finish_sheet(store->cuts().find(last.id).value(), {});
    EXPECT_FALSE(store->stock().find("left"));
}

TEST_P(EngineTest, CutsOfOneRequestAreAddedTogetherOrNotAtAll) {
    const JobRecord job = add_ready(2);
    EXPECT_THROW(store->cuts().add(job.id, {{"one", {1}}, {"two", {3}}}), NotCuttable);
    EXPECT_TRUE(store->cuts().open_on("one").empty());
    EXPECT_EQ(store->cuts().add(job.id, {{"one", {1}}, {"two", {2}}}).size(), 2U);
}

TEST_P(EngineTest, OldJobsGoAndThoseWithSomethingLeftToDoStay) {
    const JobRecord failed = add("failed");
    store->jobs().claim();
    store->jobs().fail(failed.id, {"bad-file", "x", "y"});
    const JobRecord waiting = add("waiting");
    constexpr std::int64_t kNow = INT64_MAX;
    EXPECT_EQ(store->jobs().remove_finished(0, 10), 0);
    EXPECT_EQ(store->jobs().remove_finished(kNow, 10), 1);
    EXPECT_FALSE(store->jobs().find(failed.id));
    EXPECT_TRUE(store->jobs().find(waiting.id));
}

TEST_P(EngineTest, APackageThatIsLetGoLeavesItsJob) {
    const JobRecord job = add();
    store->jobs().claim();
    ComputedJob result;
    result.summary_json = "{}";
    result.artifacts.push_back({"report.json", 3, sha256_of("abc"), "application/json"});
    SheetRecord sheet;
    sheet.program_sha256 = sha256_of("abc");
    result.sheets.push_back(sheet);
    store->jobs().finish(job.id, result);
    EXPECT_EQ(store->jobs().drop_packages(INT64_MAX, 10), 0);  // It is ready, not cut yet.
    const CutRecord cut = armed(store->cuts().add(job.id, {{"sim", {}}}).front());
    store->cuts().begin_sheet(cut);
    store->cuts().finish_sheet(store->cuts().find(cut.id).value(), {});
    EXPECT_EQ(store->jobs().drop_packages(INT64_MAX, 10), 1);
    EXPECT_TRUE(store->jobs().artifacts(job.id).empty());
    EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Done);
}

TEST_P(EngineTest, OldEventsGoFromTheFrontAndNumbersAreNeverGivenTwice) {
    add();
    add();
    const std::int64_t last = store->events().last_seq();
    EXPECT_EQ(store->events().first_seq(), 1);
    EXPECT_EQ(store->events().forget(0, 100), 0);
    EXPECT_EQ(store->events().forget(INT64_MAX, 100), 1);  // The newest one stays.
    EXPECT_EQ(store->events().first_seq(), last);
    reopen();
    add();
    EXPECT_EQ(store->events().last_seq(), last + 1);
}

TEST_P(EngineTest, RecordsAreFoundByName) {
    EXPECT_TRUE(store->presets().put({"a", "{}"}));
    EXPECT_FALSE(store->presets().put({"a", "{\"b\":1}"}));
    EXPECT_EQ(store->presets().find("a")->json, "{\"b\":1}");
    EXPECT_FALSE(store->materials().find("a"));
    store->presets().put_all({{"b", "1"}, {"c", "2"}});
    EXPECT_EQ(store->presets().list().size(), 3U);
    EXPECT_TRUE(store->presets().remove("a"));
    EXPECT_FALSE(store->presets().remove("a"));
    EXPECT_FALSE(store->settings().get("x"));
    store->settings().put("x", "1");
    EXPECT_EQ(store->settings().get("x").value_or(""), "1");
}

TEST_P(EngineTest, ABackupHoldsWhatWasThereAndWorkGoesOn) {
    const JobRecord job = add();
    std::filesystem::create_directory(folder.path() / "copy");
    store->back_up_to(folder.path() / "copy" / "leafcutter.db");
    add("later");
    EXPECT_TRUE(store->check().empty());
    const auto copy = GetParam().open(folder.path() / "copy");
    EXPECT_TRUE(copy->jobs().find(job.id));
    EXPECT_EQ(copy->jobs().queue(10).size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Engines,
                         EngineTest,
                         ::testing::Values(EngineKind{
                             "sqlite",
                             [](const std::filesystem::path& folder) {
                                 return open_sqlite(folder, folder / "backups", [] {}).engine;
                             }}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace leafcutter::server
