// Every fault of a link and of a machine, at every so many lines of a real job, met by doing
// nothing, by a hold and a resume, and by a cancel: held against what may be seen from outside.

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "drivers/transport.h"
#include "tests/drivers/resume_bench.h"
#include "tests/support/woven_program.h"

namespace leafcutter::drivers {
namespace {

constexpr std::size_t kEvery = 10;   // Lines.
constexpr double kMost = 1.0;        // mm of a seam burnt twice or left out.
constexpr double kDarkWithin = 0.1;  // Seconds.
constexpr double kStep = 0.005;      // Of the bench.

enum class Act { None, HoldAndResume, Cancel };

constexpr std::array<std::string_view, 12> kFaults{
    "drop-byte", "double-byte", "corrupt-byte", "drop-ok", "double-ok", "corrupt-ok",
    "delay",     "stall",       "alarm",        "reset",   "power",     "unplug"};

bool garbles(std::string_view fault) {
    return fault.find("-byte") != std::string_view::npos;
}

std::string_view name_of(Act act) {
    return act == Act::None ? "-" : act == Act::Cancel ? "cancel" : "hold, resume";
}

// What became of the runs of one fault and act.
struct Tally {
    std::map<std::string, int> ends;
    double worst_dark_s = 0.0;    // From a hold, cancel, alarm, reset or power cut to a dark beam.
    double worst_seam_mm = 0.0;   // Gap or double burn after the rest was done.
    double worst_off_mm = 0.0;    // Of the beam from the path.
    int unsure = 0;               // The operator had to say where the beam stopped, shown a guess.
    double worst_guess_mm = 0.0;  // Of that.
};

class FaultyCut {
public:
    FaultyCut(
        const std::string& program, std::string_view fault, std::size_t line, Act act, Tally& tally)
        : cut_(program, parse_faults(fmt::format("{}:{}", fault, line))),
          fault_(fault),
          line_(line),
          act_(act),
          tally_(tally) {}

    void go() {
        until([&] { return reached(); });
        if (running()) {
            meet();
        }
        EXPECT_TRUE(until([&] { return !running(); })) << "never ends";
        after();
    }

private:
    bool running() { return !lost_ && cut_.session().progress().outcome == JobOutcome::Running; }
    bool reached() { return cut_.machine().gcode_lines() >= line_ + 3 || !running(); }

    // The daemon's own rule, and the link's loss as a transport would tell it.
    void step() {
        if (lost_) {
            cut_.machine().advance(kStep);
            return;
        }
        try {
            cut_.bench().step(kStep);
            if (cut_.bench().link().unplugged()) {
                lose("unplugged");
            } else if (cut_.follower().astray() >= 3 && !astray_) {
                astray_ = true;
                cut_.session().cancel();
            }
        } catch (const LinkLost& lost) {
            cut_.bench().link().feed(cut_.session().last_words());
            lose(lost.what());
        }
    }

    void lose(const std::string& why) {
        lost_ = true;
        cut_.session().lose_link(why);
        cut_.follower().end(cut_.session().progress(), cut_.session().status());
    }

    template <typename Done>
    bool until(Done done) {
        constexpr double kPatience = 900.0;
        const double end = cut_.machine().now_s() + kPatience;
        while (!done()) {
            if (cut_.machine().now_s() > end) {
                return false;
            }
            step();
        }
        return true;
    }

    // Watches for half a second: after that long the beam was lit for the last time.
    void expect_dark_soon(std::string_view what) {
        if (!cut_.bench().link().hears()) {
            return;
        }
        constexpr double kWatch = 0.5;
        const double since = cut_.machine().now_s();
        double lit_until = since;
        until([&] {
            const double now = cut_.machine().now_s();
            lit_until = cut_.machine().beam_power() > 0.0 ? now : lit_until;
            return now - since >= kWatch;
        });
        if (!cut_.bench().link().hears()) {
            return;
        }
        const double took = lit_until - since;
        tally_.worst_dark_s = std::max(tally_.worst_dark_s, took);
        EXPECT_LE(took, kDarkWithin + kStep) << what;
    }

    void meet() {
        if (act_ == Act::Cancel) {
            cut_.session().cancel();
            expect_dark_soon("cancel");
        } else if (act_ == Act::HoldAndResume) {
            cut_.session().hold();
            expect_dark_soon("hold");
            // Dark it may have been on its way to the next burn, still slowing down.
            Axes before{};
            until([&] {
                const bool stands = cut_.machine().position_mm() == before;
                before = cut_.machine().position_mm();
                return stands || !running();
            });
            const double burnt = cut_.burnt();
            const double end = cut_.machine().now_s() + 0.5;
            until([&] { return cut_.machine().now_s() >= end || !running(); });
            if (!cut_.bench().link().hears()) {
                return;
            }
            EXPECT_NEAR(cut_.burnt(), burnt, 0.01) << "burns while it holds";
            cut_.session().resume();
        }
    }

    void after() {
        const JobOutcome outcome = cut_.session().progress().outcome;
        ++tally_.ends[outcome == JobOutcome::Done       ? "done"
                      : outcome == JobOutcome::Aborted  ? "cancelled"
                      : outcome == JobOutcome::LinkLost ? "link lost"
                                                        : "failed"];
        if (!lost_) {
            if (outcome != JobOutcome::Done) {
                expect_dark_soon("its end");
                cut_.settle();
            }
        } else {
            cut_.drain();  // A controller without its host does what it was sent: no more, and
                           // dark.
        }
        EXPECT_EQ(cut_.machine().beam_power(), 0.0);
        const double burnt = cut_.burnt();
        for (int i = 0; i < 400; ++i) {
            step();
        }
        EXPECT_EQ(cut_.burnt(), burnt) << "burns after its end";
        EXPECT_EQ(cut_.machine().beam_power(), 0.0);
        check(outcome);
    }

    void check(JobOutcome outcome) {
        const auto& pieces = cut_.machine().beam_log().pieces();
        const double off = worst_deviation(cut_.path(), pieces);
        tally_.worst_off_mm = std::max(tally_.worst_off_mm, off);
        if (garbles(fault_)) {
            return;  // Grbl has no checksum: what was garbled into another line, is burnt.
        }
        EXPECT_LE(off, 0.02);
        EXPECT_LE(cut_.burnt(), cut_.path().burn_mm() + 0.1) << "burnt twice";
        if (outcome == JobOutcome::Done) {
            EXPECT_NEAR(cut_.burnt(), cut_.path().burn_mm(), 0.1);
            return;
        }
        EXPECT_FALSE(cut_.session().progress().reason.empty());
        if (outcome == JobOutcome::LinkLost && fault_ != "power") {
            cut_.find();  // Reset by the operator: the controller says where it stands.
        }
        const BeamKnowledge known = cut_.knowledge();
        EXPECT_LE(known.least_mm, cut_.burnt() + 0.5);
        EXPECT_GE(known.most_mm, cut_.burnt() - 0.5);
        if (!known.certain()) {
            ++tally_.unsure;
            tally_.worst_guess_mm =
                std::max(tally_.worst_guess_mm, std::abs(known.likely_mm - cut_.burnt()));
        }
        const double said = known.certain() ? known.best_mm() : cut_.burnt();
        const double seam = std::abs(cut_.finish(said));
        tally_.worst_seam_mm = std::max(tally_.worst_seam_mm, seam);
        EXPECT_LE(seam, kMost + 0.02);
    }

    ResumeBench cut_;
    std::string_view fault_;
    std::size_t line_;
    Act act_;
    Tally& tally_;
    bool lost_ = false;
    bool astray_ = false;
};

std::size_t threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

void print(std::string_view fault, Act act, const Tally& tally) {
    std::string ends;
    for (const auto& [name, count] : tally.ends) {
        ends += fmt::format("{}{} {}", ends.empty() ? "" : ", ", count, name);
    }
    fmt::print("| {:12} | {:12} | {:34} | {:5.0f} | {:6.3f} | {:6.3f} | {:6} | {:8.3f} |\n", fault,
               name_of(act), ends, 1000.0 * tally.worst_dark_s, tally.worst_seam_mm,
               tally.worst_off_mm, tally.unsure, tally.worst_guess_mm);
}

TEST(FaultMatrix, BurnsNothingTwiceNothingInVainAndNothingAfterItsEnd) {
    const std::string program = test::woven_program(fab::Dialect::Grbl, 5);
    const BeamPath path(program);
    ASSERT_GT(path.lines(), 300U);
    const std::size_t before = threads();
    fmt::print("{} lines, {:.0f} mm to burn\n", path.lines(), path.burn_mm());
    fmt::print(
        "| fault        | act          | ends                               | dark ms | seam "
        "mm | off mm | unsure | guess mm |\n");
    for (const std::string_view fault : kFaults) {
        for (const Act act : {Act::None, Act::HoldAndResume, Act::Cancel}) {
            Tally tally;
            for (std::size_t line = 10; line < path.lines(); line += kEvery) {
                SCOPED_TRACE(fmt::format("{}:{} {}", fault, line, name_of(act)));
                FaultyCut(program, fault, line, act, tally).go();
                if (testing::Test::HasFailure()) {
                    return;
                }
            }
            print(fault, act, tally);
        }
    }
    EXPECT_EQ(threads(), before);
}

}  // namespace
}  // namespace leafcutter::drivers
