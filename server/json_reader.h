// Reads a JSON object strictly: every key must be known, every value of its type and in its range.
//
// What is wrong is refused by its full path: "grid.strip_width_mm: must be > 0".

#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace leafcutter::server {

// Both ends belong to the range unless `above_low`.
struct Range {
    double low = 0.0;
    double high = 1e9;
    bool above_low = false;
};

inline constexpr double kLargestLengthMm = 100'000.0;
inline constexpr Range kPositiveLength{0.0, kLargestLengthMm, true};

// Throws geometry::Error(BadOption) saying "path: problem".
[[noreturn]] void refuse_param(const std::string& path, const std::string& problem);

// Throws geometry::Error(NotSupported) saying "path: not supported yet: what".
[[noreturn]] void refuse_unsupported(const std::string& path, const std::string& what);

double read_number(const nlohmann::json& value, const std::string& path, const Range& range);
int read_integer(const nlohmann::json& value, const std::string& path, const Range& range);
std::string read_text(const nlohmann::json& value, const std::string& path);
std::vector<int> read_integers(const nlohmann::json& value, const std::string& path);

class ObjectReader {
public:
    // `object` must outlive the reader; `path` is empty for the outermost object.
    ObjectReader(const nlohmann::json& object, std::string path);

    // The value of `key`, null if it is absent. The key counts as known from now on.
    const nlohmann::json* get(std::string_view key);
    std::string path_of(std::string_view key) const;

    void number(std::string_view key, double& target, const Range& range);
    void integer(std::string_view key, int& target, const Range& range);
    void boolean(std::string_view key, bool& target);
    void text(std::string_view key, std::string& target);

    template <typename Value>
    struct Choice {
        std::string_view name;
        Value value;
    };
    template <typename Value>
    void choice(std::string_view key, Value& target, std::span<const Choice<Value>> choices);

    // Calls read with the reader of a nested object, if there is one.
    void object(std::string_view key, const std::function<void(ObjectReader&)>& read);

    // Refuses keys that nobody asked for.
    void finish() const;

private:
    const nlohmann::json& object_;
    std::string path_;
    std::set<std::string, std::less<>> known_;
};

template <typename Value>
void ObjectReader::choice(std::string_view key,
                          Value& target,
                          std::span<const Choice<Value>> choices) {
    const nlohmann::json* value = get(key);
    if (value == nullptr) {
        return;
    }
    // A name that looks like a number ("0") arrives as one from --set.
    const std::string name = value->is_number() ? value->dump() : read_text(*value, path_of(key));
    std::string known;
    for (const Choice<Value>& choice : choices) {
        if (choice.name == name) {
            target = choice.value;
            return;
        }
        known += (known.empty() ? "" : ", ") + std::string(choice.name);
    }
    refuse_param(path_of(key), "must be one of " + known);
}

}  // namespace leafcutter::server
