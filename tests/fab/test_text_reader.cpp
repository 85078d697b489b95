#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fab/cut/piece_finder.h"
#include "fab/cut/text_reader.h"
#include "fab/strips/labels.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;

// As a program spells coordinates.
Vector2d rounded(const Vector2d& point) {
    return {std::round(point.x() * 1e3) / 1e3, std::round(point.y() * 1e3) / 1e3};
}

void burn(const std::vector<Polyline>& strokes, std::vector<BurntSegment>& lines) {
    for (const Polyline& stroke : strokes) {
        for (std::size_t i = 1; i < stroke.size(); ++i) {
            lines.push_back({rounded(stroke[i - 1]), rounded(stroke[i])});
        }
    }
}

Mark text_mark(const std::string& text, const Vector2d& at, double angle_deg, double height_mm) {
    Mark mark;
    mark.text = text;
    mark.at = at;
    mark.angle_deg = angle_deg;
    mark.height_mm = height_mm;
    return mark;
}

std::vector<BurntSegment> burnt(const Mark& mark) {
    std::vector<BurntSegment> lines;
    burn(mark_strokes(mark), lines);
    return lines;
}

// In any order and direction, as a cutter's tour leaves them.
void shuffle(std::vector<BurntSegment>& lines, std::mt19937& random) {
    std::shuffle(lines.begin(), lines.end(), random);
    for (BurntSegment& line : lines) {
        if (random() % 2 == 0) {
            std::swap(line.from, line.to);
        }
    }
}

TEST(TextReader, ReadsEveryIdAtAnyPlaceAngleAndSize) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0.0, 800.0);
    std::uniform_real_distribution<double> turn(-180.0, 180.0);
    std::uniform_real_distribution<double> size(0.8, 6.0);
    for (int i = 0; i < 400; ++i) {
        const std::string id = (i % 2 == 0 ? "W" : "P") + std::to_string(random() % 1000 + 1) +
                               "." + std::to_string(random() % 12 + 1);
        const double angle = turn(random);
        const double height = size(random);
        const Mark mark = text_mark(id, {place(random), place(random)}, angle, height);
        std::vector<BurntSegment> lines = burnt(mark);
        shuffle(lines, random);
        const Reading reading = read_texts(lines);
        ASSERT_EQ(reading.texts.size(), 1U) << id << " at " << angle << ", " << height;
        EXPECT_EQ(reading.texts[0].text, id);
        EXPECT_TRUE(reading.rest.empty());
        EXPECT_LT((reading.texts[0].at - mark.at).norm(), 3e-3);
        EXPECT_NEAR(reading.texts[0].height_mm, height, 3e-3);
        EXPECT_NEAR(std::remainder(reading.texts[0].angle_deg - angle, 360.0), 0.0, 0.2);
    }
}

TEST(TextReader, TellsDigitsFromThemselvesUpsideDown) {
    for (const char* id : {"W6.9", "W96.1", "P66.6", "P99.9", "W8.8", "P11.1"}) {
        for (const double angle : {0.0, 180.0, 90.0}) {
            const Reading reading = read_texts(burnt(text_mark(id, {50.0, 50.0}, angle, 2.0)));
            ASSERT_EQ(reading.texts.size(), 1U) << id;
            EXPECT_EQ(reading.texts[0].text, id);
        }
    }
}

TEST(TextReader, ReadsEachOfSeveralTextsAmongOtherMarks) {
    std::vector<BurntSegment> lines = burnt(text_mark("W12.1", {10.0, 10.0}, 20.0, 3.0));
    for (const Mark& mark :
         {text_mark("P7", {40.0, 12.0}, 110.0, 1.5), text_mark("P8", {52.0, 14.0}, 110.0, 1.5)}) {
        const std::vector<BurntSegment> more = burnt(mark);
        lines.insert(lines.end(), more.begin(), more.end());
    }
    const std::size_t letters = lines.size();
    for (int i = 0; i < 20; ++i) {
        lines.push_back({{5.0 * i, 5.0}, {5.0 * i, 6.2}});
    }
    lines.push_back({{0.0, 30.0}, {20.0, 41.0}});
    std::mt19937 random(3);
    shuffle(lines, random);
    const Reading reading = read_texts(lines);
    std::vector<std::string> texts;
    for (const ReadText& text : reading.texts) {
        texts.push_back(text.text);
    }
    std::sort(texts.begin(), texts.end());
    EXPECT_EQ(texts, (std::vector<std::string>{"P7", "P8", "W12.1"}));
    EXPECT_EQ(reading.rest.size(), lines.size() - letters);
}

TEST(TextReader, DoesNotReadMirroredIds) {
    std::vector<BurntSegment> lines = burnt(text_mark("W12.3", {10.0, 10.0}, 0.0, 3.0));
    for (BurntSegment& line : lines) {
        line.from.x() = -line.from.x();
        line.to.x() = -line.to.x();
    }
    EXPECT_EQ(own_id(read_texts(lines).texts), "");
}

TEST(TextReader, ReadsNoIdWhereALineIsMissing) {
    const std::vector<BurntSegment> whole = burnt(text_mark("W27.4", {10.0, 10.0}, 33.0, 3.0));
    for (std::size_t gone = 0; gone < whole.size(); ++gone) {
        std::vector<BurntSegment> lines = whole;
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(gone));
        EXPECT_NE(own_id(read_texts(lines).texts), "W27.4") << gone;
    }
}

TEST(TextReader, FindsNothingInNothing) {
    const Reading reading = read_texts({});
    EXPECT_TRUE(reading.texts.empty());
    EXPECT_TRUE(reading.rest.empty());
}

TEST(OwnId, IsTheOneThatIsThereMostOftenThenTheTallest) {
    const auto text = [](const char* words, double height_mm) {
        ReadText read;
        read.text = words;
        read.height_mm = height_mm;
        return read;
    };
    EXPECT_EQ(own_id({}), "");
    EXPECT_EQ(own_id({text("P7", 5.0), text("+W3.2", 5.0)}), "");
    EXPECT_EQ(own_id({text("P7", 5.0), text("W3.1", 2.0)}), "W3.1");
    EXPECT_EQ(own_id({text("W3.2", 4.0), text("W3.1", 2.0), text("W3.1>", 2.0)}), "W3.1");
    EXPECT_EQ(own_id({text("W3.2", 4.0), text("W3.1", 2.0)}), "W3.2");
}

}  // namespace
}  // namespace leafcutter::fab
