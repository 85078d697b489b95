#include <random>

#include <gmock/gmock.h>

#include "drivers/burn/journal_file.h"
#include "tests/drivers/resume_bench.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::drivers {
namespace {

constexpr double kMost = 1.0;  // Of a gap, and of a double burn.

TEST(BeamPath, MeasuresTheWayAndWhatIsBurntOfIt) {
    const BeamPath path("G21\nG90\nM4 S0\nG0 X10 S0\nG1 Y30 S500 F600\nG1 X10 Y30\nM5\nG0 X0 Y0\n");
    EXPECT_EQ(path.lines(), 8U);
    EXPECT_NEAR(path.length_mm(), 10 + 30 + std::hypot(10, 30), 1e-9);
    EXPECT_NEAR(path.burn_mm(), 30.0, 1e-9);
    EXPECT_NEAR(path.way_after(4), 10.0, 1e-9);
    EXPECT_NEAR(path.burnt_at(25.0), 15.0, 1e-9);
    EXPECT_NEAR(path.way_of_burn(15.0), 25.0, 1e-9);
    EXPECT_EQ(path.line_at(25.0), 4U);
    EXPECT_NEAR(path.point_at(25.0)[1], 15.0, 1e-9);
}

TEST(BeamPath, KnowsTheDialects) {
    const std::string shape = "G0 X10 S0\nG1 X30 S0.5 F600\n";
    EXPECT_NEAR(BeamPath("G21\nG90\nM4 I1 S0\n" + shape).burn_mm(), 20.0, 1e-9);
    EXPECT_NEAR(BeamPath("G21\nG90\n" + shape + "M5 S0\nG1 X0\n").burn_mm(), 20.0, 1e-9);
    EXPECT_NEAR(BeamPath("G20\nG91\nM3 S9\nG1 X1 F9\nG1 X1\n").burn_mm(), 50.8, 1e-9);
    EXPECT_THROW(BeamPath("G92 X0\nG1 X1 F9\n"), NotTraceable);
    EXPECT_THROW(BeamPath("G28 X0\n"), NotTraceable);
    EXPECT_THROW(BeamPath("G1 X1\n"), NotTraceable);  // No feed.
}

TEST(BeamTracker, NeverGoesBackAndTellsApartWhereThePathMeetsItself) {
    // A square of 10 mm, round three times.
    std::string text = "G21\nG90\nM4S9\nG0X0Y0\n";
    for (int i = 0; i < 3; ++i) {
        text += "G1X10F600\nG1Y10\nG1X0\nG1Y0\n";
    }
    const BeamPath path(text);
    BeamTracker tracker(path);
    tracker.sent(path.lines());
    double before = 0.0;
    for (double t = 0.2; t < 12.0; t += 0.2) {  // 10 mm/s
        ASSERT_TRUE(tracker.position(path.point_at(10.0 * t), t));
        EXPECT_NEAR(tracker.heard().likely_mm, 10.0 * t, 1e-6);
        EXPECT_GE(tracker.heard().least_mm, before);
        before = tracker.heard().least_mm;
    }
    EXPECT_FALSE(tracker.position({5.0, 5.0}, 12.1));
}

TEST(BeamTracker, LooksNoFurtherThanWhatWasSent) {
    const BeamPath path("G21\nG90\nM4S9\nG1X10F600\nG1Y10\nG1X0\nG1Y0\n");
    BeamTracker tracker(path);
    tracker.sent(4);
    EXPECT_FALSE(tracker.position({0.0, 5.0}, 100.0));
    tracker.sent(7);
    EXPECT_TRUE(tracker.position({0.0, 5.0}, 100.0));
    EXPECT_NEAR(tracker.heard().likely_mm, 35.0, 1e-9);
}

TEST(Journal, EndsAtTheFirstDamagedRecord) {
    JournalHeader header;
    header.program = "abc";
    header.origin_mm = {-400.0, -300.5};
    std::string text = write_record(header);
    text += write_record({.kind = JournalRecord::Kind::May, .lines = 7});
    const std::string whole = text;
    text += write_record({.kind = JournalRecord::Kind::Position, .t_s = 1.25, .at_mm = {1.5, -2}});
    const Journal journal = read_journal(text).value();
    EXPECT_EQ(journal.header.program, "abc");
    EXPECT_EQ(journal.header.origin_mm[1], -300.5);
    ASSERT_EQ(journal.records.size(), 2U);
    EXPECT_EQ(journal.records[1].at_mm[1], -2.0);
    for (std::size_t cut = whole.size(); cut < text.size(); ++cut) {
        EXPECT_EQ(read_journal(text.substr(0, cut))->records.size(), 1U) << cut;
    }
    for (std::size_t at = 0; at < text.size(); ++at) {
        std::string bad = text;
        bad[at] = static_cast<char>(bad[at] ^ 2);
        const auto read = read_journal(bad);
        EXPECT_LE(read ? read->records.size() : 0, 1U) << at;
    }
}

TEST(JournalFile, LetsALineGoOnlyOnceItsRecordIsOnDisk) {
    const test::TempDir folder;
    const std::filesystem::path path = folder.path() / "cut.journal";
    {
        JournalFile file(path, {.program = "abc"});
        EXPECT_EQ(file.lines_on_disk(), 0U);
        for (std::size_t lines = 1; lines <= 200; ++lines) {
            file.note({.kind = JournalRecord::Kind::May, .lines = lines});
            while (file.lines_on_disk() < lines && !file.failed()) {
                std::this_thread::yield();
            }
            const auto journal = load_journal(path);
            ASSERT_TRUE(journal);
            ASSERT_EQ(journal->records.size(), lines);
        }
        EXPECT_FALSE(file.failed());
    }
    append_record(path, {.kind = JournalRecord::Kind::Found, .at_mm = {3.0, 4.0}});
    EXPECT_EQ(load_journal(path)->records.back().at_mm[1], 4.0);
    EXPECT_FALSE(load_journal(folder.path() / "other"));
    EXPECT_THROW(JournalFile(folder.path() / "no" / "such", {}), std::system_error);
}

TEST(Remainder, OfNothingBurntIsTheWholeAndOfAllIsNone) {
    const std::string job = mixed_job(900);
    const BeamPath path(job);
    EXPECT_NEAR(BeamPath(remainder_program(job, 0.0)).burn_mm(), path.burn_mm(), 1e-3);
    EXPECT_TRUE(remainder_program(job, path.burn_mm()).empty());
}

TEST(Remainder, BurnsTheRestWithItsFeedAndPowerWhereverItBegins) {
    for (const std::string& job :
         {mixed_job(900),
          std::string("G20\nG91\nM4S100\nG1X1F20\nX1S300\nG2X1Y1I1J0\nX-1Y-1I0J-1\n"
                      "G1X-1F9\nM5\n"),
          std::string(
              "G21\nG90\nM4 I1 S0\nG0 X5 S0\nG1 X50 S20 F600\nG0 X0 S0\nG1 Y9 S10\nM5 S0\n"),
          std::string("G21\nG90\nG0 X5 S0\nG1 X50 S0.2 F600\nG0 X0 S0\nG1 Y9 S0.1\nM5 S0\n")}) {
        const BeamPath path(job);
        std::mt19937 random(3);
        for (int i = 0; i < 60; ++i) {
            const double burnt =
                path.burn_mm() * std::uniform_real_distribution<>(0.0, 0.999)(random);
            RemainderOptions options;
            options.overlap_mm = 0.0;
            const BeamPath rest(remainder_program(job, burnt, options));
            ASSERT_NEAR(rest.burn_mm(), path.burn_mm() - burnt, 0.01) << burnt;
            for (double along = 0.05; along < rest.burn_mm(); along += 1.7) {
                const PathPiece& a = path.pieces()[path.piece_at(path.way_of_burn(burnt + along))];
                const PathPiece& b = rest.pieces()[rest.piece_at(rest.way_of_burn(along))];
                const Point at = rest.point_at(rest.way_of_burn(along));
                const Point as = path.point_at(path.way_of_burn(burnt + along));
                ASSERT_LT(std::hypot(at[0] - as[0], at[1] - as[1]), 0.02) << burnt << " " << along;
                ASSERT_EQ(a.power_s, b.power_s);
                ASSERT_EQ(a.feed_mm_per_min, b.feed_mm_per_min);
            }
        }
    }
}

// A wave in lines of half a millimetre.
std::string fine_job(double feed) {
    std::string text = fmt::format("G21\nG90\nM4 S0\nG0 X20 Y50 S0\nG1 S400 F{}\n", feed);
    for (int i = 1; i <= 700; ++i) {
        text +=
            fmt::format("G1 X{:.3f} Y{:.3f}\n", 20.0 + 0.4 * i, 50.0 + 20.0 * std::sin(0.02 * i));
    }
    return text + "M5 S0\nG0 X0 Y0\n";
}

double total_s(const std::string& job) {
    ResumeBench whole(job);
    EXPECT_TRUE(whole.bench().finish_job(3000.0));
    EXPECT_NEAR(whole.burnt(), whole.path().burn_mm(), 0.05);
    return whole.bench().now_s();
}

TEST(Resume, FinishesWhatAHostThatDiedLeftInAMachineThatLived) {
    const std::string job = mixed_job(900);
    const double seconds = total_s(job);
    std::mt19937 random(1);
    for (int i = 0; i < 40; ++i) {
        ResumeBench cut(job);
        cut.run_for(std::uniform_real_distribution<>(0.0, seconds)(random));
        cut.drain();
        // Without a word of the machine: it was reset when its port was opened.
        EXPECT_NEAR(cut.knowledge().likely_mm, cut.burnt(), kMost);
        EXPECT_LE(cut.knowledge().least_mm, cut.burnt() + 0.05);
        EXPECT_GE(cut.knowledge().most_mm, cut.burnt() - 0.05);
        cut.find();
        const BeamKnowledge known = cut.knowledge();
        EXPECT_TRUE(known.certain());
        EXPECT_TRUE(known.position_kept);
        EXPECT_NEAR(known.best_mm(), cut.burnt(), 0.1);
        EXPECT_NEAR(cut.finish(known.best_mm()), 0.0, kMost) << i;
    }
}

TEST(Resume, FinishesWhatWasCancelledAndWhatWasStopped) {
    const std::string job = mixed_job(900);
    const double seconds = total_s(job);
    std::mt19937 random(2);
    for (int i = 0; i < 40; ++i) {
        ResumeBench cut(job);
        cut.run_for(std::uniform_real_distribution<>(0.5, seconds - 2.0)(random));
        const bool stop = i % 2 == 0;
        stop ? cut.session().stop() : cut.session().cancel();
        ASSERT_TRUE(cut.bench().finish_job(5.0));
        cut.settle();
        const BeamKnowledge known = cut.knowledge();
        EXPECT_TRUE(known.certain());
        EXPECT_NEAR(known.best_mm(), cut.burnt(), 0.1);
        EXPECT_EQ(known.position_kept, !stop);
        EXPECT_NEAR(cut.finish(known.best_mm()), 0.0, kMost) << i;
    }
}

// Errors of where the beam stopped when the machine's power went.
struct PowerCuts {
    double worst_mm = 0.0;
    double finished_worst_mm = 0.0;
};

struct PowerCutCase {
    std::string job;
    std::chrono::milliseconds poll_interval{200};
};

PowerCuts power_cuts(const PowerCutCase& given, unsigned seed) {
    const double seconds = total_s(given.job);
    std::mt19937 random(seed);
    PowerCuts result;
    for (int i = 0; i < 40; ++i) {
        GrblOptions options;
        options.poll_interval = given.poll_interval;
        ResumeBench cut(given.job, {}, options);
        cut.run_for(std::uniform_real_distribution<>(0.5, seconds - 2.0)(random));
        cut.lose_power();
        const BeamKnowledge known = cut.knowledge();
        EXPECT_LE(known.least_mm, cut.burnt() + 0.5) << i;
        EXPECT_GE(known.most_mm, cut.burnt() - 0.5) << i;
        result.worst_mm = std::max(result.worst_mm, std::abs(known.likely_mm - cut.burnt()));
        result.finished_worst_mm =
            std::max(result.finished_worst_mm, std::abs(cut.finish(known.likely_mm)));
    }
    return result;
}

void expect_within_a_millimetre(const PowerCutCase& given, const std::string& what) {
    const PowerCuts cuts = power_cuts(given, 4);
    EXPECT_LE(cuts.worst_mm, kMost) << what;
    EXPECT_LE(cuts.finished_worst_mm, kMost + 0.1) << what;
    fmt::print("power cuts, {}: off by {:.3f} mm at most\n", what, cuts.worst_mm);
}

TEST(Resume, KnowsWithinAMillimetreWhereAPowerCutStoppedTheBeam) {
    for (const double feed : {300.0, 550.0}) {
        expect_within_a_millimetre({.job = mixed_job(feed)}, fmt::format("{} mm/min", feed));
    }
}

// Half of what it burns between two words of the machine is what it may be off: a faster beam is
// known as well if it is asked more often, or if its lines are short, whose answers come between.
TEST(Resume, KnowsAFasterBeamThatItHearsOfMoreOften) {
    expect_within_a_millimetre(
        {.job = mixed_job(1000), .poll_interval = std::chrono::milliseconds(100)},
        "1000 mm/min asked at 10 Hz");
    expect_within_a_millimetre({.job = fine_job(550)}, "550 mm/min in short lines");
    expect_within_a_millimetre(
        {.job = fine_job(1000), .poll_interval = std::chrono::milliseconds(100)},
        "1000 mm/min in short lines");
}

}  // namespace
}  // namespace leafcutter::drivers
