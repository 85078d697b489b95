// Records that the store keeps by name and never looks into: materials that were added or changed
// here, presets. Each is JSON.

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace leafcutter::server {

struct NamedRecord {
    std::string id;
    std::string json;
};

class NamedRecords {
public:
    virtual ~NamedRecords() = default;

    // By id.
    virtual std::vector<NamedRecord> list() const = 0;
    virtual std::optional<NamedRecord> find(const std::string& id) const = 0;

    // True if there was none of that id.
    virtual bool put(const NamedRecord& record) = 0;

    // All or, if one fails, none.
    virtual void put_all(const std::vector<NamedRecord>& records) = 0;

    // False if there is none.
    virtual bool remove(const std::string& id) = 0;
};

// The JSON of each.
std::vector<std::string> texts_of(const std::vector<NamedRecord>& records);

}  // namespace leafcutter::server
