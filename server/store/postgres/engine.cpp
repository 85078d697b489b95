#include "server/store/postgres/engine.h"

#include <system_error>
#include <utility>

#include "server/store/durable_file.h"
#include "server/store/sql/copy.h"
#include "server/store/sql/tables.h"
#include "server/store/sqlite/database.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

class PgEngine final : public SqlTables {
public:
    PgEngine(std::unique_ptr<PgDatabase> database, const NodeScope& scope)
        : SqlTables(*database, scope), database_(std::move(database)) {}

    const LatencyHistogram* commit_latency() const override { return &database_->commit_latency(); }
    std::string trouble() const override { return database_->trouble(); }
    SqlDatabase& rows() override { return *database_; }
    void pass_on(const std::string& key, const std::string& text) override {
        database_->pass_on(key, text);
    }

    // The server looks after its own files: see its data checksums and amcheck.
    std::string check() const override { return {}; }

    // As a database of a daemon alone: it can be looked into, and copied back.
    void back_up_to(const fs::path& file) const override;

private:
    std::unique_ptr<PgDatabase> database_;
};

void PgEngine::back_up_to(const fs::path& file) const {
    const fs::path part = file.string() + ".part";
    try {
        fs::remove(part);
        {
            Database copy(part, [] {});
            copy_all_rows(*database_, copy);
        }
        sync_file(part);
        rename_durably(part, file);
    } catch (const CopyRefused& error) {
        throw StoreError(StoreTrouble::Failed, error.what());
    } catch (const std::system_error& error) {
        throw StoreError(StoreTrouble::Failed, error.what());
    }
}

}  // namespace

OpenedEngine open_postgres(const std::string& uri, const NodeScope& scope, PgHooks hooks) {
    OpenedEngine opened;
    opened.engine =
        std::make_unique<PgEngine>(std::make_unique<PgDatabase>(uri, std::move(hooks)), scope);
    return opened;
}

}  // namespace leafcutter::server
