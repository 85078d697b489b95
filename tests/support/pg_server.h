// A PostgreSQL of the test's own: started at the first use, stopped with the process. It listens on
// a socket in a folder of its own and nowhere else.

#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include "tests/support/temp_dir.h"

namespace leafcutter::test {

class PgServer {
public:
    // Debian's packages.
    static bool is_installed() { return std::filesystem::exists(binaries() + "/initdb"); }

    static PgServer& shared() {
        static PgServer server;
        return server;
    }

    PgServer() {
        std::filesystem::permissions(folder_.path(), std::filesystem::perms::all);
        const std::string data = (folder_.path() / "data").string();
        run(binaries() + "/initdb -D " + data + " -A trust -U leafcutter -E UTF8 --locale=C");
        run(binaries() + "/pg_ctl -D " + data + " -w -l " + (folder_.path() / "log").string() +
            " -o \"-c listen_addresses='' -c max_connections=200 -k " + folder_.path().string() +
            "\" start");
    }
    ~PgServer() {
        const std::string data = (folder_.path() / "data").string();
        std::system(as_user(binaries() + "/pg_ctl -D " + data + " -m immediate stop").c_str());
    }
    PgServer(const PgServer&) = delete;
    PgServer& operator=(const PgServer&) = delete;

    // Tables of that name's own. Letters, digits and _ only.
    std::string uri(const std::string& space) const {
        return "postgresql://leafcutter@/postgres?host=" + folder_.path().string() +
               "&options=-csearch_path%3D" + space;
    }
    void create_space(const std::string& space) {
        run("psql -q -h " + folder_.path().string() +
            " -U leafcutter -d postgres -c \"CREATE SCHEMA IF NOT EXISTS " + space + "\"");
    }

private:
    static std::string binaries() { return "/usr/lib/postgresql/15/bin"; }

    // The server refuses to run as root.
    static std::string as_user(const std::string& command) {
        const std::string quiet = " >/dev/null 2>&1";
        return geteuid() == 0
                   ? "cd / && setpriv --reuid=postgres --regid=postgres --clear-groups " + command +
                         quiet
                   : command + quiet;
    }
    static void run(const std::string& command) {
        if (std::system(as_user(command).c_str()) != 0) {
            throw std::runtime_error("failed: " + command);
        }
    }

    TempDir folder_;
};

}  // namespace leafcutter::test
