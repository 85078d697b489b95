#include "fab/export/scissors_pages.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kGapMm = 3.0;
constexpr double kReadableMm = 1.8;

// Lying: rows of strips want to be long.
SheetSize page_size(Paper paper) {
    switch (paper) {
        case Paper::A3:
            return {420.0, 297.0};
        case Paper::Letter:
            return {279.4, 215.9};
        case Paper::A4:
            break;
    }
    return {297.0, 210.0};
}

std::vector<const Piece*> in_order(const JobResult& job) {
    std::map<std::string_view, const Piece*> by_id;
    for (const Piece& piece : job.pieces) {
        by_id.emplace(piece.id, &piece);
    }
    std::vector<const Piece*> order;
    std::set<const Piece*> taken;
    const auto add = [&](const Piece* piece) {
        if (taken.insert(piece).second) {
            order.push_back(piece);
        }
    };
    for (const AssemblyMove& move : job.assembly.moves) {
        for (const std::string& id : move.pieces) {
            if (const auto found = by_id.find(id); found != by_id.end()) {
                add(found->second);
            }
        }
    }
    for (const Piece& piece : job.pieces) {
        add(&piece);
    }
    return order;
}

// A piece turned so that it lies along x, and its box.
struct Lying {
    const Piece* piece = nullptr;
    double angle_deg = 0.0;
    Box box;

    double width() const { return box.size().x(); }
    double height() const { return box.size().y() + (bears_name(*piece) ? 0.0 : kPieceNameMm); }
};

Lying lay(const Piece& piece) {
    const NestShape shape = make_shape(piece.outline);
    Lying lying;
    lying.piece = &piece;
    lying.angle_deg = shape.lying_deg.empty() ? 0.0 : shape.lying_deg.front();
    lying.box = bounds(moved(piece.outline, {lying.angle_deg, Vector2d::Zero()}));
    return lying;
}

// Fills pages row by row, from the top.
class PageFiller {
public:
    PageFiller(SheetSize size, Family family, std::vector<ScissorsPage>& pages)
        : size_(size), family_(family), pages_(pages) {}

    void add(const Lying& lying) {
        const double width = size_.width_mm - 2.0 * kPageMarginMm;
        const double height = size_.height_mm - 2.0 * kPageMarginMm - kPageFootMm;
        if (lying.width() > width || lying.height() > height) {
            long_ones_.push_back(lying);
            return;
        }
        if (is_open_ && x_ + lying.width() > width) {
            y_ += row_ + kGapMm;
            x_ = 0.0;
            row_ = 0.0;
        }
        if (!is_open_ || y_ + lying.height() > height) {
            pages_.push_back({size_, family_, true, {}});
            is_open_ = true;
            x_ = y_ = row_ = 0.0;
        }
        put(lying, {x_, y_}, pages_.back());
        x_ += lying.width() + kGapMm;
        row_ = std::max(row_, lying.height());
    }

    // Pages of what is too long for the paper: as many of them on one as it is high.
    void finish() {
        std::vector<Lying> rest = std::move(long_ones_);
        while (!rest.empty()) {
            std::vector<Lying> here;
            double height = 0.0;
            double width = 0.0;
            const double most = size_.height_mm - 2.0 * kPageMarginMm - kPageFootMm;
            for (const Lying& lying : rest) {
                if (!here.empty() && height + lying.height() > most) {
                    break;
                }
                height += lying.height() + kGapMm;
                width = std::max(width, lying.width());
                here.push_back(lying);
            }
            rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(here.size()));
            ScissorsPage page;
            page.family = family_;
            page.fits_paper = false;
            page.size = {
                std::max(size_.width_mm, std::ceil(width + 2.0 * kPageMarginMm)),
                std::max(size_.height_mm, std::ceil(height + 2.0 * kPageMarginMm + kPageFootMm))};
            double y = 0.0;
            for (const Lying& lying : here) {
                put(lying, {0.0, y}, page);
                y += lying.height() + kGapMm;
            }
            pages_.push_back(std::move(page));
        }
    }

private:
    // `corner`: of the box, from the usable area's upper left one, y down.
    static void put(const Lying& lying, const Vector2d& corner, ScissorsPage& page) {
        const Vector2d top_left(kPageMarginMm + corner.x(),
                                page.size.height_mm - kPageMarginMm - corner.y());
        const double name = lying.height() - lying.box.size().y();
        const Vector2d low(top_left.x(), top_left.y() - name - lying.box.size().y());
        page.pieces.push_back({lying.piece, {lying.angle_deg, low - lying.box.low}});
    }

    SheetSize size_;
    Family family_;
    std::vector<ScissorsPage>& pages_;
    std::vector<Lying> long_ones_;
    double x_ = 0.0;
    double y_ = 0.0;
    double row_ = 0.0;
    bool is_open_ = false;
};

}  // namespace

bool bears_name(const Piece& piece) {
    return std::any_of(piece.marks.begin(), piece.marks.end(), [&](const Mark& mark) {
        return mark.height_mm >= kReadableMm && mark.text.rfind(piece.id, 0) == 0;
    });
}

std::vector<ScissorsPage> scissors_pages(const JobResult& job) {
    const std::vector<const Piece*> order = in_order(job);
    std::vector<ScissorsPage> pages;
    for (const Family family : {Family::Weft, Family::Warp}) {
        PageFiller filler(page_size(job.params.output.paper), family, pages);
        for (const Piece* piece : order) {
            if (piece->family == family) {
                filler.add(lay(*piece));
            }
        }
        filler.finish();
    }
    return pages;
}

}  // namespace leafcutter::fab
