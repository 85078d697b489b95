// What an administrator set at run time, by key; the values are JSON.

#pragma once

#include <optional>
#include <string>

namespace leafcutter::server {

class Settings {
public:
    virtual ~Settings() = default;

    // Nothing if it was never set.
    virtual std::optional<std::string> get(const std::string& key) const = 0;
    virtual void put(const std::string& key, const std::string& json) = 0;

    // False, and nothing is changed, if it is no longer `expected`.
    virtual bool replace(const std::string& key,
                         const std::string& expected,
                         const std::string& json) = 0;
    virtual void remove(const std::string& key) = 0;
};

}  // namespace leafcutter::server
