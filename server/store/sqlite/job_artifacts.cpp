// The part of JobStore that knows a job's files.

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/database.h"
#include "server/store/sqlite/jobs.h"

namespace leafcutter::server {

namespace {

ArtifactRecord artifact_from(SQLite::Statement& row) {
    return {row.getColumn(0).getString(), row.getColumn(1).getInt64(), row.getColumn(2).getString(),
            row.getColumn(3).getString()};
}

}  // namespace

std::vector<ArtifactRecord> SqliteJobStore::artifacts(const std::string& job) const {
    std::vector<ArtifactRecord> found;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(
            database,
            "SELECT path, bytes, sha256, media_type FROM artifact WHERE job = ? ORDER BY position");
        query.bind(1, job);
        while (query.executeStep()) {
            found.push_back(artifact_from(query));
        }
    });
    return found;
}

std::optional<ArtifactRecord> SqliteJobStore::artifact(const std::string& job,
                                                       const std::string& path) const {
    std::optional<ArtifactRecord> found;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(
            database,
            "SELECT path, bytes, sha256, media_type FROM artifact WHERE job = ? AND path = ?");
        query.bind(1, job);
        query.bind(2, path);
        if (query.executeStep()) {
            found = artifact_from(query);
        }
    });
    return found;
}

bool SqliteJobStore::refers_to_blob(const std::string& sha256) const {
    bool found = false;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                "SELECT EXISTS(SELECT 1 FROM artifact WHERE sha256 = ?1) "
                                "OR EXISTS(SELECT 1 FROM job WHERE file_sha256 = ?1) "
                                "OR EXISTS(SELECT 1 FROM cut WHERE rest_sha256 = ?1)");
        query.bind(1, sha256);
        found = query.executeStep() && query.getColumn(0).getInt() != 0;
    });
    return found;
}

}  // namespace leafcutter::server
