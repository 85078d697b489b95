// The beam of one sheet's program: its journal while it runs, and what is known of it afterwards.

#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "drivers/burn/beam_follower.h"
#include "drivers/burn/journal_file.h"
#include "server/store/store.h"

namespace leafcutter::server {

class CutBeam {
public:
    // Begins the journal, on disk when this returns. Throws std::system_error for a disk that
    // fails; drivers::NotTraceable or drivers::ProgramRefused for a program that can't be followed.
    CutBeam(const Store& store,
            const CutRecord& cut,
            std::string_view program,
            const drivers::DeviceStatus& status);

    std::shared_ptr<drivers::JobWatch> watch() const { return follower_; }

    double burnt_mm() const { return follower_->burnt_mm(); }
    double total_mm() const { return path_->burn_mm(); }

    // Why the cut has to be stopped; empty: nothing is wrong.
    std::string trouble() const;

    // The program is over: whether the machine has said where it stands since. Asked again and
    // again.
    bool has_settled(const drivers::DeviceStatus& status);

    // Ends the journal.
    BeamRecord close(const drivers::JobProgress& progress, const drivers::DeviceStatus& status);

private:
    std::shared_ptr<const drivers::BeamPath> path_;
    std::filesystem::path file_;
    std::shared_ptr<drivers::JournalFile> journal_;
    std::shared_ptr<drivers::BeamFollower> follower_;
    std::optional<std::chrono::steady_clock::time_point> over_since_;
    std::size_t reports_ = 0;
};

// What the journal of the cut's current sheet tells; nothing if there is none.
std::optional<BeamRecord> read_beam(const Store& store, const CutRecord& cut);

// The journal's own words, for those who finish the cut: where the work origin lay in machine mm.
std::optional<std::array<double, 2>> origin_of_cut(const Store& store, const CutRecord& cut);

// A machine was met again: what its place tells of the cut that it was last at.
void note_found(Store& store, const std::string& device, const drivers::DeviceStatus& status);

// Cuts that a dead daemon left behind, from their journals.
void assess_interrupted(Store& store);

// The program of the cut's rest after so much is burnt; empty if nothing is left. Throws
// drivers::NotTraceable.
std::string rest_program(const Store& store, const CutRecord& cut, double burnt_mm);

// A sheet that is done needs no journal.
void forget_beam(const Store& store, const CutRecord& cut);

}  // namespace leafcutter::server
