#include "fab/nest/sheet_plan.h"

#include <cmath>
#include <limits>
#include <utility>

namespace leafcutter::fab {

SheetFrame::SheetFrame(const SheetProblem& problem,
                       const std::vector<std::vector<NestPart>>& taken,
                       int quarters)
    : problem_(problem), quarters_(quarters), parts_(problem.parts) {
    for (NestPart& part : parts_) {
        part.allowed_deg = part.allowed_deg.shifted(-90.0 * quarters);
        std::vector<TurnedPart> turned(part.turns_freely() ? 0 : part.allowed_deg.size());
        for (std::size_t k = 0; k < turned.size(); ++k) {
            turn_part(part, part.allowed_deg[k], turned[k]);
        }
        turned_.push_back(std::move(turned));
    }
    for (std::size_t kind = 0; kind < problem.kinds.size(); ++kind) {
        fixed_.push_back(fixed_of(problem.kinds[kind], taken[kind]));
    }
}

double SheetFrame::width(std::size_t kind) const {
    const SheetKind& sheet = problem_.kinds[kind];
    return quarters_ % 2 == 0 ? sheet.width : sheet.height;
}

double SheetFrame::height(std::size_t kind) const {
    const SheetKind& sheet = problem_.kinds[kind];
    return quarters_ % 2 == 0 ? sheet.height : sheet.width;
}

std::vector<std::vector<NestPart>> taken_parts(const SheetProblem& problem) {
    std::vector<std::vector<NestPart>> parts;
    for (const SheetKind& kind : problem.kinds) {
        parts.emplace_back();
        for (const FixedRing& taken : kind.fixed) {
            parts.back().push_back(make_part(taken.ring, 0.0, {0.0}));
        }
    }
    return parts;
}

std::vector<BoardPlan::Fixed> SheetFrame::fixed_of(const SheetKind& kind,
                                                   const std::vector<NestPart>& parts) const {
    std::vector<BoardPlan::Fixed> out;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Eigen::Vector2d origin = parts[i].origin;
        double width = kind.width;
        double height = kind.height;
        for (int turn = 0; turn < quarters_; ++turn) {
            origin = {origin.y(), width - origin.x()};
            std::swap(width, height);
        }
        BoardPlan::Fixed fixed;
        turn_part(parts[i], -90.0 * quarters_, fixed.shape);
        // Back to where it lies: the part is about its own origin.
        shift_part(fixed.shape, static_cast<float>(origin.x()), static_cast<float>(origin.y()));
        fixed.quality = kind.fixed[i].quality;
        fixed.solid = kind.fixed[i].solid;
        out.push_back(std::move(fixed));
    }
    return out;
}

BoardPlan SheetFrame::plan(std::span<const std::size_t> items,
                           std::span<const std::size_t> kinds) const {
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    BoardPlan plan;
    std::vector<std::size_t> slot(parts_.size(), kNone);
    for (const std::size_t item : items) {
        const std::size_t part = problem_.part_of[item];
        if (slot[part] == kNone) {
            slot[part] = plan.parts.size();
            plan.parts.push_back(parts_[part]);
            plan.turned.push_back(turned_[part]);
        }
        plan.part_of.push_back(slot[part]);
    }
    for (const std::size_t kind : kinds) {
        for (BoardPlan::Fixed fixed : fixed_[kind]) {
            fixed.bin = static_cast<int>(plan.rooms.size());
            plan.fixed.push_back(std::move(fixed));
        }
        plan.rooms.push_back({width(kind), height(kind)});
    }
    return plan;
}

Position SheetFrame::on_sheet(const Position& position, std::size_t kind) const {
    Position out = position;
    double height = this->height(kind);
    double width = this->width(kind);
    for (int turn = 0; turn < quarters_; ++turn) {
        const double x = out.x;
        out.x = height - out.y;
        out.y = x;
        std::swap(width, height);
    }
    out.angle_deg = std::remainder(position.angle_deg + 90.0 * quarters_, 360.0);
    return out;
}

}  // namespace leafcutter::fab
