#include <atomic>
#include <fstream>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "server/store/schema.h"
#include "server/store/store.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::server {
namespace {

class StoreTest : public ::testing::Test {
protected:
    StoreTest() { open(); }

    void open() {
        store = std::make_unique<Store>(folder.path(), [] {});
    }
    void reopen() {
        store.reset();
        open();
    }

    JobRecord add(const std::string& name = "head.obj") {
        return store->jobs.add({name, {name, 3, sha256_of("abc")}, "{}"}, std::nullopt).job;
    }

    JobRecord add_ready(int sheets) {
        const JobRecord job = add();
        store->jobs.claim();
        ComputedJob result;
        result.summary_json = "{}";
        for (int number = 1; number <= sheets; ++number) {
            const std::string program = sha256_of(std::to_string(number));
            result.sheets.push_back({number, "paper", program, 1.0, false});
        }
        EXPECT_TRUE(store->jobs.finish(job.id, result));
        return store->jobs.find(job.id).value();
    }

    CutRecord armed(const CutRecord& cut) {
        EXPECT_TRUE(store->cuts.arm(cut));
        return store->cuts.find(cut.id).value();
    }

    CutState state_of(const CutRecord& cut) { return store->cuts.find(cut.id)->state; }

    test::TempDir folder;
    std::unique_ptr<Store> store;
};

TEST_F(StoreTest, ASecondDaemonIsRefusedTheFolder) {
    EXPECT_THROW(Store(folder.path(), [] {}), StateDirUnusable);
}

TEST_F(StoreTest, RefusesADamagedDatabase) {
    add();
    store.reset();
    std::ofstream(folder.path() / "leafcutter.db", std::ios::binary) << std::string(8192, 'x');
    EXPECT_THROW(open(), DatabaseUnusable);
}

TEST_F(StoreTest, JobsAreClaimedOldestFirstAndOnce) {
    const JobRecord first = add();
    const JobRecord second = add();
    EXPECT_EQ(store->jobs.claim()->id, first.id);
    EXPECT_EQ(store->jobs.claim()->id, second.id);
    EXPECT_FALSE(store->jobs.claim());
}

TEST_F(StoreTest, ManyClaimersNeverShareAJob) {
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
                while (const auto job = store->jobs.claim()) {
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

TEST_F(StoreTest, TheSameKeyGivesTheSameJob) {
    const NewJob job{"n", {"n.obj", 3, sha256_of("abc")}, "{}"};
    const AddedJob first = store->jobs.add(job, IdempotencyKey{"k", "hash"});
    const AddedJob again = store->jobs.add(job, IdempotencyKey{"k", "hash"});
    EXPECT_FALSE(first.replayed);
    EXPECT_TRUE(again.replayed);
    EXPECT_EQ(first.job.id, again.job.id);
    EXPECT_THROW(store->jobs.add(job, IdempotencyKey{"k", "other"}), KeyReused);
    EXPECT_EQ(store->jobs.list({}).size(), 1U);
}

TEST_F(StoreTest, AJobCutShortGoesBackToTheQueueAndFailsInTheEnd) {
    const JobRecord job = add();
    for (int attempt = 1; attempt <= JobStore::kMostAttempts; ++attempt) {
        ASSERT_EQ(store->jobs.claim()->attempt, attempt);
        reopen();
    }
    const JobRecord last = store->jobs.find(job.id).value();
    EXPECT_EQ(last.state, JobState::Failed);
    EXPECT_EQ(last.failure->code, "poison-job");
}

TEST_F(StoreTest, AResultForACancelledJobIsDropped) {
    const JobRecord job = add();
    store->jobs.claim();
    EXPECT_TRUE(store->jobs.cancel(job.id));
    EXPECT_FALSE(store->jobs.finish(job.id, {}));
    EXPECT_EQ(store->jobs.find(job.id)->state, JobState::Cancelled);
}

TEST_F(StoreTest, EventNumbersHaveNoGapAndEveryChangeHasOne) {
    const JobRecord job = add();
    store->jobs.claim();
    store->jobs.fail(job.id, {"bad-file", "x", "y"});
    store->jobs.remove(job.id);
    const auto events = store->events.after(0, 100);
    ASSERT_EQ(events.size(), 4U);
    for (std::size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(events[i].seq, static_cast<std::int64_t>(i) + 1);
    }
    EXPECT_EQ(events[2].note, "computing -> failed");
}

TEST_F(StoreTest, WorkThatThrowsLeavesNothingBehind) {
    const auto write = [this] {
        store->database.write([](SQLite::Database& database) {
            EventRecord event;
            append_event(database, event);
            throw std::runtime_error("no");
        });
    };
    EXPECT_THROW(write(), std::runtime_error);
    EXPECT_EQ(store->events.last_seq(), 0);
}

TEST_F(StoreTest, AJobIsDoneWhenItsLastSheetIsCut) {
    const JobRecord job = add_ready(2);
    CutRecord cut = store->cuts.add(job.id, "sim", {});
    EXPECT_EQ(cut.sheets, (std::vector<int>{1, 2}));
    cut = armed(cut);
    ASSERT_TRUE(store->cuts.begin_sheet(cut));
    ASSERT_TRUE(store->cuts.finish_sheet(cut, {}));
    cut = store->cuts.find(cut.id).value();
    EXPECT_EQ(cut.state, CutState::AwaitingSheet);
    EXPECT_EQ(cut.sheet(), 2);
    EXPECT_EQ(cut.program_sha256, sha256_of("2"));
    EXPECT_EQ(store->jobs.find(job.id)->state, JobState::Ready);
    cut = armed(cut);
    ASSERT_TRUE(store->cuts.begin_sheet(cut));
    ASSERT_TRUE(store->cuts.finish_sheet(cut, {}));
    EXPECT_EQ(state_of(cut), CutState::Done);
    EXPECT_EQ(store->jobs.find(job.id)->state, JobState::Done);
}

TEST_F(StoreTest, OnlyOneCutOccupiesADevice) {
    const JobRecord job = add_ready(1);
    const CutRecord first = store->cuts.add(job.id, "sim", {});
    const CutRecord second = store->cuts.add(job.id, "sim", {});
    armed(first);
    EXPECT_FALSE(store->cuts.arm(second));
    EXPECT_EQ(state_of(second), CutState::Waiting);
}

TEST_F(StoreTest, ASheetBeginsOncePerArming) {
    const CutRecord cut = armed(store->cuts.add(add_ready(1).id, "sim", {}));
    EXPECT_TRUE(store->cuts.begin_sheet(cut));
    EXPECT_FALSE(store->cuts.begin_sheet(cut));
}

TEST_F(StoreTest, ACutInMidBeamIsInterruptedAndAnArmedOneDisarmedByARestart) {
    const JobRecord job = add_ready(1);
    const CutRecord burning = armed(store->cuts.add(job.id, "one", {}));
    store->cuts.begin_sheet(burning);
    store->cuts.record_progress(burning.id, {100, 40, 30});
    const CutRecord waiting = armed(store->cuts.add(job.id, "two", {}));
    reopen();
    EXPECT_EQ(state_of(burning), CutState::Interrupted);
    EXPECT_EQ(state_of(waiting), CutState::Waiting);
    EXPECT_EQ(store->interrupted_devices, (std::vector<std::string>{"one"}));
    EXPECT_NE(store->cuts.find(burning.id)->reason.find("30 of 100"), std::string::npos);
}

TEST_F(StoreTest, AJobWithACutUnderWayStays) {
    const JobRecord job = add_ready(1);
    const CutRecord cut = store->cuts.add(job.id, "sim", {});
    EXPECT_EQ(store->jobs.remove(job.id), Removal::StillInUse);
    store->cuts.move(cut.id, CutState::Waiting, CutState::Aborted);
    EXPECT_EQ(store->jobs.remove(job.id), Removal::Removed);
    EXPECT_EQ(store->jobs.remove(job.id), Removal::NotThere);
}

TEST_F(StoreTest, RefusesSheetsThatAreNotThere) {
    EXPECT_THROW(store->cuts.add(add_ready(1).id, "sim", {2}), NotCuttable);
    EXPECT_THROW(store->cuts.add(add().id, "sim", {}), NotCuttable);
}

TEST_F(StoreTest, AMoveThatTheTableForbidsIsAMistakeOfOurs) {
    const CutRecord cut = store->cuts.add(add_ready(1).id, "sim", {});
    EXPECT_THROW(store->cuts.move(cut.id, CutState::Waiting, CutState::Cutting), std::logic_error);
}

TEST_F(StoreTest, AFreshFolderHasASimulatedMachine) {
    const auto device = store->devices.find("sim");
    ASSERT_TRUE(device);
    EXPECT_EQ(device->uri, "sim:grbl");
    EXPECT_FALSE(device->auto_start);
}

TEST(Blobs, KeepWhatIsFinishedAndNothingElse) {
    const test::TempDir folder;
    const Blobs blobs(folder.path());
    blobs.begin()->write(std::string("dropped"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "incoming"));
    const BlobId blob = blobs.put("abc");
    EXPECT_EQ(blob.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(blobs.read(blob.sha256), "abc");
    EXPECT_FALSE(blobs.size(sha256_of("other")));
    EXPECT_THROW(blobs.open("../../etc/passwd"), std::out_of_range);
}

TEST(Blobs, SweepTakesOnlyOldOnesThatNobodyNames) {
    const test::TempDir folder;
    const Blobs blobs(folder.path());
    const std::string named = blobs.put("named").sha256;
    const std::string old = blobs.put("old").sha256;
    const std::string young = blobs.put("young").sha256;
    for (const std::string& sha256 : {named, old}) {
        std::filesystem::last_write_time(
            folder.path() / sha256.substr(0, 2) / sha256,
            std::filesystem::file_time_type::clock::now() - std::chrono::hours(48));
    }
    blobs.sweep([&named](const std::string& sha256) { return sha256 == named; });
    EXPECT_TRUE(blobs.size(named));
    EXPECT_FALSE(blobs.size(old));
    EXPECT_TRUE(blobs.size(young));
}

}  // namespace
}  // namespace leafcutter::server
