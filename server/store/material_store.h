// Materials that were added or changed here, each as the JSON of its record.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::server {

class Database;

class MaterialStore {
public:
    explicit MaterialStore(Database& database) : database_(database) {}

    // By id.
    std::vector<std::string> records() const;

    // True if there was none of that id.
    bool put(const std::string& id, const std::string& record_json);

    // False if there is none.
    bool remove(const std::string& id);

private:
    Database& database_;
};

}  // namespace leafcutter::server
