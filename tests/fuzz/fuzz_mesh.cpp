// Feeds bytes to one mesh reader (FUZZ_FILE_NAME chooses it) and what it reads to repair and
// topology. Any exception but the typed one is a finding, as is a single allocation above 256 MB:
// the limits of the readers must hold before memory is asked for.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <span>

#include "geometry/error.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "geometry/topology.h"

namespace {

constexpr std::size_t kLargestAllocation = std::size_t{256} << 20U;

}  // namespace

void* operator new(std::size_t size) {
    void* memory = size <= kLargestAllocation ? std::malloc(size) : nullptr;
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    return memory;
}

// Of the same heap as the deletes below.
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
    return size <= kLargestAllocation ? std::malloc(size) : nullptr;
}

void operator delete(void* memory) noexcept {
    std::free(memory);
}

void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace leafcutter::geometry;
    try {
        const PolygonSoup soup =
            read_mesh(std::as_bytes(std::span(data, size)), FUZZ_FILE_NAME, ReadLimits());
        for (const std::uint32_t corner : soup.corners) {
            if (corner >= soup.positions.size()) {
                std::abort();
            }
        }
        const RepairedMesh repaired = repair(soup);
        const Topology topology = analyse_topology(repaired.mesh);
        if (topology.faces == 0 || topology.genus < 0) {
            std::abort();
        }
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::SelfCheck) {
            std::abort();
        }
    }
    return 0;
}
