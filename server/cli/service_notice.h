// Words to the service manager that started us, if one did (sd_notify's protocol).

#pragma once

#include <string_view>

namespace leafcutter::server {

// "READY=1", "STOPPING=1". Nothing happens without $NOTIFY_SOCKET.
void notify_service_manager(std::string_view state);

}  // namespace leafcutter::server
