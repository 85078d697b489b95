// The rows of settings, as the store's parts read and change them.

#pragma once

#include <optional>
#include <string>

namespace leafcutter::server {

class SqlSession;

std::optional<std::string> setting(SqlSession& session, const std::string& key);
void set_setting(SqlSession& session, const std::string& key, const std::string& value);
void forget_setting(SqlSession& session, const std::string& key);

}  // namespace leafcutter::server
