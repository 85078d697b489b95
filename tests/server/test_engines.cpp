// What every engine below the store keeps to. A new one is added to the list at the end.

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "server/fleet/duties.h"
#include "server/store/blobs.h"
#include "server/store/postgres/engine.h"
#include "server/store/sql/columns.h"
#include "server/store/sql/copy.h"
#include "server/store/sqlite/engine.h"
#include "tests/support/pg_server.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::server {
namespace {

struct EngineKind {
    const char* name;
    std::function<std::unique_ptr<Engine>(const std::filesystem::path& folder, const NodeScope&)>
        open;
    const char* columns_of;  // A query of the names of a table's columns.
};

class EngineTest : public ::testing::TestWithParam<EngineKind> {
protected:
    EngineTest() { open(); }

    void open() {
        store = GetParam().open(folder.path(), {});
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
        EXPECT_TRUE(store->jobs().finish({job.id}, result));
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

TEST_P(EngineTest, PiecesThatAreWantedAgainCanBeClaimedApart) {
    const JobRecord model = add();
    NewJob pieces{"pieces", {"n.obj", 3, sha256_of("abc")}, "{}", model.id, R"({"pieces":["W1"]})"};
    const JobRecord recut = store->jobs().add(pieces, std::nullopt).job;
    EXPECT_EQ(recut.recut_of, model.id);
    EXPECT_EQ(recut.recut_json, pieces.recut_json);
    EXPECT_EQ(store->jobs().claim_recut()->id, recut.id);
    EXPECT_FALSE(store->jobs().claim_recut());
    store->jobs().requeue({recut.id});
    EXPECT_EQ(store->jobs().claim()->id, model.id);
    EXPECT_EQ(store->jobs().claim()->id, recut.id);  // Any worker takes it when it is next.
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
    EXPECT_FALSE(store->jobs().finish({job.id}, {}));
    EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Cancelled);
}

TEST_P(EngineTest, EventNumbersHaveNoGapAndEveryChangeHasOne) {
    const JobRecord job = add();
    store->jobs().claim();
    store->jobs().fail({job.id}, {"bad-file", "x", "y"});
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
        EXPECT_TRUE(store->jobs().crashed({job.id}, "signal 11"));
        EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Queued);
    }
    ASSERT_TRUE(store->jobs().claim());
    EXPECT_TRUE(store->jobs().crashed({job.id}, "signal 11"));
    const auto dead = store->jobs().find(job.id);
    EXPECT_EQ(dead->state, JobState::Failed);
    EXPECT_EQ(dead->failure->code, "poison-job");
    EXPECT_EQ(store->jobs().queue_counts().dead_letters, 1);
    JobQuery query;
    query.dead_letters = true;
    add("healthy");
    ASSERT_EQ(store->jobs().list(query).size(), 1U);
    EXPECT_FALSE(store->jobs().crashed({job.id}, "late"));
}

TEST_P(EngineTest, ARetryForgetsTheFailureAndKeepsTheCause) {
    const JobRecord job = add();
    EXPECT_FALSE(store->jobs().retry(job.id, "too early"));
    store->jobs().claim();
    store->jobs().fail({job.id}, {"internal", "out-of-memory", "too large"});
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
    store->jobs().finish({job.id}, result);
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

constexpr std::chrono::hours kHour{1};

TEST_P(EngineTest, OldJobsGoAndThoseWithSomethingLeftToDoStay) {
    const JobRecord failed = add("failed");
    store->jobs().claim();
    store->jobs().fail({failed.id}, {"bad-file", "x", "y"});
    const JobRecord waiting = add("waiting");
    EXPECT_EQ(store->jobs().remove_finished(kHour, 10), 0);
    EXPECT_EQ(store->jobs().remove_finished(-kHour, 10), 1);
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
    store->jobs().finish({job.id}, result);
    EXPECT_EQ(store->jobs().drop_packages(-kHour, 10), 0);  // It is ready, not cut yet.
    const CutRecord cut = armed(store->cuts().add(job.id, {{"sim", {}}}).front());
    store->cuts().begin_sheet(cut);
    store->cuts().finish_sheet(store->cuts().find(cut.id).value(), {});
    EXPECT_EQ(store->jobs().drop_packages(-kHour, 10), 1);
    EXPECT_TRUE(store->jobs().artifacts(job.id).empty());
    EXPECT_EQ(store->jobs().find(job.id)->state, JobState::Done);
}

TEST_P(EngineTest, OldEventsGoFromTheFrontAndNumbersAreNeverGivenTwice) {
    add();
    add();
    const std::int64_t last = store->events().last_seq();
    EXPECT_EQ(store->events().first_seq(), 1);
    EXPECT_EQ(store->events().forget(kHour, 100), 0);
    EXPECT_EQ(store->events().forget(-kHour, 100), 1);  // The newest one stays.
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
    const auto copy = GetParam().open(folder.path() / "copy", {});
    EXPECT_TRUE(copy->jobs().find(job.id));
    EXPECT_EQ(copy->jobs().queue(10).size(), 1U);
}

TEST_P(EngineTest, NobodyButTheOneWhoClaimedLastSettlesAJob) {
    add();
    const JobRecord zombie = store->jobs().claim().value();
    ASSERT_TRUE(store->jobs().requeue({zombie.id, zombie.fence}));
    const JobRecord claimed = store->jobs().claim().value();
    ASSERT_EQ(claimed.id, zombie.id);
    EXPECT_GT(claimed.fence, zombie.fence);
    EXPECT_FALSE(store->jobs().finish({zombie.id, zombie.fence}, {}));
    EXPECT_FALSE(store->jobs().fail({zombie.id, zombie.fence}, {"internal", "x", "y"}));
    EXPECT_FALSE(store->jobs().crashed({zombie.id, zombie.fence}, "late"));
    EXPECT_EQ(store->jobs().find(claimed.id)->state, JobState::Computing);
    ComputedJob result;
    result.summary_json = "{}";
    EXPECT_TRUE(store->jobs().finish({claimed.id, claimed.fence}, result));
}

// Two nodes on the same rows. With the lease of a daemon that stands still, all of them are over.
class FleetTest : public EngineTest {
protected:
    std::unique_ptr<Engine> node(const std::string& name, std::chrono::milliseconds lease) {
        return GetParam().open(folder.path(), {name, lease});
    }
    CutRecord armed_on(Engine& station, const std::string& device) {
        DeviceRecord record;
        record.id = device;
        record.uri = "sim:grbl";
        record.station = "hall";
        station.devices().put(record);
        return armed(store->cuts().add(add_ready(1).id, {{device, {}}}).front());
    }
    static constexpr std::chrono::minutes kLong{10};
    static constexpr std::chrono::milliseconds kOver{1};
    static void let_leases_end() { std::this_thread::sleep_for(2 * kOver); }
};

TEST_P(FleetTest, AJobOfAWorkerThatWentAwayIsClaimedByAnother) {
    const JobRecord job = add();
    const auto lost = node("lost", kOver);
    const auto other = node("other", kLong);
    const JobRecord first = lost->jobs().claim().value();
    EXPECT_EQ(first.owner, "lost");
    let_leases_end();
    EXPECT_EQ(other->fleet().reap().jobs, 1);
    EXPECT_EQ(lost->fleet().renew({{job.id, first.fence}}), std::vector<std::string>{job.id});
    const JobRecord second = other->jobs().claim().value();
    EXPECT_EQ(second.owner, "other");
    EXPECT_EQ(other->fleet().reap().jobs, 0);
    EXPECT_FALSE(lost->jobs().finish({job.id, first.fence}, {}));
    EXPECT_TRUE(other->fleet().renew({{job.id, second.fence}}).empty());
}

TEST_P(FleetTest, ANodeThatStartsAgainTakesUpItsOwnJobsAlone) {
    add("a");
    add("b");
    const auto one = node("one", kLong);
    const auto two = node("two", kLong);
    const JobRecord mine = one->jobs().claim().value();
    const JobRecord theirs = two->jobs().claim().value();
    one->jobs().recover();
    EXPECT_EQ(store->jobs().find(mine.id)->state, JobState::Queued);
    EXPECT_EQ(store->jobs().find(theirs.id)->state, JobState::Computing);
}

TEST_P(FleetTest, AMachineHangsOnOneStationAtATime) {
    const auto hall = node("hall", kLong);
    const auto copy = node("hall-copy", kLong);
    armed_on(*hall, "laser");
    ASSERT_EQ(hall->fleet().hold_machines().size(), 1U);
    DeviceRecord moved = hall->devices().find("laser").value();
    moved.station = "hall-copy";
    copy->devices().put(moved);
    EXPECT_TRUE(copy->fleet().hold_machines().empty());
    const std::int64_t fence = hall->fleet().machine_leases().front().fence;
    hall->fleet().let_go_of_machines();
    ASSERT_EQ(copy->fleet().hold_machines().size(), 1U);
    EXPECT_GT(copy->fleet().machine_leases().front().fence, fence);
}

TEST_P(FleetTest, ADutyIsOneNodesUntilItEnds) {
    const auto one = node("one", kLong);
    const auto two = node("two", kLong);
    const std::vector<std::string> duties{"housekeeping", "webhook http://a/"};
    EXPECT_EQ(one->fleet().hold_duties({"housekeeping"}).size(), 1U);
    EXPECT_EQ(two->fleet().hold_duties(duties), std::vector<std::string>{duties[1]});
    EXPECT_EQ(one->fleet().hold_duties({"housekeeping"}).size(), 1U);  // Prolonged.
    ASSERT_EQ(store->fleet().duty_leases().size(), 2U);
    EXPECT_EQ(store->fleet().duty_leases().front().device, "housekeeping");
    EXPECT_EQ(store->fleet().duty_leases().front().owner, "one");
    EXPECT_TRUE(store->fleet().machine_leases().empty());
    one->fleet().let_go_of_machines();
    EXPECT_EQ(two->fleet().hold_duties(duties), duties);
}

TEST_P(FleetTest, OfTwoNodesWithADutyOneHasIt) {
    const auto one = node("one", kLong);
    const auto two = node("two", kLong);
    Duties first(kLong);
    Duties second(kLong);
    first.renew(one->fleet());  // Nothing is wanted yet.
    EXPECT_FALSE(first.has("housekeeping"));
    first.want("housekeeping");
    second.want("housekeeping");
    first.renew(one->fleet());
    second.renew(two->fleet());
    EXPECT_TRUE(first.has("housekeeping"));
    EXPECT_FALSE(second.has("housekeeping"));
    EXPECT_TRUE(Duties(std::chrono::milliseconds(0)).has("housekeeping"));  // A daemon alone.
    Duties stale(kOver);
    stale.want("housekeeping");
    stale.renew(one->fleet());
    let_leases_end();
    EXPECT_FALSE(stale.has("housekeeping"));  // Its own clock tells it, without the database.
}

TEST_P(EngineTest, ASettingIsReplacedOnlyWhereItIsAsExpected) {
    EXPECT_FALSE(store->settings().replace("place", "1", "2"));
    store->settings().put("place", "1");
    EXPECT_TRUE(store->settings().replace("place", "1", "2"));
    EXPECT_FALSE(store->settings().replace("place", "1", "3"));
    EXPECT_EQ(store->settings().get("place"), "2");
}

TEST_P(FleetTest, WithoutItsLeaseAStationBeginsNothing) {
    const auto hall = node("hall", kOver);
    const CutRecord cut = armed_on(*hall, "laser");
    hall->fleet().hold_machines();
    let_leases_end();
    EXPECT_FALSE(hall->cuts().begin_sheet(cut));
    EXPECT_EQ(state_of(cut), CutState::Waiting);
    EXPECT_NE(store->cuts().find(cut.id)->reason.find("does not hold"), std::string::npos);
}

TEST_P(FleetTest, APausedStationBeginsNothingAndAPausedWorkerClaimsNothing) {
    const auto hall = node("hall", kLong);
    NodeRecord self;
    self.id = "hall";
    EXPECT_EQ(hall->fleet().beat(self), NodeMode::Active);
    const CutRecord cut = armed_on(*hall, "laser");
    hall->fleet().hold_machines();
    EXPECT_TRUE(store->fleet().set_mode("hall", NodeMode::Paused));
    EXPECT_EQ(hall->fleet().beat(self), NodeMode::Paused);
    EXPECT_FALSE(hall->cuts().begin_sheet(cut));
    add();
    EXPECT_FALSE(hall->jobs().claim());
    EXPECT_FALSE(store->fleet().set_mode("nobody", NodeMode::Paused));
}

TEST_P(FleetTest, ACutOfALostStationIsInterruptedAndItsOwnAgainWhenItIsBack) {
    const auto hall = node("hall", std::chrono::milliseconds(300));
    CutRecord cut = armed_on(*hall, "laser");
    hall->fleet().hold_machines();
    ASSERT_TRUE(hall->cuts().begin_sheet(cut));
    cut = hall->cuts().find(cut.id).value();
    EXPECT_EQ(cut.owner, "hall");
    while (store->fleet().machine_leases().front().left_ms > 0) {
        std::this_thread::yield();
    }
    let_leases_end();
    EXPECT_EQ(store->fleet().reap().cuts, 1);
    EXPECT_EQ(state_of(cut), CutState::Interrupted);
    EXPECT_FALSE(store->cuts().finish_sheet(cut, {}));  // Fenced off,
    EXPECT_FALSE(store->cuts().reclaim(cut));           // by anybody else,
    EXPECT_TRUE(hall->cuts().reclaim(cut));             // until its holder speaks.
    EXPECT_FALSE(hall->cuts().begin_sheet(cut));        // Never begun twice.
    EXPECT_TRUE(hall->cuts().finish_sheet(cut, {}));
    EXPECT_EQ(state_of(cut), CutState::Done);
}

TEST_P(FleetTest, ACutWhoseRestWasBegunStaysInterrupted) {
    const auto hall = node("hall", kOver);
    CutRecord cut = armed_on(*hall, "laser");
    const auto long_hall = node("hall", kLong);
    long_hall->fleet().hold_machines();
    ASSERT_TRUE(long_hall->cuts().begin_sheet(cut));
    long_hall->fleet().let_go_of_machines();
    let_leases_end();
    ASSERT_EQ(store->fleet().reap().cuts, 1);
    cut = store->cuts().find(cut.id).value();
    ASSERT_TRUE(store->cuts().add_rest(cut, sha256_of("rest")));
    cut.state = CutState::Cutting;
    EXPECT_FALSE(hall->cuts().reclaim(cut));
    EXPECT_EQ(state_of(cut), CutState::Interrupted);
}

std::set<std::string> names_in(const std::string& columns) {
    std::set<std::string> names;
    std::istringstream words(columns);
    for (std::string word; words >> word;) {
        names.insert(word.substr(0, word.find(':')));
    }
    return names;
}

TEST_P(EngineTest, ACopyKnowsEveryColumn) {
    for (const SqlTable& table : kSqlTables) {
        std::set<std::string> there;
        store->rows().read([&](SqlSession& session) {
            SqlStatement query(session, GetParam().columns_of);
            query.bind(1, table.name);
            while (query.step()) {
                there.insert(query.column(0).text());
            }
        });
        EXPECT_EQ(there, names_in(std::string(table.columns))) << table.name;
    }
}

TEST_P(EngineTest, AllGoesToADaemonAloneAndBackUnchanged) {
    const JobRecord job = add_ready(2);
    const JobRecord claimed = add("half computed");
    store->jobs().claim();
    const CutRecord cut = store->cuts().add(job.id, {{"sim", {}}}).front();
    store->presets().put({"p", R"({"a":"\"'?"})"});
    StockRecord left;
    left.id = "left";
    left.json = "{}";
    store->stock().put(left);
    store->accounts().put(User{"anna", Role::Admin, "hash", 5});
    const std::int64_t last = store->events().last_seq();

    const test::TempDir alone;
    auto sqlite = open_sqlite(alone.path(), alone.path() / "backups", [] {}).engine;
    const auto copied = copy_all_rows(store->rows(), sqlite->rows());
    EXPECT_EQ(copied.front().rows, 2);
    EXPECT_THROW(copy_all_rows(store->rows(), sqlite->rows()), CopyRefused);

    const test::TempDir back_folder;
    const auto back = GetParam().open(back_folder.path(), {});
    copy_all_rows(sqlite->rows(), back->rows());
    EXPECT_EQ(back->jobs().find(job.id)->sheets.size(), 2U);
    EXPECT_EQ(back->cuts().find(cut.id)->sheets, cut.sheets);
    EXPECT_EQ(back->presets().find("p")->json, R"({"a":"\"'?"})");
    EXPECT_FALSE(back->stock().find("left")->quantity);
    EXPECT_EQ(back->accounts().load().users.front().name, "anna");
    EXPECT_EQ(back->events().last_seq(), last);
    back->jobs().add({"next", {"n", 1, sha256_of("n")}, "{}"}, std::nullopt);
    EXPECT_EQ(back->events().last_seq(), last + 1);
    EXPECT_GT(back->jobs().list({}).front().ordinal, claimed.ordinal);
}

const EngineKind kSqlite{"sqlite",
                         [](const std::filesystem::path& folder, const NodeScope& scope) {
                             return open_sqlite(
                                        folder, folder / "backups", [] {}, scope)
                                 .engine;
                         },
                         "SELECT name FROM pragma_table_info(?)"};

// Each folder has tables of its own; a backup that lies in it is brought back.
std::unique_ptr<Engine> open_in_postgres(const std::filesystem::path& folder,
                                         const NodeScope& scope) {
    std::string space = "t" + sha256_of(folder.string()).substr(0, 16);
    test::PgServer& server = test::PgServer::shared();
    server.create_space(space);
    auto engine = open_postgres(server.uri(space), scope, {}).engine;
    if (std::filesystem::exists(folder / "leafcutter.db")) {
        const auto backup = open_sqlite(folder, folder / "backups", [] {}).engine;
        copy_all_rows(backup->rows(), engine->rows());
    }
    return engine;
}

const EngineKind kPostgres{"postgres", open_in_postgres,
                           "SELECT column_name::text FROM information_schema.columns WHERE "
                           "table_name = ? AND table_schema = current_schema()"};

std::vector<EngineKind> kinds() {
    std::vector<EngineKind> kinds{kSqlite};
    if (test::PgServer::is_installed()) {
        kinds.push_back(kPostgres);
    }
    return kinds;
}

std::string name_of(const ::testing::TestParamInfo<EngineKind>& each) {
    return each.param.name;
}

INSTANTIATE_TEST_SUITE_P(Engines, EngineTest, ::testing::ValuesIn(kinds()), name_of);
INSTANTIATE_TEST_SUITE_P(Engines, FleetTest, ::testing::ValuesIn(kinds()), name_of);

}  // namespace
}  // namespace leafcutter::server
