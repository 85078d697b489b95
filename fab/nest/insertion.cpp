#include "fab/nest/insertion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leafcutter::fab {

namespace {

// A band grows by steps of equal size.
constexpr int kStages = 5;         // The last one is the whole width.
constexpr int kMeasured = 2;       // Of which seams are measured.
constexpr double kThinnest = 0.2;  // Share of the width, at the first stage.
constexpr int kSteps = 2;          // Of all parts, at each stage.
constexpr int kTries = 60;         // Seams looked at.
constexpr double kLost = 3e-4;     // Of the layout's width: what a push leaves open.
constexpr int kParted = 2;         // The stage by which others have made way,
constexpr double kCrossed = 0.15;  // or lie across if they overlap by this share of a width still.
constexpr double kDeepest = 0.06;  // Likewise at the end.

Eigen::Vector2d nearest_of_middle(const NestPart& band, const Eigen::Vector2d& point) {
    double best = std::numeric_limits<double>::infinity();
    Eigen::Vector2d nearest = point;
    for (std::size_t k = 0; k + 1 < band.middle.size(); ++k) {
        const Eigen::Vector2d& start = band.middle[k].circle.centre;
        const Eigen::Vector2d along = band.middle[k + 1].circle.centre - start;
        const double square = along.squaredNorm();
        const double t =
            square > 0.0 ? std::clamp((point - start).dot(along) / square, 0.0, 1.0) : 0.0;
        const Eigen::Vector2d foot = start + t * along;
        if ((foot - point).squaredNorm() < best) {
            best = (foot - point).squaredNorm();
            nearest = foot;
        }
    }
    return nearest;
}

// The band at a share of its width, about its middle line.
NestPart thinned(const NestPart& band, double share) {
    NestPart thin = band;
    for (Eigen::Vector2d& point : thin.outline) {
        const Eigen::Vector2d middle = nearest_of_middle(band, point);
        point = middle + share * (point - middle);
    }
    for (Circle& circle : thin.circles) {
        circle.radius *= share;
    }
    for (BandPoint& point : thin.middle) {
        point.circle.radius *= share;
    }
    return thin;
}

// After the parts as they are come those of the first stage, then of the second, and so on.
BoardPlan with_stages(const BoardPlan& plan) {
    BoardPlan out = plan;
    for (int stage = 0; stage + 1 < kStages; ++stage) {
        const double share = kThinnest + (1.0 - kThinnest) * stage / (kStages - 1);
        for (const NestPart& part : plan.parts) {
            out.parts.push_back(part.is_band() ? thinned(part, share) : part);
        }
    }
    out.turned.resize(out.parts.size());
    return out;
}

std::vector<std::size_t> bands_of(const BoardPlan& plan) {
    std::vector<std::size_t> bands;
    for (std::size_t item = 0; item < plan.part_of.size(); ++item) {
        if (plan.part(item).is_band()) {
            bands.push_back(item);
        }
    }
    return bands;
}

}  // namespace

Insertion::Insertion(const BoardPlan& plan, std::uint64_t seed)
    : plan_(with_stages(plan)),
      whole_(plan.part_of),
      bands_(bands_of(plan)),
      random_(seed),
      board_(plan_),
      search_(board_, random_),
      relaxation_(board_) {}

Packing Insertion::settle(const Packing& packing) {
    board_.restore(packing.positions, packing.extent);
    relaxation_.settle();
    return laid();
}

std::optional<Insertion::Pressed> Insertion::attempt(const Packing& settled, double wider) {
    board_.restore(settled.positions, settled.extent);
    const std::size_t item = bands_[random_.below(bands_.size())];
    const double widest = settled.extent.last_width * (1.0 + std::max(kLost, wider));
    const std::optional<Position> to = elsewhere(item);
    if (!to || !grow(item, *to, widest)) {
        set_stage(item, kStages - 1);
        return std::nullopt;
    }
    relaxation_.settle();
    if (board_.extent().last_width > widest ||
        relaxation_.deepest() > kDeepest * board_.plan().part(item).width) {
        return std::nullopt;
    }
    Pressed pressed{{}, laid()};
    if (!relaxation_.press()) {
        return std::nullopt;
    }
    pressed.packing = laid();
    return pressed;
}

void Insertion::set_stage(std::size_t item, int stage) {
    const std::size_t parts = plan_.parts.size() / kStages;
    plan_.part_of[item] =
        whole_[item] + (stage + 1 < kStages ? parts * (static_cast<std::size_t>(stage) + 1) : 0);
    board_.take_outline(item);
    relaxation_.forget(item);
}

// A good place beside another band, but not where it came from: there it would only fall back.
std::optional<Position> Insertion::elsewhere(std::size_t item) {
    const Position from = board_.position(item);
    Position away = from;
    away.x = -1e5;
    board_.move(item, away);
    set_stage(item, kMeasured);
    const std::vector<Candidate> found = search_.beside_others(item, kTries, from);
    if (found.empty()) {
        return std::nullopt;
    }
    return found[random_.early(found.size(), 0.3)].position;
}

// False if the others would need more than `widest` or do not part.
bool Insertion::grow(std::size_t item, const Position& at, double widest) {
    board_.move(item, at);
    const double crossed = kCrossed * plan_.parts[whole_[item]].width;
    for (int stage = 0; stage < kStages; ++stage) {
        set_stage(item, stage);
        const double deepest = relaxation_.make_room(kSteps);
        if (board_.extent().last_width > widest || (stage >= kParted && deepest > crossed)) {
            return false;
        }
    }
    return true;
}

}  // namespace leafcutter::fab
