// Cuts in SQL.

#pragma once

#include "server/store/cut_store.h"
#include "server/store/fleet_store.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlCutStore final : public CutStore {
public:
    SqlCutStore(SqlDatabase& database, const NodeScope& scope)
        : database_(database), scope_(scope) {}

    using CutStore::add;
    std::vector<CutRecord> add(const std::string& job,
                               const std::vector<CutWish>& wishes,
                               const std::optional<IdempotencyKey>& key) override;
    std::optional<CutRecord> find(const std::string& id) const override;
    std::vector<CutRecord> list(int limit,
                                std::optional<std::int64_t> below_ordinal) const override;
    std::vector<CutRecord> open_on(const std::string& device) const override;
    bool move(const std::string& id,
              CutState from,
              CutState to,
              const std::string& reason) override;
    bool arm(const CutRecord& cut) override;
    bool begin_sheet(const CutRecord& cut) override;
    bool finish_sheet(const CutRecord& cut, const CutProgress& progress) override;
    void record_progress(const std::string& id, const CutProgress& progress) override;
    void record_beam(const std::string& id, const BeamRecord& beam) override;
    bool may_be_finished(const CutRecord& cut) const override;
    std::optional<CutRecord> add_rest(const CutRecord& of,
                                      const std::string& program_sha256) override;
    std::optional<CutRecord> last_begun_on(const std::string& device) const override;
    std::int64_t count(CutState state) const override;
    bool reclaim(const CutRecord& in_work) override;
    std::vector<CutRecord> in_hand() const override;
    std::vector<std::string> recover() override;

private:
    SqlDatabase& database_;
    const NodeScope scope_;
};

}  // namespace leafcutter::server
