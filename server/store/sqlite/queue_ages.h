// The ages of queues, in SQLite.

#pragma once

#include "server/store/queue_ages.h"

namespace leafcutter::server {

class Database;

QueueAges queue_ages_of(const Database& database);

}  // namespace leafcutter::server
