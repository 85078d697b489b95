// Random small jobs on random sheets, remnants with holes, defects and zones: every layout judged
// by the oracle. LEAFCUTTER_FUZZ_JOBS says how many (default 2000), LEAFCUTTER_FUZZ_SEED from
// which.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fab/nest/check.h"
#include "fab/nest/nest.h"
#include "fab/nest/random.h"
#include "geometry/error.h"
#include "tests/support/layout_oracle.h"

namespace leafcutter::fab {
namespace {

constexpr double kToleranceMm = 5e-6;  // Files and proofs drop what is smaller.

Ring star(Random& random, double size) {
    const std::size_t corners = 3 + random.below(8);
    Ring ring;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi *
                             (static_cast<double>(i) + 0.8 * random.unit()) /
                             static_cast<double>(corners);
        const double radius = size * random.between(0.3, 1.0);
        ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return ring;
}

Ring rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& size) {
    return {low, {low.x() + size.x(), low.y()}, low + size, {low.x(), low.y() + size.y()}};
}

Ring band(Random& random) {
    constexpr int kCells = 8;
    const double length = random.between(20.0, 110.0);
    const double width = random.between(2.0, 9.0);
    const double turn = random.between(-2.0, 2.0);
    Ring ring;
    Ring back;
    Eigen::Vector2d at(random.between(-40.0, 40.0), 0.0);
    double heading = random.between(0.0, 6.0);
    for (int i = 0; i <= kCells; ++i) {
        const Eigen::Vector2d side(-std::sin(heading), std::cos(heading));
        ring.push_back(at - side * width / 2.0);
        back.push_back(at + side * width / 2.0);
        at += length / kCells * Eigen::Vector2d(std::cos(heading), std::sin(heading));
        heading += turn / kCells;
    }
    ring.insert(ring.end(), back.rbegin(), back.rend());
    return ring;
}

Rotations random_rotations(Random& random) {
    switch (random.below(6)) {
        case 0:
            return {0.0};
        case 1:
            return {0.0, 180.0};
        case 2:
            return {0.0, 90.0, 180.0, 270.0};
        case 3:
            return Rotations(std::vector<AngleInterval>{{-5.0, 5.0}, {175.0, 185.0}});
        case 4:
            return Rotations(std::vector<AngleInterval>{{30.0, 100.0}, {-90.0, -90.0}});
        default:
            return {};
    }
}

struct FuzzJob {
    std::vector<Piece> pieces;
    std::vector<StockItem> stock;
    NestOptions options;
};

void add_zones(Random& random, StockItem& sheet) {
    const std::size_t zones = random.below(4);
    for (std::size_t i = 0; i < zones; ++i) {
        Ring ring = star(random, random.between(1.0, 14.0));
        const Eigen::Vector2d at(random.between(0.0, sheet.size.width_mm),
                                 random.between(0.0, sheet.size.height_mm));
        for (Eigen::Vector2d& point : ring) {
            point += at;
        }
        constexpr ZoneKind kKinds[] = {ZoneKind::Hole, ZoneKind::Defect, ZoneKind::KeepOut};
        sheet.zones.push_back({kKinds[random.below(3)], std::move(ring)});
    }
}

StockItem random_sheet(Random& random, int number) {
    StockItem sheet;
    sheet.id = fmt::format("S{}", number);
    sheet.size = {random.between(50.0, 160.0), random.between(50.0, 160.0)};
    if (random.below(3) == 0) {
        sheet.outline = star(random, random.between(50.0, 110.0));
        move_to_origin(sheet);
    }
    if (random.below(2) == 0) {
        add_zones(random, sheet);
    }
    sheet.quantity = 1 + static_cast<int>(random.below(3));
    sheet.cost = static_cast<double>(random.below(4));
    if (random.below(4) == 0) {
        sheet.quantity.reset();
        sheet.cost += 1.0;
    }
    return sheet;
}

FuzzJob random_job(std::uint64_t seed) {
    Random random(seed * 77'003);
    FuzzJob job;
    const std::size_t pieces = 1 + random.below(7);
    for (std::size_t i = 0; i < pieces; ++i) {
        Piece piece;
        piece.id = fmt::format("W{}.1", i + 1);
        const std::size_t kind = random.below(3);
        piece.outline =
            kind == 0 ? band(random)
            : kind == 1
                ? star(random, random.between(5.0, 30.0))
                : rectangle({0.0, 0.0}, {random.between(3.0, 60.0), random.between(3.0, 30.0)});
        if (random.below(3) == 0) {
            job.options.piece_turns[piece.id] = random_rotations(random);
        }
        job.pieces.push_back(std::move(piece));
    }
    const std::size_t sheets = 1 + random.below(3);
    for (std::size_t i = 0; i < sheets; ++i) {
        job.stock.push_back(random_sheet(random, static_cast<int>(i)));
    }
    job.options.turns = random_rotations(random);
    job.options.spacing_mm = random.below(4) == 0 ? 0.0 : random.between(0.0, 3.0);
    job.options.kerf_mm = random.below(4) == 0 ? 0.0 : random.between(0.0, 0.5);
    job.options.margin_mm = random.below(4) == 0 ? 0.0 : random.between(0.0, 6.0);
    job.options.max_evaluations = 400 + static_cast<std::int64_t>(random.below(2000));
    job.options.seed = static_cast<std::uint32_t>(seed);
    return job;
}

std::vector<const Piece*> pointers(const std::vector<Piece>& pieces) {
    std::vector<const Piece*> out;
    for (const Piece& piece : pieces) {
        out.push_back(&piece);
    }
    return out;
}

bool angle_is_allowed(const Rotations& allowed, double angle_deg) {
    for (const AngleInterval& each : allowed.intervals()) {
        for (int turn = -3; turn <= 3; ++turn) {
            const double angle = angle_deg + 360.0 * turn;
            if (angle >= each.from_deg - 1e-7 && angle <= each.to_deg + 1e-7) {
                return true;
            }
        }
    }
    return allowed.empty();
}

// Judges one layout; the faults, in words.
class Judge {
public:
    Judge(const FuzzJob& job, const Layout& layout) : job_(job), layout_(layout) {}

    std::vector<std::string> faults() {
        for (const Sheet& sheet : layout_.sheets) {
            judge_sheet(sheet);
        }
        judge_counts();
        const double gap = std::isfinite(smallest_mm_) ? smallest_mm_ : 0.0;
        if (std::abs(gap - layout_.smallest_gap_mm) > kToleranceMm) {
            fault(fmt::format("the smallest gap is {}, not {}", gap, layout_.smallest_gap_mm));
        }
        return faults_;
    }

private:
    void fault(std::string text) { faults_.push_back(std::move(text)); }

    const Piece& named(const std::string& id) const {
        return *std::find_if(job_.pieces.begin(), job_.pieces.end(),
                             [&](const Piece& piece) { return piece.id == id; });
    }

    // Written anew: mirrored never, rotated about the origin, moved.
    oracle::Loop loop_of(const Placement& at) const {
        const double turn = at.rotation_deg * std::numbers::pi / 180.0;
        Ring ring;
        for (const Eigen::Vector2d& p : named(at.piece).outline) {
            ring.emplace_back(std::cos(turn) * p.x() - std::sin(turn) * p.y() + at.x_mm,
                              std::sin(turn) * p.x() + std::cos(turn) * p.y() + at.y_mm);
        }
        return oracle::to_nano(ring);
    }

    void judge_sheet(const Sheet& sheet) {
        std::vector<oracle::Loop> loops;
        for (const Placement& at : sheet.placements) {
            ++placed_[at.piece];
            const auto own = job_.options.piece_turns.find(at.piece);
            const Rotations& allowed =
                own == job_.options.piece_turns.end() ? job_.options.turns : own->second;
            if (at.mirrored || !angle_is_allowed(allowed, at.rotation_deg)) {
                fault(fmt::format("{} at {} degrees", at.piece, at.rotation_deg));
            }
            loops.push_back(loop_of(at));
            judge_on_sheet(sheet, at.piece, loops.back());
        }
        const double gap = job_.options.spacing_mm + job_.options.kerf_mm - kToleranceMm;
        for (std::size_t i = 0; i < loops.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const double distance = oracle::distance_mm(loops[i], loops[j]);
                smallest_mm_ = std::min(smallest_mm_, distance);
                if (!oracle::apart(loops[i], loops[j], gap) || distance == 0.0) {
                    fault(fmt::format("{} and {} are {} apart", sheet.placements[i].piece,
                                      sheet.placements[j].piece, distance));
                }
            }
        }
    }

    void judge_on_sheet(const Sheet& sheet, const std::string& piece, const oracle::Loop& loop) {
        const double edge = job_.options.margin_mm + job_.options.kerf_mm / 2.0 - kToleranceMm;
        const Ring outline =
            sheet.outline.empty()
                ? rectangle({0.0, 0.0}, {sheet.size.width_mm, sheet.size.height_mm})
                : sheet.outline;
        const oracle::Loop frame = oracle::to_nano(outline);
        // On the very edge where nothing must be kept from it.
        const bool on_edge = edge <= 0.0 && sheet.outline.empty();
        const bool inside = on_edge || oracle::holds(frame, loop.front());
        if (!inside || oracle::distance_mm(frame, loop) < edge) {
            fault(fmt::format("{} leaves sheet {}", piece, sheet.id));
        }
        for (const oracle::Nano& p : loop) {
            if (p.x < -5 || p.y < -5 || static_cast<double>(p.x) > sheet.size.width_mm * 1e6 + 5 ||
                static_cast<double>(p.y) > sheet.size.height_mm * 1e6 + 5) {
                fault(fmt::format("{} leaves the bounds of sheet {}", piece, sheet.id));
            }
        }
        for (const SheetZone& zone : sheet.zones) {
            const double gap = zone.kind == ZoneKind::Hole ? edge
                               : zone.kind == ZoneKind::KeepOut
                                   ? job_.options.spacing_mm + job_.options.kerf_mm - kToleranceMm
                                   : 0.0;
            if (!oracle::apart(oracle::to_nano(zone.outline), loop, gap)) {
                fault(fmt::format("{} comes too near to a zone", piece));
            }
        }
    }

    void judge_counts() {
        for (const std::string& id : layout_.unplaced) {
            ++placed_[id];
            judge_left_over(named(id));
        }
        for (const Piece& piece : job_.pieces) {
            if (placed_[piece.id] != 1) {
                fault(fmt::format("{} is there {} times", piece.id, placed_[piece.id]));
            }
        }
        for (const StockItem& item : job_.stock) {
            const auto used =
                std::count_if(layout_.sheets.begin(), layout_.sheets.end(),
                              [&](const Sheet& sheet) { return sheet.stock == item.id; });
            if (item.quantity && used > *item.quantity) {
                fault(fmt::format("{} of sheet {}", used, item.id));
            }
        }
    }

    // Nothing may be left over that fits as drawn on a new plain sheet of which there is no end.
    void judge_left_over(const Piece& piece) {
        const auto own = job_.options.piece_turns.find(piece.id);
        const Rotations& allowed =
            own == job_.options.piece_turns.end() ? job_.options.turns : own->second;
        Eigen::Vector2d low = piece.outline.front();
        Eigen::Vector2d high = low;
        for (const Eigen::Vector2d& p : piece.outline) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        const double edges = 2.0 * job_.options.margin_mm + job_.options.kerf_mm + 2.0;
        for (const StockItem& item : job_.stock) {
            const bool endless = !item.quantity && item.outline.empty() && item.zones.empty();
            if (endless && angle_is_allowed(allowed, 0.0) &&
                high.x() - low.x() + edges < item.size.width_mm &&
                high.y() - low.y() + edges < item.size.height_mm) {
                fault(fmt::format("{} was left over though it fits {}", piece.id, item.id));
            }
        }
    }

    const FuzzJob& job_;
    const Layout& layout_;
    std::map<std::string, int> placed_;
    double smallest_mm_ = std::numeric_limits<double>::infinity();
    std::vector<std::string> faults_;
};

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
    const char* text = std::getenv(variable);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

TEST(NestFuzz, NoRandomJobIsLaidWrong) {
    const std::uint64_t jobs = number_from("LEAFCUTTER_FUZZ_JOBS", 2000);
    const std::uint64_t first = number_from("LEAFCUTTER_FUZZ_SEED", 1);
    std::uint64_t refused = 0;
    std::uint64_t placed = 0;
    std::uint64_t left_over = 0;
    std::uint64_t wrong = 0;
    for (std::uint64_t seed = first; seed < first + jobs; ++seed) {
        const FuzzJob job = random_job(seed);
        try {
            const Layout layout = nest(pointers(job.pieces), job.stock, job.options);
            for (const std::string& fault : Judge(job, layout).faults()) {
                ADD_FAILURE() << "seed " << seed << ": " << fault;
                ++wrong;
            }
            left_over += layout.unplaced.size();
            placed += job.pieces.size() - layout.unplaced.size();
        } catch (const geometry::Error& error) {
            // A sheet may be smaller than its margins: said so, by name.
            EXPECT_EQ(error.kind(), geometry::ErrorKind::BadOption) << seed << error.what();
            EXPECT_NE(std::string(error.what()).find("sheet S"), std::string::npos) << error.what();
            ++refused;
        }
    }
    fmt::print("{} jobs: {} violations, {} pieces placed, {} left over, {} jobs refused\n", jobs,
               wrong, placed, left_over, refused);
    EXPECT_LT(refused, jobs / 50 + 1);
    EXPECT_GT(placed, 5 * left_over);
}

// The oracle must see what is wrong, else it proves nothing.
TEST(NestFuzz, TheOracleSeesWrongLayouts) {
    FuzzJob job;
    job.pieces.resize(2);
    for (int i = 0; i < 2; ++i) {
        job.pieces[static_cast<std::size_t>(i)].id = fmt::format("W{}.1", i + 1);
        job.pieces[static_cast<std::size_t>(i)].outline = rectangle({0.0, 0.0}, {10.0, 5.0});
    }
    job.stock.resize(1);
    job.stock[0].id = "S0";
    job.stock[0].size = {60.0, 60.0};
    job.options.turns = {0.0};
    job.options.margin_mm = 2.0;
    job.options.max_evaluations = 100;
    const Layout good = nest(pointers(job.pieces), job.stock, job.options);
    EXPECT_TRUE(Judge(job, good).faults().empty());
    const auto expect_fault = [&](const auto& spoil) {
        Layout bad = good;
        spoil(bad);
        EXPECT_FALSE(Judge(job, bad).faults().empty());
    };
    expect_fault([](Layout& bad) { bad.sheets[0].placements[0].x_mm = 1.9; });
    expect_fault([](Layout& bad) {
        bad.sheets[0].placements[0] = bad.sheets[0].placements[1];
        bad.sheets[0].placements[0].piece = "W1.1";
    });
    expect_fault([](Layout& bad) { bad.sheets[0].placements[0].rotation_deg = 1.0; });
    expect_fault([](Layout& bad) { bad.sheets[0].placements.pop_back(); });
    expect_fault([](Layout& bad) { bad.smallest_gap_mm += 0.1; });
    expect_fault([](Layout& bad) {
        bad.sheets[0].zones.push_back({ZoneKind::Defect, rectangle({0.0, 0.0}, {60.0, 60.0})});
    });
}

}  // namespace
}  // namespace leafcutter::fab
