// The part of JobStore that knows a job's files.

#include "server/store/sql/jobs.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

ArtifactRecord artifact_from(SqlStatement& row) {
    return {row.column(0).text(), row.column(1).int64(), row.column(2).text(),
            row.column(3).text()};
}

}  // namespace

std::vector<ArtifactRecord> SqlJobStore::artifacts(const std::string& job) const {
    std::vector<ArtifactRecord> found;
    database_.read([&](SqlSession& session) {
        SqlStatement query(
            session,
            "SELECT path, bytes, sha256, media_type FROM artifact WHERE job = ? ORDER BY position");
        query.bind(1, job);
        while (query.step()) {
            found.push_back(artifact_from(query));
        }
    });
    return found;
}

std::optional<ArtifactRecord> SqlJobStore::artifact(const std::string& job,
                                                    const std::string& path) const {
    std::optional<ArtifactRecord> found;
    database_.read([&](SqlSession& session) {
        SqlStatement query(
            session,
            "SELECT path, bytes, sha256, media_type FROM artifact WHERE job = ? AND path = ?");
        query.bind(1, job);
        query.bind(2, path);
        if (query.step()) {
            found = artifact_from(query);
        }
    });
    return found;
}

bool SqlJobStore::refers_to_blob(const std::string& sha256) const {
    bool found = false;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session,
                           "SELECT EXISTS(SELECT 1 FROM artifact WHERE sha256 = ?1) "
                           "OR EXISTS(SELECT 1 FROM job WHERE file_sha256 = ?1) "
                           "OR EXISTS(SELECT 1 FROM cut WHERE rest_sha256 = ?1)");
        query.bind(1, sha256);
        found = query.step() && query.column(0).integer() != 0;
    });
    return found;
}

}  // namespace leafcutter::server
