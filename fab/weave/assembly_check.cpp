// The check of an order of assembly: pieces on a table and on the surface, their ends and
// crossings, as hands would find them. It knows nothing of how the order was found.

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "fab/weave/assembly.h"

namespace leafcutter::fab {

namespace {

constexpr double kSlackMm = 1e-6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

enum class End { Free, OnTable, InPlace };

// A piece in somebody's hands. Its cells are counted from its own first one.
struct Held {
    const Piece* piece = nullptr;
    int strip = 0;
    bool lies = false;
    std::array<End, 2> end{End::Free, End::Free};  // Start, end,
    std::array<int, 2> beside{-1, -1};             // and the pieces that those are joined to.
    std::vector<char> made;                        // Per cell: its crossing is there.
};

// Where a strip's cell is to be found.
struct Spot {
    int piece = -1;
    int cell = 0;
};

class Table {
public:
    Table(std::span<const Strip> strips, std::span<const Piece> pieces, const Crossings& crossings)
        : strips_(strips), crossings_(crossings), spots_(strips.size()) {
        std::unordered_map<std::string, int> strip_numbers;
        for (std::size_t i = 0; i < strips.size(); ++i) {
            strip_numbers.emplace(strips[i].id, static_cast<int>(i));
            spots_[i].resize(strips[i].quads.size());
        }
        for (const Piece& piece : pieces) {
            Held held;
            held.piece = &piece;
            held.strip = strip_numbers.at(piece.strip);
            held.made.assign(at(piece.cell_count), 0);
            for (int cell = 0; cell < piece.cell_count; ++cell) {
                spots_[at(held.strip)][at(strip_cell(held, cell))] = {
                    static_cast<int>(pieces_.size()), cell};
            }
            numbers_.emplace(piece.id, static_cast<int>(pieces_.size()));
            pieces_.push_back(std::move(held));
        }
        wanted_joints(strip_numbers);
    }

    // What is wrong with the move; else it is made.
    std::string make(const AssemblyMove& move) {
        if (move.strip < 0 || at(move.strip) >= strips_.size()) {
            return "there is no such strip";
        }
        return move.kind == MoveKind::Lay || move.kind == MoveKind::Thread ? lay(move) : join(move);
    }

    std::string missing() const {
        for (const Held& held : pieces_) {
            if (!held.lies) {
                return fmt::format("{} is never laid", held.piece->id);
            }
            if (std::find(held.made.begin(), held.made.end(), 0) != held.made.end()) {
                return fmt::format("{} lacks a crossing", held.piece->id);
            }
        }
        for (const auto& [joint, made] : joints_) {
            if (!made) {
                return fmt::format("{} is never joined to {}", id(joint.first), id(joint.second));
            }
        }
        for (const auto& [rim, made] : rims_) {
            if (!made) {
                return fmt::format("{} is never glued to a rim", id(rim.first));
            }
        }
        return {};
    }

private:
    const std::string& id(int piece) const { return pieces_[at(piece)].piece->id; }

    int strip_cell(const Held& held, int cell) const {
        return (held.piece->first_cell + cell) %
               static_cast<int>(strips_[at(held.strip)].quads.size());
    }

    const Crossing& crossing(const Held& held, int cell) const {
        return crossings_[at(held.strip)][at(strip_cell(held, cell))];
    }

    void wanted_joints(const std::unordered_map<std::string, int>& strip_numbers) {
        for (const Strip& strip : strips_) {
            for (std::size_t i = 0; i < strip.pieces.size(); ++i) {
                const bool last = i + 1 == strip.pieces.size();
                const auto next = strip_numbers.find(strip.next);
                const std::string* onto = !last          ? &strip.pieces[i + 1]
                                          : strip.closed ? &strip.pieces.front()
                                          : next != strip_numbers.end()
                                              ? &strips_[at(next->second)].pieces.front()
                                              : nullptr;
                if (onto != nullptr) {
                    joints_[{numbers_.at(strip.pieces[i]), numbers_.at(*onto)}] = false;
                }
            }
            if (strip.glued_start.has_tab) {
                rims_[{numbers_.at(strip.pieces.front()), 0}] = false;
            }
            if (strip.glued_end.has_tab) {
                rims_[{numbers_.at(strip.pieces.back()), 1}] = false;
            }
        }
    }

    // Whether what lies over the piece at that cell is to be seen and can be folded back: on that
    // side of it nothing holds it down, as far as its end, and that end is loose.
    bool folds_back(Spot spot, std::size_t side) const {
        while (true) {
            const Held& held = pieces_[at(spot.piece)];
            spot.cell += side == 1 ? 1 : -1;
            if (spot.cell >= 0 && spot.cell < held.piece->cell_count) {
                if (held.made[at(spot.cell)] != 0 && !crossing(held, spot.cell).on_top) {
                    return false;
                }
                continue;
            }
            if (held.end[side] != End::OnTable) {
                return held.end[side] == End::Free;
            }
            spot.piece = held.beside[side];
            spot.cell = side == 1 ? -1 : pieces_[at(spot.piece)].piece->cell_count;
        }
    }

    bool is_held(const Spot& spot) const { return !folds_back(spot, 0) && !folds_back(spot, 1); }

    Spot spot_of(const Crossing& crossing) const {
        return spots_[at(crossing.strip)][at(crossing.cell)];
    }

    // The pieces of the move, joined to one run on the table, and to nothing else.
    std::string take(const AssemblyMove& move, std::vector<int>& run) const {
        for (const std::string& name : move.pieces) {
            const auto found = numbers_.find(name);
            if (found == numbers_.end()) {
                return "there is no piece " + name;
            }
            const Held& held = pieces_[at(found->second)];
            if (held.strip != move.strip || held.lies) {
                return name + (held.lies ? " lies there already" : " is of another strip");
            }
            const bool follows = run.empty()
                                     ? held.end[0] == End::Free
                                     : held.end[0] == End::OnTable && held.beside[0] == run.back();
            if (!follows) {
                return name + " is not joined to the one before it alone";
            }
            run.push_back(found->second);
        }
        if (run.empty() || pieces_[at(run.back())].end[1] != End::Free) {
            return "it is not all that is joined";
        }
        return {};
    }

    std::string lay(const AssemblyMove& move) {
        std::vector<int> run;
        if (std::string fault = take(move, run); !fault.empty()) {
            return fault;
        }
        std::vector<int> expected;
        for (const int piece : run) {
            for (int cell = 0; cell < pieces_[at(piece)].piece->cell_count; ++cell) {
                const Held& held = pieces_[at(piece)];
                if (pieces_[at(spot_of(crossing(held, cell)).piece)].lies) {
                    expected.push_back(strip_cell(held, cell));
                }
            }
        }
        std::vector<int> reversed(expected.rbegin(), expected.rend());
        if (move.cells != expected && move.cells != reversed) {
            return "its crossings are not those with what lies there, from one end to the other";
        }
        for (const int piece : run) {
            pieces_[at(piece)].lies = true;
        }
        std::size_t threaded = 0;
        for (const int cell : move.cells) {
            const Spot own = spots_[at(move.strip)][at(cell)];
            const Crossing& crossing = crossings_[at(move.strip)][at(cell)];
            const Spot other = spot_of(crossing);
            const bool listed =
                std::find(move.held.begin(), move.held.end(), cell) != move.held.end();
            if (!crossing.on_top && is_held(other) && !listed) {
                return fmt::format("{} lies over cell {} and cannot be folded back",
                                   id(other.piece), cell);
            }
            threaded += listed ? 1 : 0;
            pieces_[at(own.piece)].made[at(own.cell)] = 1;
            pieces_[at(other.piece)].made[at(other.cell)] = 1;
        }
        if (threaded != move.held.size() || (threaded > 0) != (move.kind == MoveKind::Thread)) {
            return "it does not say truly what is threaded";
        }
        return {};
    }

    // Strips that lie over the tab and can't be folded back.
    int held_over_tab(const Held& piece, const Held& onto) const {
        const double tab =
            std::max(piece.piece->end_tab.length_mm, onto.piece->start_tab.length_mm);
        const auto centre = [&](int rung) -> Eigen::Vector2d {
            return (onto.piece->left[at(rung)] + onto.piece->right[at(rung)]) / 2.0;
        };
        double reached = 0.0;
        int count = 0;
        for (int cell = 0; cell < onto.piece->cell_count && reached < tab - kSlackMm; ++cell) {
            const Crossing& over = crossing(onto, cell);
            count += onto.made[at(cell)] != 0 && !over.on_top && is_held(spot_of(over)) ? 1 : 0;
            reached += (centre(cell + 1) - centre(cell)).norm();
        }
        return count;
    }

    std::string glue(const AssemblyMove& move, Held& piece, bool& made) const {
        const auto onto = numbers_.find(move.onto);
        const bool lies =
            move.onto.empty() || (onto != numbers_.end() && pieces_[at(onto->second)].lies);
        if (!piece.lies || !lies || !move.in_place || move.kind != MoveKind::Join) {
            return "a rim is glued where both sides lie";
        }
        if (made) {
            return move.piece + " is glued already";
        }
        made = true;
        piece.end[move.at_start ? 0 : 1] = End::InPlace;
        return {};
    }

    std::string join(const AssemblyMove& move) {
        const auto first = numbers_.find(move.piece);
        const auto second = numbers_.find(move.onto);
        if (first == numbers_.end()) {
            return "there is no piece " + move.piece;
        }
        const auto rim = rims_.find({first->second, move.at_start ? 0 : 1});
        if (rim != rims_.end()) {
            return glue(move, pieces_[at(first->second)], rim->second);
        }
        if (second == numbers_.end() || move.at_start) {
            return "there is no piece for it to be joined to";
        }
        const auto joint = joints_.find({first->second, second->second});
        if (joint == joints_.end() || joint->second) {
            return fmt::format("{} does not go on in {}", move.piece, move.onto);
        }
        Held& piece = pieces_[at(first->second)];
        Held& onto = pieces_[at(second->second)];
        if (piece.strip != move.strip) {
            return move.piece + " is of another strip";
        }
        if (piece.lies != move.in_place || onto.lies != move.in_place) {
            return "the pieces are not where they are to be joined";
        }
        const bool closes = strips_[at(move.strip)].closed && is_last_joint(move.strip);
        if (closes != (move.kind == MoveKind::Close) || (closes && !move.in_place)) {
            return "a ring closes where it lies, with its last joint";
        }
        if (move.in_place && held_over_tab(piece, onto) > move.tucked) {
            return fmt::format("the tab of {} cannot be reached", move.piece);
        }
        joint->second = true;
        piece.end[1] = onto.end[0] = move.in_place ? End::InPlace : End::OnTable;
        piece.beside[1] = second->second;
        onto.beside[0] = first->second;
        return {};
    }

    bool is_last_joint(int strip) const {
        return std::count_if(joints_.begin(), joints_.end(), [&](const auto& joint) {
                   return !joint.second && pieces_[at(joint.first.first)].strip == strip;
               }) == 1;
    }

    std::span<const Strip> strips_;
    const Crossings& crossings_;
    std::vector<std::vector<Spot>> spots_;  // Per strip and cell.
    std::vector<Held> pieces_;
    std::unordered_map<std::string, int> numbers_;
    std::map<std::pair<int, int>, bool> joints_;  // End of the one, start of the other: made.
    std::map<std::pair<int, int>, bool> rims_;    // Piece; its start or its end: glued.
};

}  // namespace

std::optional<AssemblyFault> check_assembly(std::span<const Strip> strips,
                                            std::span<const Piece> pieces,
                                            const Crossings& crossings,
                                            const Assembly& assembly) {
    Table table(strips, pieces, crossings);
    for (std::size_t i = 0; i < assembly.moves.size(); ++i) {
        if (std::string what = table.make(assembly.moves[i]); !what.empty()) {
            return AssemblyFault{static_cast<int>(i), std::move(what)};
        }
    }
    if (std::string what = table.missing(); !what.empty()) {
        return AssemblyFault{static_cast<int>(assembly.moves.size()), std::move(what)};
    }
    return std::nullopt;
}

}  // namespace leafcutter::fab
