// What the store keeps, as plain values. Times are milliseconds since 1970 (wall clock, for display
// only: order is that of event numbers). JSON members are text that the store never looks into.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/queue/states.h"

namespace leafcutter::server {

struct SourceFile {
    std::string name;  // As the client gave it; data only, never a path.
    std::int64_t bytes = 0;
    std::string sha256;  // Lower-case hex; the blob that holds it.
};

struct JobFailure {
    std::string
        kind;  // "bad-file", "bad-mesh", "bad-option", "not-supported", "internal", "crashed".
    std::string code;
    std::string detail;
};

struct SheetRecord {
    int number = 1;
    std::string material;
    std::string program_sha256;  // Of the G-code; empty if the sheet has none.
    double estimated_s = 0.0;
    bool cut = false;
    std::array<double, 2> size_mm = {};  // 0: not known.
    std::string stock = {};        // The entry of the stock it was planned on; empty: a new one.
    std::string offcut_json = {};  // What it leaves, as a record of stock; empty: nothing.
};

struct ArtifactRecord {
    std::string path;  // Inside the package.
    std::int64_t bytes = 0;
    std::string sha256;
    std::string media_type;
};

struct JobRecord {
    std::string id;  // "j_…"
    std::int64_t ordinal = 0;
    std::string name;
    JobState state = JobState::Queued;
    std::int64_t version = 1;
    std::int64_t created_ms = 0;
    std::int64_t updated_ms = 0;
    SourceFile file;
    std::string params_json = "{}";
    int attempt = 0;
    int priority = 0;  // The highest goes first.
    int retries = 0;
    std::string retry_cause;  // Of the last retry.
    std::optional<JobFailure> failure;
    std::optional<std::string> summary_json;
    std::vector<SheetRecord> sheets;
    std::vector<std::string> cuts;
    bool has_open_cut = false;
    std::string recut_of;             // The job whose pieces it cuts again; empty: none.
    std::string recut_json;           // Which ones, see server/recut_wishes.h; empty: all is woven.
    std::string owner;                // The node that computes it, or did last.
    std::int64_t fence = 0;           // Grows with every claim.
    std::int64_t lease_until_ms = 0;  // Of the claim; 0: without end.
};

// How far the beam got in a cut that ended early, in burnt mm of its sheet's program.
struct BeamRecord {
    double least_mm = 0.0;
    double likely_mm = 0.0;
    double most_mm = 0.0;
    double total_mm = 0.0;
    int line = 0;  // Of the program as it is streamed, from 1.
    std::array<double, 2> at_mm{};
    bool certain = false;        // To within a millimetre.
    bool position_kept = false;  // The machine still knows where its head stands.
};

struct CutRecord {
    std::string id;  // "c_…"
    std::int64_t ordinal = 0;
    std::string job;
    std::string device;
    std::vector<int> sheets;   // In the order they are cut.
    std::size_t position = 0;  // Index into `sheets` of the current one.
    CutState state = CutState::Waiting;
    std::int64_t version = 1;
    std::string program_sha256;  // Of the current sheet's program.
    std::string rest_of;         // The cut whose rest its first sheet is; empty: none.
    std::optional<BeamRecord> beam;
    std::int64_t lines_total = 0;
    std::int64_t lines_sent = 0;
    std::int64_t lines_acknowledged = 0;
    std::string reason;
    std::int64_t created_ms = 0;
    std::int64_t updated_ms = 0;
    std::string owner;       // The station that began it last.
    std::int64_t fence = 0;  // Of the machine's lease under which it did.

    int sheet() const { return sheets.at(position); }
    bool on_last_sheet() const { return position + 1 == sheets.size(); }
    bool is_rest() const { return position == 0 && !rest_of.empty(); }

    // Where an armed cut goes back to.
    CutState before_arming() const {
        return position > 0 ? CutState::AwaitingSheet : CutState::Waiting;
    }
};

// Sheets of one kind at hand, or one remnant.
struct StockRecord {
    std::string id;
    std::string json;             // As job parameters take an entry of nesting.stock.
    std::string material;         // Empty: whichever is asked for.
    std::optional<int> quantity;  // None: as many as wanted.
    std::string note;
    std::string from_job;  // Whose sheet left it; empty: somebody put it there.
    int from_sheet = 0;
    std::int64_t created_ms = 0;
    std::int64_t updated_ms = 0;
    int planned = 0;  // Of these, so many are in the plans of jobs that are ready, not cut yet.
};

struct DeviceRecord {
    std::string id;
    std::string name;
    std::string uri;
    bool auto_start = false;
    std::array<double, 2> bed_mm{600.0, 400.0};
    std::string station = {};  // The node on which it hangs; empty: this daemon.
};

// One line of the append-only log; `seq` is the id that event streams carry.
struct EventRecord {
    std::int64_t seq = 0;
    std::int64_t at_ms = 0;
    std::string type;     // "job" or "cut".
    std::string subject;  // Its id.
    std::string job;      // The job it belongs to.
    std::string note;     // "queued -> computing", "removed".
};

}  // namespace leafcutter::server
