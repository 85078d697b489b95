// Addresses of machines and names of faults, as they are typed: anything but std::invalid_argument
// is a finding.

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "drivers/device.h"
#include "drivers/lihuiyu/address.h"
#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/faulty_wire.h"
#include "drivers/sim/lihuiyu_transport.h"

namespace {

template <typename Read>
void try_to(const Read& read) {
    try {
        read();
    } catch (const std::invalid_argument&) {
        return;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace leafcutter::drivers;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    is_device_uri(text);
    try_to([text] { parse_lihuiyu_address(text); });
    try_to([text] { parse_simulated_lihuiyu(text); });
    try_to([text] { parse_fault(text); });
    try_to([text] { parse_faults(text); });
    try_to([text] { parse_wire_fault(text); });
    try_to([text] { parse_lihuiyu_fault(text); });
    return 0;
}
