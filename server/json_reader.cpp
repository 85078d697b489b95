#include "server/json_reader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::server {

namespace {

void check_range(double number, const std::string& path, const Range& range) {
    if (!std::isfinite(number)) {
        refuse_param(path, "must be finite");
    }
    if (range.above_low ? number <= range.low : number < range.low) {
        refuse_param(path, fmt::format("must be {} {:g}", range.above_low ? ">" : ">=", range.low));
    }
    if (number > range.high) {
        refuse_param(path, fmt::format("must be <= {:g}", range.high));
    }
}

}  // namespace

void refuse_param(const std::string& path, const std::string& problem) {
    throw geometry::Error(geometry::ErrorKind::BadOption, "bad-parameter", path + ": " + problem);
}

void refuse_unsupported(const std::string& path, const std::string& what) {
    throw geometry::Error(geometry::ErrorKind::NotSupported, "not-supported",
                          path + ": not supported yet: " + what);
}

double read_number(const nlohmann::json& value, const std::string& path, const Range& range) {
    if (!value.is_number()) {
        refuse_param(path, "must be a number");
    }
    const double number = value.get<double>();
    check_range(number, path, range);
    return number;
}

int read_integer(const nlohmann::json& value, const std::string& path, const Range& range) {
    if (!value.is_number_integer()) {
        refuse_param(path, "must be a whole number");
    }
    check_range(value.get<double>(), path, {range.low, std::min(range.high, 2147483647.0), false});
    return value.get<int>();
}

std::string read_text(const nlohmann::json& value, const std::string& path) {
    if (!value.is_string()) {
        refuse_param(path, "must be text");
    }
    return value.get<std::string>();
}

std::vector<int> read_integers(const nlohmann::json& value, const std::string& path) {
    if (!value.is_array()) {
        refuse_param(path, "must be a list of whole numbers");
    }
    std::vector<int> numbers;
    for (std::size_t i = 0; i < value.size(); ++i) {
        numbers.push_back(read_integer(value[i], fmt::format("{}[{}]", path, i), {}));
    }
    return numbers;
}

ObjectReader::ObjectReader(const nlohmann::json& object, std::string path)
    : object_(object), path_(std::move(path)) {
    if (!object_.is_object()) {
        refuse_param(path_.empty() ? "parameters" : path_, "must be an object");
    }
}

const nlohmann::json* ObjectReader::get(std::string_view key) {
    known_.emplace(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
}

std::string ObjectReader::path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void ObjectReader::number(std::string_view key, double& target, const Range& range) {
    if (const nlohmann::json* value = get(key)) {
        target = read_number(*value, path_of(key), range);
    }
}

void ObjectReader::integer(std::string_view key, int& target, const Range& range) {
    if (const nlohmann::json* value = get(key)) {
        target = read_integer(*value, path_of(key), range);
    }
}

void ObjectReader::boolean(std::string_view key, bool& target) {
    if (const nlohmann::json* value = get(key)) {
        if (!value->is_boolean()) {
            refuse_param(path_of(key), "must be true or false");
        }
        target = value->get<bool>();
    }
}

void ObjectReader::text(std::string_view key, std::string& target) {
    if (const nlohmann::json* value = get(key)) {
        target = read_text(*value, path_of(key));
    }
}

void ObjectReader::object(std::string_view key, const std::function<void(ObjectReader&)>& read) {
    if (const nlohmann::json* value = get(key)) {
        ObjectReader reader(*value, path_of(key));
        read(reader);
        reader.finish();
    }
}

void ObjectReader::finish() const {
    for (const auto& item : object_.items()) {
        if (!known_.contains(item.key())) {
            refuse_param(path_of(item.key()), "unknown key");
        }
    }
}

}  // namespace leafcutter::server
