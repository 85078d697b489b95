#include "fab/nest/relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fab/nest/least_move.h"
#include "fab/nest/random.h"

namespace leafcutter::fab {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

double deepest_of(const std::vector<Contact>& contacts) {
    double most = 0.0;
    for (const Contact& contact : contacts) {
        most = std::max(most, contact.want);
    }
    return most;
}

constexpr double kSoft = 0.3;  // A push that leaves overlaps of some hundredths of a width.

}  // namespace

Relaxation::Relaxation(Board& board) : board_(board), contacts_(board) {
    for (std::size_t item = 0; item < board.items(); ++item) {
        trust_ += 0.25 * board.plan().part(item).width / static_cast<double>(board.items());
    }
}

bool Relaxation::relax(int steps, int kicks) {
    constexpr int kPatience = 4;  // Steps in which the deepest overlap must become 20 % less.
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0;; ++step) {
        const std::vector<Contact>& contacts = find();
        const double now = deepest_of(contacts);
        if (now <= contacts_.clearance()) {
            return board_.clashes().empty();
        }
        if (step == steps) {
            return false;
        }
        if (step % kPatience == 0 && now > 0.8 * before) {
            if (kicks == 0) {
                return false;
            }
            --kicks;
            kick(contacts);
            before = std::numeric_limits<double>::infinity();
            continue;
        }
        before = step % kPatience == 0 ? now : before;
        apply(LeastMove(board_.items(), contacts, {}).solve());
    }
}

// Where parts jam between walls at their full length, moves that free them gain nothing at first:
// no linear problem knows of them. Those that overlap move a little, at random.
void Relaxation::kick(const std::vector<Contact>& contacts) {
    constexpr double kShare = 0.01;  // Of a width.
    std::vector<bool> jammed(board_.items() + 2);
    for (const Contact& contact : contacts) {
        if (contact.want > contacts_.clearance()) {
            jammed[contact.item] = true;
            jammed[contact.other] = true;
        }
    }
    Random random(static_cast<std::uint64_t>(evaluations_));
    Eigen::VectorXd move = Eigen::VectorXd::Zero(static_cast<Index>(3 * board_.items() + 1));
    for (std::size_t item = 0; item < board_.items(); ++item) {
        for (std::size_t i = 0; i < 3 && jammed[item]; ++i) {
            move[static_cast<Index>(3 * item + i)] =
                kShare * board_.plan().part(item).width * random.normal();
        }
    }
    apply(move);
}

double Relaxation::make_room(int steps) {
    double deepest = 0.0;
    for (int step = 0; step < steps; ++step) {
        deepest = push_once(kSoft);
    }
    return deepest;
}

void Relaxation::settle() {
    push_until_it_rests(kSoft);
}

bool Relaxation::press() {
    constexpr int kSteps = 24;
    constexpr int kKicks = 3;
    // Under less and less of a push overlaps become smaller than what counts.
    for (const double push : {0.1 * kSoft, 0.01 * kSoft}) {
        push_until_it_rests(push);
    }
    const double pressed = board_.extent().last_width;
    for (const double slack : {1e-4, 5e-4}) {
        board_.set_last_width(pressed * (1.0 + slack));
        if (relax(kSteps, kKicks)) {
            return true;
        }
    }
    return false;
}

void Relaxation::push_until_it_rests(double push) {
    constexpr int kMost = 60;
    constexpr double kRest = 1e-4;
    int idle = 0;
    for (int step = 0; step < kMost && idle < 2; ++step) {
        const double before = board_.extent().last_width;
        push_once(push);
        idle = board_.extent().last_width < before * (1.0 - kRest) ? 0 : idle + 1;
    }
}

double Relaxation::push_once(double push) {
    const std::vector<Contact>& contacts = find();
    const double deepest = deepest_of(contacts);
    const Eigen::VectorXd move = LeastMove(board_.items(), contacts, {push, trust_}).solve();
    const double by = std::clamp(move[move.size() - 1], -2.0 * trust_, 2.0 * trust_);
    board_.set_last_width(board_.extent().last_width + by);
    apply(move);
    return deepest;
}

double Relaxation::deepest() {
    return deepest_of(find());
}

const std::vector<Contact>& Relaxation::find() {
    const std::vector<Contact>& contacts = contacts_.find();
    evaluations_ += static_cast<std::int64_t>((contacts.size() / 4 + board_.items()) / 4);
    return contacts;
}

// No part moves by more than half its width: what is linear holds no further.
void Relaxation::apply(const Eigen::VectorXd& move) {
    for (std::size_t item = 0; item < board_.items(); ++item) {
        const NestPart& part = board_.plan().part(item);
        const Vector3d by = move.segment<3>(static_cast<Index>(3 * item));
        // A unit of turn moves the ends of a part by two.
        const double most = by.head<2>().norm() + 2.0 * std::abs(by.z());
        if (most <= 0.0) {
            continue;
        }
        const double share = std::min(1.0, 0.5 * part.width / most);
        Position to = board_.position(item);
        to.x += share * by.x();
        to.y += share * by.y();
        if (part.turns_freely()) {
            const double turn_deg = share * by.z() * contacts_.turn(item) / kDegree;
            to.angle_deg =
                std::remainder(to.angle_deg + part.allowed_deg.step(to.angle_deg, turn_deg), 360.0);
        }
        board_.move(item, to);
    }
}

}  // namespace leafcutter::fab
