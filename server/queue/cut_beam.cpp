#include "server/queue/cut_beam.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "drivers/burn/remainder.h"
#include "drivers/grbl/program.h"

namespace leafcutter::server {

namespace {

using drivers::BeamEnd;
using drivers::JournalRecord;
using drivers::Point;
using namespace std::chrono_literals;

std::filesystem::path journal_of(const Store& store, const CutRecord& cut) {
    return store.folder.path() / "journals" / fmt::format("{}-{}", cut.id, cut.position);
}

drivers::JournalHeader header_of(const CutRecord& cut, const drivers::DeviceStatus& status) {
    drivers::JournalHeader header;
    header.program = cut.program_sha256;
    header.start_mm = {status.work_position_mm[0], status.work_position_mm[1]};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        header.origin_mm[axis] = status.machine_position_mm[axis] - status.work_position_mm[axis];
    }
    header.planner_blocks = status.planner_blocks;
    return header;
}

BeamRecord record_of(const drivers::BeamKnowledge& known) {
    BeamRecord record;
    record.least_mm = known.least_mm;
    record.likely_mm = known.best_mm();
    record.most_mm = known.most_mm;
    record.total_mm = known.total_mm;
    record.line = static_cast<int>(known.line) + 1;
    record.at_mm = known.at_mm;
    record.certain = known.certain();
    record.position_kept = known.position_kept;
    return record;
}

}  // namespace

CutBeam::CutBeam(const Store& store,
                 const CutRecord& cut,
                 std::string_view program,
                 const drivers::DeviceStatus& status)
    : file_(journal_of(store, cut)) {
    const drivers::JournalHeader header = header_of(cut, status);
    path_ = std::make_shared<drivers::BeamPath>(program, header.start_mm);
    std::filesystem::create_directories(file_.parent_path());
    journal_ = std::make_shared<drivers::JournalFile>(file_, header);
    const auto begun = std::chrono::steady_clock::now();
    follower_ = std::make_shared<drivers::BeamFollower>(
        path_, journal_,
        [begun] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        },
        header.planner_blocks);
}

std::string CutBeam::trouble() const {
    constexpr std::size_t kReports = 3;
    if (journal_->failed()) {
        return "the disk takes no journal of the cut: make room, or look at the disk";
    }
    if (follower_->astray() >= kReports) {
        return "the head is not where the program leads: a line was garbled on its way";
    }
    return {};
}

bool CutBeam::has_settled(const drivers::DeviceStatus& status) {
    constexpr std::size_t kReports = 2;
    constexpr auto kPatience = 3s;
    const auto now = std::chrono::steady_clock::now();
    if (!over_since_) {
        over_since_ = now;
        reports_ = status.reports;
    }
    return status.reports == 0 || status.state == drivers::MachineState::Disconnected ||
           status.reports >= reports_ + kReports || now - *over_since_ > kPatience;
}

BeamRecord CutBeam::close(const drivers::JobProgress& progress,
                          const drivers::DeviceStatus& status) {
    follower_->end(progress, status);
    journal_->finish();
    const auto journal = drivers::load_journal(file_);
    return journal ? record_of(drivers::knowledge_of(*path_, *journal)) : BeamRecord{};
}

std::optional<BeamRecord> read_beam(const Store& store, const CutRecord& cut) {
    const auto journal = drivers::load_journal(journal_of(store, cut));
    if (!journal) {
        return std::nullopt;
    }
    const drivers::BeamPath path(store.blobs.read(cut.program_sha256), journal->header.start_mm);
    return record_of(drivers::knowledge_of(path, *journal));
}

std::optional<std::array<double, 2>> origin_of_cut(const Store& store, const CutRecord& cut) {
    const auto journal = drivers::load_journal(journal_of(store, cut));
    return journal ? std::optional(journal->header.origin_mm) : std::nullopt;
}

void note_found(Store& store, const std::string& device, const drivers::DeviceStatus& status) {
    const std::optional<CutRecord> cut = store.cuts.last_begun_on(device);
    if (!cut || !cut->beam || status.reports == 0 || !store.cuts.may_be_finished(*cut)) {
        return;
    }
    // A controller that was switched on again takes the place where it stands for its zero.
    const bool fresh = status.machine_position_mm == std::array<double, 3>{};
    const bool locked = status.state == drivers::MachineState::Alarm;
    BeamRecord beam = *cut->beam;
    beam.position_kept = false;
    if (!fresh) {
        drivers::append_record(journal_of(store, *cut),
                               {.kind = JournalRecord::Kind::Found,
                                .at_mm = {status.work_position_mm[0], status.work_position_mm[1]},
                                .end = locked ? BeamEnd::Stopped : BeamEnd::Stands});
        beam = read_beam(store, *cut).value_or(beam);
    }
    store.cuts.record_beam(cut->id, beam);
}

void assess_interrupted(Store& store) {
    for (const std::string& device : store.interrupted_devices) {
        const std::optional<CutRecord> cut = store.cuts.last_begun_on(device);
        if (!cut || cut->state != CutState::Interrupted || cut->beam) {
            continue;
        }
        try {
            if (const std::optional<BeamRecord> beam = read_beam(store, *cut)) {
                store.cuts.record_beam(cut->id, *beam);
            }
        } catch (const std::exception& error) {
            spdlog::warn("cut {}: nothing is known of its beam: {}", cut->id, error.what());
        }
    }
}

std::string rest_program(const Store& store, const CutRecord& cut, double burnt_mm) {
    drivers::RemainderOptions options;
    if (const auto journal = drivers::load_journal(journal_of(store, cut))) {
        options.start_mm = journal->header.start_mm;
    }
    return drivers::remainder_program(store.blobs.read(cut.program_sha256), burnt_mm, options);
}

void forget_beam(const Store& store, const CutRecord& cut) {
    std::error_code ignored;
    std::filesystem::remove(journal_of(store, cut), ignored);
}

}  // namespace leafcutter::server
