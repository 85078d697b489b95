// All rows of one database into another, of whatever kind.

#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace leafcutter::server {

class SqlDatabase;

// Nothing was copied; the message says why.
class CopyRefused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct CopiedTable {
    std::string name;
    std::int64_t rows = 0;
};

// In one transaction, compared row by row before it ends. What somebody held a lease of is then
// free: jobs that were being computed go back to the queue when a daemon starts. Nobody may work
// with either meanwhile. Throws CopyRefused if `to` holds anything, or reads back differently;
// StoreError.
std::vector<CopiedTable> copy_all_rows(const SqlDatabase& from, SqlDatabase& to);

}  // namespace leafcutter::server
