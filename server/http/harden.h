// What every answer says to browsers.

#pragma once

#include "server/http/response.h"

namespace leafcutter::server {

// Adds headers; those that a handler set stay.
void harden(Response& response);

}  // namespace leafcutter::server
