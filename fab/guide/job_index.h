// Looks up what a guide needs to know about a job's strips and pieces.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fab/job_result.h"
#include "geometry/quads/quad_edges.h"

namespace leafcutter::fab::guide {

// Refers to the job, which must outlive it.
class JobIndex {
public:
    explicit JobIndex(const JobResult& job);

    const JobResult& job() const { return job_; }
    const Piece* piece(const std::string& id) const;  // Null if there is none.
    std::optional<int> strip(const std::string& id) const;
    std::optional<int> sheet_of(const std::string& piece) const;

    // Of the strips' list; -1: none.
    int strip_at(int quad, Family family) const;
    int region_of(int quad) const { return region_of_.at(static_cast<std::size_t>(quad)); }
    const geometry::QuadNeighbours& neighbours() const { return neighbours_; }

    // The quads of a piece in walking order.
    std::vector<int> quads_of(const Piece& piece) const;

    // "row 5 of 24", "column 3 of 42": where in its cylinder a strip begins.
    std::string place_of(int strip) const;

private:
    const JobResult& job_;
    std::map<std::string, const Piece*> pieces_;
    std::map<std::string, int> strips_;
    std::map<std::string, int> sheets_;
    std::vector<int> weft_at_;
    std::vector<int> warp_at_;
    std::vector<int> region_of_;
    geometry::QuadNeighbours neighbours_;
};

}  // namespace leafcutter::fab::guide
