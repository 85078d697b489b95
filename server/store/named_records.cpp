#include "server/store/named_records.h"

#include <algorithm>
#include <iterator>

namespace leafcutter::server {

std::vector<std::string> texts_of(const std::vector<NamedRecord>& records) {
    std::vector<std::string> texts;
    texts.reserve(records.size());
    std::transform(records.begin(), records.end(), std::back_inserter(texts),
                   [](const NamedRecord& record) { return record.json; });
    return texts;
}

}  // namespace leafcutter::server
