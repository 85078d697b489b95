// The state folder: locked, looked through, rescued; and its files.

#include <fstream>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "server/store/partial_blob.h"
#include "server/store/sql/events.h"
#include "server/store/sqlite/database.h"
#include "server/store/store.h"
#include "server/store/store_error.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::server {
namespace {

class StoreTest : public ::testing::Test {
protected:
    StoreTest() { open(); }

    void open() {
        store = std::make_unique<Store>(folder.path(), [] {});
    }

    std::string add(const std::string& name = "head.obj") {
        return store->jobs.add({name, {name, 3, sha256_of("abc")}, "{}"}, std::nullopt).job.id;
    }

    // The head of every page but the first is something else.
    void damage() {
        store.reset();
        std::fstream file(folder.path() / "leafcutter.db",
                          std::ios::binary | std::ios::in | std::ios::out);
        file.seekg(0, std::ios::end);
        const auto size = static_cast<long>(file.tellg());
        for (long at = 4096; at < size; at += 4096) {
            file.seekp(at);
            file << std::string(500, 'x');
        }
    }

    std::size_t put_aside() const {
        std::size_t found = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            found +=
                entry.path().filename().string().find(".corrupt-") != std::string::npos ? 1 : 0;
        }
        return found;
    }

    test::TempDir folder;
    std::unique_ptr<Store> store;
};

TEST_F(StoreTest, ASecondDaemonIsRefusedTheFolder) {
    EXPECT_THROW(Store(folder.path(), [] {}), StateDirUnusable);
}

TEST_F(StoreTest, ADamagedDatabaseIsPutAsideForTheNewestGoodBackup) {
    const std::string kept = add();
    store->back_up(5);
    const std::string lost = add();
    damage();
    // The newest one is no good.
    std::ofstream(folder.path() / "backups" / "9999-never.db") << std::string(8192, 'x');
    open();
    EXPECT_EQ(store->trouble(), "");
    EXPECT_NE(store->notice(), "");
    EXPECT_TRUE(store->jobs.find(kept));
    EXPECT_FALSE(store->jobs.find(lost));
    EXPECT_EQ(put_aside(), 1U);
    // Nothing of a time gone by begins by itself.
    EXPECT_TRUE(store->jobs.queue_pause());
    store.reset();
    open();
    EXPECT_EQ(store->notice(), "");
}

TEST_F(StoreTest, WithoutAnyBackupItOnlyReads) {
    add();
    damage();
    open();
    EXPECT_NE(store->trouble(), "");
    EXPECT_THROW(add(), StoreError);
    EXPECT_EQ(put_aside(), 0U);
    store.reset();
    open();  // However often it is started.
    EXPECT_NE(store->trouble(), "");
}

TEST_F(StoreTest, AFileThatIsNoDatabaseIsNotWrittenOver) {
    store.reset();
    const std::string text(20000, 'x');
    std::ofstream(folder.path() / "leafcutter.db", std::ios::binary) << text;
    open();
    EXPECT_NE(store->trouble(), "");
    try {
        store->jobs.list({});
        FAIL();
    } catch (const StoreError& error) {
        EXPECT_EQ(error.trouble(), StoreTrouble::Damaged);
    }
    store.reset();
    EXPECT_EQ(std::filesystem::file_size(folder.path() / "leafcutter.db"), text.size());
}

TEST_F(StoreTest, OnlyTheNewestBackupsAreKept) {
    for (int i = 0; i < 4; ++i) {
        store->back_up(2);
    }
    EXPECT_EQ(store->list_backups().size(), 2U);
}

TEST(Database, WorkThatThrowsLeavesNothingBehind) {
    const test::TempDir folder;
    Database database(folder.path() / "a.db", [] {});
    const auto write = [&database] {
        database.write([](SqlSession& connection) {
            append_event(connection, {});
            throw std::runtime_error("no");
        });
    };
    EXPECT_THROW(write(), std::runtime_error);
    EXPECT_EQ(SqlEventLog(database).last_seq(), 0);
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

TEST(PartialBlob, HasOneWriterAndTellsOthersSo) {
    const test::TempDir folder;
    const Blobs blobs(folder.path());
    const std::string name = sha256_of("abc");
    EXPECT_EQ(PartialBlob::bytes_here(blobs, name), 0);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / Blobs::kPartial));
    {
        PartialBlob part(blobs, name);
        part.write(std::string("ab"));
        EXPECT_TRUE(part.is_ours());
        EXPECT_FALSE(PartialBlob(blobs, name).is_ours());
        EXPECT_EQ(PartialBlob::bytes_here(blobs, name), std::nullopt);
    }
    EXPECT_EQ(PartialBlob::bytes_here(blobs, name), 2);
    PartialBlob part(blobs, name);
    part.write(std::string("c"));
    EXPECT_TRUE(part.finish());
    EXPECT_EQ(blobs.read(name), "abc");
}

// Whoever asks after a broken connection asks while its last bytes are still on their way.
TEST(PartialBlob, IsNotKeptFromItsWriterByWhoeverAsks) {
    const test::TempDir folder;
    const Blobs blobs(folder.path());
    const std::string name = sha256_of("abc");
    const std::jthread asker([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            PartialBlob::bytes_here(blobs, name);
        }
    });
    for (int i = 0; i < 2000; ++i) {
        ASSERT_TRUE(PartialBlob(blobs, name).is_ours());
    }
}

}  // namespace
}  // namespace leafcutter::server
