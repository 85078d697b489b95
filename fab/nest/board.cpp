#include "fab/nest/board.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fab/nest/pair_loss.h"

namespace leafcutter::fab {

namespace {

Eigen::Vector2f point(double x, double y) {
    return {static_cast<float>(x), static_cast<float>(y)};
}

}  // namespace

bool is_banded(const BoardPlan& plan) {
    std::size_t bands = 0;
    for (const std::size_t part : plan.part_of) {
        const NestPart& p = plan.parts[part];
        if (!p.turns_freely()) {
            return false;
        }
        bands += p.is_band() ? 1 : 0;
    }
    return 2 * bands > plan.part_of.size();
}

bool has_many_copies(const BoardPlan& plan) {
    constexpr std::size_t kMany = 8;
    return plan.part_of.size() >= kMany * plan.parts.size();
}

Board::Board(const BoardPlan& plan)
    : plan_(plan),
      at_(plan.part_of.size()),
      own_(plan.part_of.size()),
      shelves_(plan.rooms.size()),
      slot_(plan.part_of.size() + plan.fixed.size()),
      weights_(plan.part_of.size() * (plan.part_of.size() + plan.fixed.size() + 1), 1.0F) {
    std::size_t fullest = plan.part_of.size() + plan.fixed.size();
    near_.resize(fullest);
}

double Board::width_of(int bin) const {
    return bin + 1 == extent_.bins ? extent_.last_width
                                   : plan_.rooms[static_cast<std::size_t>(bin)].width;
}

const TurnedPart& Board::shape(std::size_t item) const {
    const std::size_t part = plan_.part_of[item];
    return plan_.parts[part].turns_freely()
               ? own_[item]
               : plan_.turned[part][static_cast<std::size_t>(at_[item].turn)];
}

const TurnedPart& Board::turned(std::size_t item,
                                const Position& position,
                                TurnedPart& scratch) const {
    const std::size_t part = plan_.part_of[item];
    if (!plan_.parts[part].turns_freely()) {
        return plan_.turned[part][static_cast<std::size_t>(position.turn)];
    }
    turn_part(plan_.parts[part], position.angle_deg, scratch);
    return scratch;
}

void Board::restore(const std::vector<Position>& positions, const Extent& extent) {
    extent_ = extent;
    for (Shelf& shelf : shelves_) {
        for (auto* array : {&shelf.low_x, &shelf.low_y, &shelf.high_x, &shelf.high_y}) {
            array->clear();
        }
        shelf.who.clear();
    }
    put_fixed();
    for (std::size_t item = 0; item < items(); ++item) {
        const bool turned_anew =
            at_[item].angle_deg != positions[item].angle_deg || own_[item].edges == 0;
        at_[item] = positions[item];
        if (turned_anew && plan_.part(item).turns_freely()) {
            turn_part(plan_.part(item), at_[item].angle_deg, own_[item]);
        }
        put(item);
    }
    for (const std::size_t cell : heavy_) {
        weights_[cell] = 1.0F;
    }
    heavy_.clear();
}

void Board::put_fixed() {
    for (std::size_t i = 0; i < plan_.fixed.size(); ++i) {
        const BoardPlan::Fixed& fixed = plan_.fixed[i];
        Shelf& shelf = shelves_[static_cast<std::size_t>(fixed.bin)];
        shelf.low_x.push_back(fixed.shape.low_x);
        shelf.low_y.push_back(fixed.shape.low_y);
        shelf.high_x.push_back(fixed.shape.high_x);
        shelf.high_y.push_back(fixed.shape.high_y);
        shelf.who.push_back(items() + i);
    }
}

void Board::put(std::size_t item) {
    const TurnedPart& part = shape(item);
    const Position& at = at_[item];
    Shelf& shelf = shelves_[static_cast<std::size_t>(at.bin)];
    const auto x = static_cast<float>(at.x);
    const auto y = static_cast<float>(at.y);
    slot_[item] = shelf.who.size();
    shelf.low_x.push_back(part.low_x + x);
    shelf.low_y.push_back(part.low_y + y);
    shelf.high_x.push_back(part.high_x + x);
    shelf.high_y.push_back(part.high_y + y);
    shelf.who.push_back(item);
}

void Board::take(std::size_t item) {
    Shelf& shelf = shelves_[static_cast<std::size_t>(at_[item].bin)];
    const std::size_t slot = slot_[item];
    for (auto* array : {&shelf.low_x, &shelf.low_y, &shelf.high_x, &shelf.high_y}) {
        (*array)[slot] = array->back();
        array->pop_back();
    }
    shelf.who[slot] = shelf.who.back();
    shelf.who.pop_back();
    if (slot < shelf.who.size()) {
        slot_[shelf.who[slot]] = slot;
    }
}

void Board::move(std::size_t item, const Position& to) {
    take(item);
    const bool turned_anew = at_[item].angle_deg != to.angle_deg;
    at_[item] = to;
    if (turned_anew && plan_.part(item).turns_freely()) {
        turn_part(plan_.part(item), to.angle_deg, own_[item]);
    }
    put(item);
}

void Board::take_outline(std::size_t item) {
    take(item);
    turn_part(plan_.part(item), at_[item].angle_deg, own_[item]);
    put(item);
}

std::span<const std::size_t> Board::near(const Shelf& shelf,
                                         const TurnedPart& shape,
                                         const Position& position) const {
    const float low_x = shape.low_x + static_cast<float>(position.x);
    const float low_y = shape.low_y + static_cast<float>(position.y);
    const float high_x = shape.high_x + static_cast<float>(position.x);
    const float high_y = shape.high_y + static_cast<float>(position.y);
    const std::size_t count = shelf.who.size();
    const float* x0 = shelf.low_x.data();
    const float* y0 = shelf.low_y.data();
    const float* x1 = shelf.high_x.data();
    const float* y1 = shelf.high_y.data();
    std::size_t* out = near_.data();
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
        out[found] = i;
        const unsigned hit = (x0[i] <= high_x ? 1U : 0U) & (x1[i] >= low_x ? 1U : 0U) &
                             (y0[i] <= high_y ? 1U : 0U) & (y1[i] >= low_y ? 1U : 0U);
        found += hit;
        if (found == near_.size()) {
            break;
        }
    }
    return {out, found};
}

float Board::pair_at(std::size_t item,
                     const TurnedPart& shape,
                     const Position& position,
                     std::size_t other) const {
    if (other >= items()) {
        const BoardPlan::Fixed& fixed = plan_.fixed[other - items()];
        if (!plan_.binds(fixed, plan_.part(item))) {
            return 0.0F;
        }
        return pair_loss(shape, fixed.shape, static_cast<float>(position.x),
                         static_cast<float>(position.y));
    }
    const Position& there = at_[other];
    return pair_loss(shape, this->shape(other), static_cast<float>(position.x - there.x),
                     static_cast<float>(position.y - there.y));
}

float Board::loss_at(std::size_t item,
                     const TurnedPart& shape,
                     const Position& position,
                     float bound) const {
    ++evaluations_;
    const Shelf& shelf = shelves_[static_cast<std::size_t>(position.bin)];
    float total = sheet_loss(shape, point(position.x, position.y),
                             point(width_of(position.bin), height_of(position.bin)));
    if (total > 0.0F) {
        total *= weight(item, edge_column());
    }
    for (const std::size_t i : near(shelf, shape, position)) {
        if (total >= bound) {
            return total;
        }
        const std::size_t other = shelf.who[i];
        if (other == item) {
            continue;
        }
        const float loss = pair_at(item, shape, position, other);
        if (loss > 0.0F) {
            total += loss * weight(item, other);
        }
    }
    return total;
}

bool Board::is_free(std::size_t item) const {
    return loss_at(item, shape(item), at_[item], std::numeric_limits<float>::min()) <= 0.0F;
}

std::vector<PoseClash> Board::clashes() const {
    std::vector<PoseClash> found;
    for (std::size_t item = 0; item < items(); ++item) {
        const Position& at = at_[item];
        const TurnedPart& part = shape(item);
        const float edge =
            sheet_loss(part, point(at.x, at.y), point(width_of(at.bin), height_of(at.bin)));
        if (edge > 0.0F) {
            found.push_back({item, edge_column(), edge});
        }
        const Shelf& shelf = shelves_[static_cast<std::size_t>(at.bin)];
        for (const std::size_t i : near(shelf, part, at)) {
            const std::size_t other = shelf.who[i];
            if (other <= item) {
                continue;
            }
            const float loss = pair_at(item, part, at, other);
            if (loss > 0.0F) {
                found.push_back({item, other, loss});
            }
        }
    }
    return found;
}

float Board::weight(std::size_t item, std::size_t other) const {
    const std::size_t row = std::min(item, other);
    const std::size_t column = std::max(item, other);
    return weights_[row * (edge_column() + 1) + column];
}

float& Board::weight_cell(std::size_t item, std::size_t other) {
    const std::size_t row = std::min(item, other);
    const std::size_t column = std::max(item, other);
    return weights_[row * (edge_column() + 1) + column];
}

void Board::reweigh(const std::vector<PoseClash>& clashes) {
    constexpr float kForget = 0.95F;
    constexpr float kHeaviest = 1e12F;
    float largest = 0.0F;
    for (const PoseClash& clash : clashes) {
        largest = std::max(largest, clash.loss);
    }
    for (const PoseClash& clash : clashes) {
        float& cell = weight_cell(clash.item, clash.other);
        if (cell <= 1.0F) {
            heavy_.push_back(static_cast<std::size_t>(&cell - weights_.data()));
        }
        cell = std::min(kHeaviest, cell * (1.2F + 0.8F * clash.loss / largest) / kForget);
    }
    std::size_t kept = 0;
    for (const std::size_t cell : heavy_) {
        weights_[cell] = std::max(1.0F, weights_[cell] * kForget);
        if (weights_[cell] > 1.0F) {
            heavy_[kept++] = cell;
        }
    }
    heavy_.resize(kept);
}

}  // namespace leafcutter::fab
