#include "drivers/burn/journal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

using Kind = JournalRecord::Kind;

constexpr std::string_view kFormat = "leafcutter-journal/1";
constexpr double kSlowestReports = 1.0;  // Seconds.
constexpr double kReportDelay = 0.01;
constexpr double kSamePlace = 0.1;  // mm

constexpr std::array<std::pair<Kind, char>, 6> kLetters{{{Kind::May, 'M'},
                                                         {Kind::Sent, 'S'},
                                                         {Kind::Acknowledged, 'A'},
                                                         {Kind::Position, 'P'},
                                                         {Kind::End, 'E'},
                                                         {Kind::Found, 'F'}}};

// FNV-1a: told apart are whole records from torn ones, nobody forges them.
std::uint32_t sum_of(std::string_view text) {
    std::uint32_t sum = 2166136261U;
    for (const char letter : text) {
        sum = (sum ^ static_cast<unsigned char>(letter)) * 16777619U;
    }
    return sum;
}

std::string sealed(const std::string& text) {
    return fmt::format("{} {:08x}\n", text, sum_of(text));
}

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    while (!line.empty()) {
        const std::size_t blank = std::min(line.find(' '), line.size());
        fields.push_back(line.substr(0, blank));
        line.remove_prefix(std::min(blank + 1, line.size()));
    }
    return fields;
}

template <typename Number>
bool read_number(std::string_view text, Number& number) {
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    return read.ec == std::errc{} && read.ptr == end;
}

// The fields of a whole record; none for a damaged one.
std::vector<std::string_view> opened(std::string_view line) {
    const std::size_t last = line.rfind(' ');
    if (last == std::string_view::npos ||
        line.substr(last + 1) != fmt::format("{:08x}", sum_of(line.substr(0, last)))) {
        return {};
    }
    return fields_of(line.substr(0, last));
}

std::optional<JournalHeader> read_header(const std::vector<std::string_view>& fields) {
    JournalHeader header;
    if (fields.size() != 7 || fields[0] != kFormat) {
        return std::nullopt;
    }
    header.program = fields[1];
    const bool read = read_number(fields[2], header.start_mm[0]) &&
                      read_number(fields[3], header.start_mm[1]) &&
                      read_number(fields[4], header.origin_mm[0]) &&
                      read_number(fields[5], header.origin_mm[1]) &&
                      read_number(fields[6], header.planner_blocks);
    return read ? std::optional(header) : std::nullopt;
}

std::optional<JournalRecord> read_record(const std::vector<std::string_view>& fields) {
    JournalRecord record;
    int end = 0;
    if (fields.size() != 6 || fields[0].size() != 1) {
        return std::nullopt;
    }
    const auto letter = std::find_if(kLetters.begin(), kLetters.end(),
                                     [&](const auto& each) { return each.second == fields[0][0]; });
    const bool read = letter != kLetters.end() && read_number(fields[1], record.t_s) &&
                      read_number(fields[2], record.lines) &&
                      read_number(fields[3], record.at_mm[0]) &&
                      read_number(fields[4], record.at_mm[1]) && read_number(fields[5], end);
    if (!read || end < 0 || end > static_cast<int>(BeamEnd::Silent)) {
        return std::nullopt;
    }
    record.kind = letter->first;
    record.end = static_cast<BeamEnd>(end);
    return record;
}

double distance(const Point& a, const Point& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1]);
}

// What a journal's records add up to.
struct Replay {
    BeamTracker tracker;
    const BeamPath& path;
    std::size_t may = 0;
    std::size_t sent = 0;
    double heard_s = 0.0;
    double report_s = 0.0;
    double report_every_s = 0.0;
    BeamEnd end = BeamEnd::Unknown;
    bool stands = false;  // Where it does, is known.
    bool kept = false;    // By the controller, too.

    Replay(const BeamPath& of, const TrackerOptions& options) : tracker(of, options), path(of) {}

    void take(const JournalRecord& record) {
        switch (record.kind) {
            case Kind::May:
                may = std::max(may, record.lines);
                break;
            case Kind::Sent:
                sent = std::max(sent, record.lines);
                tracker.sent(sent);
                break;
            case Kind::Acknowledged:
                tracker.acknowledged(record.lines, record.t_s);
                heard_s = record.t_s;
                break;
            case Kind::Position:
                // Nothing moves that was not sent: the wire is ahead of what is written down.
                tracker.sent(may);
                tracker.position(record.at_mm, record.t_s);
                heard_s = record.t_s;
                report_every_s = std::min(record.t_s - report_s, kSlowestReports);
                report_s = record.t_s;
                break;
            case Kind::End:
                end = record.end;
                tracker.sent(may);
                if (end == BeamEnd::Stands || end == BeamEnd::Stopped) {
                    stand(record, BeamTracker::Since::Heard);
                }
                break;
            case Kind::Found:
                tracker.sent(may);
                if (stands) {  // Known already: this only says whether the controller knows, too.
                    const Point at = path.point_at(tracker.heard().likely_mm);
                    kept = record.end == BeamEnd::Stands && distance(at, record.at_mm) < kSamePlace;
                } else {
                    stand(record, BeamTracker::Since::Alone);
                    // At the end of all that was sent: it went on alone, and was not stopped.
                    if (std::abs(tracker.heard().likely_mm - path.way_after(sent)) < kSamePlace) {
                        tracker.stands(record.at_mm);
                    }
                }
                break;
        }
    }

    void stand(const JournalRecord& record, BeamTracker::Since since) {
        const bool on_path = tracker.stands(record.at_mm, since);
        stands = stands || on_path;
        kept = on_path && record.end == BeamEnd::Stands;
    }
};

}  // namespace

std::string write_record(const JournalHeader& header) {
    return sealed(fmt::format("{} {} {:.4f} {:.4f} {:.4f} {:.4f} {}", kFormat,
                              header.program.empty() ? "-" : header.program, header.start_mm[0],
                              header.start_mm[1], header.origin_mm[0], header.origin_mm[1],
                              header.planner_blocks));
}

std::string write_record(const JournalRecord& record) {
    const auto letter = std::find_if(kLetters.begin(), kLetters.end(),
                                     [&](const auto& each) { return each.first == record.kind; });
    return sealed(fmt::format("{} {:.3f} {} {:.3f} {:.3f} {}", letter->second, record.t_s,
                              record.lines, record.at_mm[0], record.at_mm[1],
                              static_cast<int>(record.end)));
}

std::optional<Journal> read_journal(std::string_view text) {
    std::optional<Journal> journal;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        if (end == std::string_view::npos) {
            break;
        }
        const std::vector<std::string_view> fields = opened(text.substr(0, end));
        text.remove_prefix(end + 1);
        if (!journal) {
            const std::optional<JournalHeader> header = read_header(fields);
            if (!header) {
                break;
            }
            journal.emplace();
            journal->header = *header;
            continue;
        }
        const std::optional<JournalRecord> record = read_record(fields);
        if (!record) {
            break;
        }
        journal->records.push_back(*record);
    }
    return journal;
}

BeamKnowledge knowledge_of(const BeamPath& path, const Journal& journal) {
    TrackerOptions options;
    options.planner_blocks = journal.header.planner_blocks;
    Replay replay(path, options);
    for (const JournalRecord& record : journal.records) {
        replay.take(record);
    }
    const BeamTracker& tracker = replay.tracker;
    WayRange way = tracker.heard();
    if (!replay.stands) {
        // It stopped between its last word and the next that was due, or did all it had been sent.
        const double due_s =
            std::max(replay.heard_s, replay.report_s + replay.report_every_s + kReportDelay);
        const double stopped = tracker.reckoned_mm((replay.heard_s + due_s) / 2.0);
        const bool drains = replay.end == BeamEnd::Unknown || replay.end == BeamEnd::Silent;
        const double most = drains ? path.way_after(replay.may) : tracker.furthest_mm(due_s);
        way.most_mm = std::max(way.most_mm, most);
        way.likely_mm = replay.end == BeamEnd::Unknown ? path.way_after(replay.sent) : stopped;
        way.likely_mm = std::clamp(way.likely_mm, way.least_mm, way.most_mm);
    }
    BeamKnowledge known;
    known.least_mm = path.burnt_at(way.least_mm);
    known.likely_mm = path.burnt_at(way.likely_mm);
    known.most_mm = path.burnt_at(way.most_mm);
    known.total_mm = path.burn_mm();
    known.line = path.line_at(way.likely_mm);
    known.at_mm = path.point_at(way.likely_mm);
    known.position_kept = replay.kept;
    return known;
}

}  // namespace leafcutter::drivers
