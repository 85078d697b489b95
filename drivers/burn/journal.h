// What is written down while a cut runs, and what it tells about the beam after a crash, a pulled
// plug or a power cut. Pure; journal_file.h puts it on disk.
//
// Text, one record a line, each with a checksum: what a power cut left half written ends the
// journal. Times are seconds since its beginning.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/burn/beam_path.h"
#include "drivers/burn/beam_tracker.h"

namespace leafcutter::drivers {

// How a cut that is not done came to its end.
enum class BeamEnd {
    Unknown,    // Nobody wrote it down: the host died. The controller does all that it was sent.
    Stands,     // The controller answers, and knows where the head stands.
    Stopped,    // It says where the head stands, but was stopped in motion: steps may be lost.
    Restarted,  // The controller forgot everything: the head stopped then, its position is lost.
    Silent,     // The link is gone: stopped then, or did all that it was sent.
};

struct JournalRecord {
    enum class Kind {
        May,           // So many lines may be sent. On disk before the first of them is.
        Sent,          // So many are on the wire.
        Acknowledged,  // So many are planned.
        Position,      // Of the head.
        End,
        Found  // The controller was met again, with the head there; `end` is Stands or Stopped.
    };
    Kind kind = Kind::May;
    std::size_t lines = 0;
    double t_s = 0.0;
    Point at_mm{};
    BeamEnd end = BeamEnd::Unknown;
};

struct JournalHeader {
    std::string program;  // Names the program, its digest for one.
    Point start_mm{};     // Where the head stood before the first line.
    Point origin_mm{};    // The work origin in machine coordinates.
    std::size_t planner_blocks = 0;
};

struct Journal {
    JournalHeader header;
    std::vector<JournalRecord> records;
};

// Each with its line end.
std::string write_record(const JournalHeader& header);
std::string write_record(const JournalRecord& record);

// Reads up to the first damaged record. Nothing without a header.
std::optional<Journal> read_journal(std::string_view text);

struct BeamKnowledge {
    // Burnt lengths. The beam got to somewhere between the first and the last.
    double least_mm = 0.0;
    double likely_mm = 0.0;
    double most_mm = 0.0;
    double total_mm = 0.0;
    std::size_t line = 0;  // Of the likely place, from 0.
    Point at_mm{};
    bool position_kept = false;  // The controller still knows where the head stands.

    // To within a millimetre, with the overlap of a remainder.
    bool certain() const { return most_mm - least_mm <= 1.8; }
    double best_mm() const { return certain() ? (least_mm + most_mm) / 2.0 : likely_mm; }
};

// `path`: of the program that the journal names, from its start.
BeamKnowledge knowledge_of(const BeamPath& path, const Journal& journal);

}  // namespace leafcutter::drivers
