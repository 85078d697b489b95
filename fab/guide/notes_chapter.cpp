#include "fab/guide/notes_chapter.h"

#include <algorithm>

#include <fmt/format.h>

#include "fab/guide/wording.h"

namespace leafcutter::fab::guide {

namespace {

constexpr std::size_t kMostBreaks = 240;
constexpr std::size_t kMostWarnings = 60;

class NotesChapter {
public:
    NotesChapter(const JobIndex& index, Document& document)
        : index_(index), job_(index.job()), document_(document) {}

    void add() {
        document_.blocks.emplace_back(Heading{1, "Good to know"});
        add_left_out();
        add_breaks();
        add_flips();
        add_warnings();
        add_checks();
    }

private:
    void text(std::string words) {
        document_.blocks.emplace_back(Paragraph{std::move(words), TextStyle::Body});
    }

    void add_left_out() {
        std::vector<std::string> numbers;
        for (std::size_t i = 0; i < job_.quads.grids.size(); ++i) {
            if (job_.quads.grids[i].rows == 0) {
                numbers.push_back(fmt::format("{}", i + 1));
            }
        }
        if (!numbers.empty()) {
            text(
                fmt::format("Too narrow for a row of its own, so left out; what it parted is "
                            "joined directly: cylinder {}.",
                            first_of(numbers, 40)));
        }
    }

    std::string crossing_at(int quad) const {
        const int weft = index_.strip_at(quad, Family::Weft);
        const int warp = index_.strip_at(quad, Family::Warp);
        const auto name = [&](int strip) {
            return strip < 0 ? std::string("?") : job_.strips[static_cast<std::size_t>(strip)].id;
        };
        return fmt::format("{} x {}", name(weft), name(warp));
    }

    void add_breaks() {
        const std::size_t count = job_.weave.seams.size();
        document_.blocks.emplace_back(Heading{2, "Where the pattern breaks"});
        if (count == 0) {
            text("Nowhere: the pattern goes on over the whole model.");
            return;
        }
        text(
            fmt::format("Between {} of neighbouring crossings the pattern can't go on as it should "
                        "(the shape does not allow it everywhere). It is no mistake of yours.",
                        counted(count, "pair")));
        Table table;
        table.columns = {{"Crossing", Align::Left, 1.0}, {"beside", Align::Left, 1.0}};
        table.abreast = 3;
        for (std::size_t i = 0; i < std::min(count, kMostBreaks); ++i) {
            const auto& [one, other] = job_.weave.seams[i];
            table.rows.push_back(
                {Cell{crossing_at(one), {}, false, {}}, Cell{crossing_at(other), {}, false, {}}});
        }
        document_.blocks.emplace_back(std::move(table));
        if (count > kMostBreaks) {
            text(fmt::format("And {} more: weave.json lists all.", count - kMostBreaks));
        }
    }

    // Crossings turned over so that no strip runs too far on one side.
    void add_flips() {
        const std::vector<int>& flips = job_.weave.floats.flips;
        if (flips.empty()) {
            return;
        }
        std::vector<std::string> names;
        for (const int quad : flips) {
            names.push_back(crossing_at(quad));
        }
        text(fmt::format(
            "{} turned over on purpose, so that no strip runs far without being held: "
            "{}. Steps and marks count them in.",
            flips.size() == 1 ? "One crossing is" : fmt::format("{} crossings are", flips.size()),
            first_of(names, 60)));
    }

    void add_warnings() {
        if (job_.warnings.empty()) {
            return;
        }
        document_.blocks.emplace_back(Heading{2, "Mind"});
        List list;
        for (std::size_t i = 0; i < std::min(job_.warnings.size(), kMostWarnings); ++i) {
            list.items.push_back(job_.warnings[i]);
        }
        if (job_.warnings.size() > kMostWarnings) {
            list.items.push_back(fmt::format("And {} more: report.json lists all.",
                                             job_.warnings.size() - kMostWarnings));
        }
        document_.blocks.emplace_back(std::move(list));
    }

    void add_checks() {
        document_.blocks.emplace_back(Heading{2, "Checked"});
        List list;
        const Certificate& certificate = job_.certificate;
        if (certificate.edges_compared > 0 && certificate.holds) {
            list.items.push_back(fmt::format(
                "The cut files were read back, and the strips rebuilt from them woven on the "
                "computer: no point of the model lies more than {:.3f} mm off.",
                certificate.largest_deviation_mm));
        } else if (certificate.edges_compared > 0) {
            list.items.push_back(
                "The cut files were read back, and not all strips could be rebuilt from them: see "
                "the certificate in report.json before cutting.");
        }
        list.items.push_back(fmt::format(
            "Every crossing is made in one step and one only: {} crossings in {} moves.",
            job_.quads.quads.size(), job_.assembly.moves.size()));
        if (job_.assembly.threaded > 0) {
            list.items.push_back(fmt::format(
                "{} need threading, under {} at most.",
                counted(static_cast<std::size_t>(job_.assembly.threaded), "strip"),
                counted(static_cast<std::size_t>(job_.assembly.longest_thread), "strip")));
        } else if (!job_.assembly.moves.empty()) {
            list.items.push_back("No strip has to be threaded.");
        }
        document_.blocks.emplace_back(std::move(list));
    }

    const JobIndex& index_;
    const JobResult& job_;
    Document& document_;
};

}  // namespace

void add_notes_chapter(const JobIndex& index, Document& document) {
    NotesChapter(index, document).add();
}

}  // namespace leafcutter::fab::guide
