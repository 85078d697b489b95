// How hot a sheet is where the beam cuts, and orders that keep it cooler.
//
// Each mm of cut leaves heat that spreads over `reach_mm` and decays with `decay_s`:
//   Q(x, t) = Σ ds / (√(2π) reach) · exp(−(t − t_i) / decay) · exp(−d² / 2 reach²)
// so that Q is 1 on a long straight line that has just been cut. The heat index of a path is the
// largest Q that other paths have left where and when the beam comes by.

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

struct HeatOptions {
    double decay_s = 8.0;
    double reach_mm = 5.0;
    double burn_mm_per_s = 15.0;
    double travel_mm_per_s = 100.0;
};

// What a material's sheet does: it loses its heat through both faces to the air.
HeatOptions cooling_of(const Material& material, const MachineProfile& machine);

// Where a path comes in the order, and how it is run.
struct OrderedPath {
    std::size_t path = 0;
    double start_mm = 0.0;  // Of a closed path, along its points as they are given.
    bool backward = false;  // From its other end, or the other way round.
};

// Paths of one sheet and what heat they bring each other. Spans of places and times hold one for
// each path, by its number.
class HeatModel {
public:
    HeatModel(const std::vector<CutPath>& paths, const HeatOptions& options);

    // Where the beam comes to a path and where it leaves it.
    Eigen::Vector2d entry(const OrderedPath& place) const;
    Eigen::Vector2d exit(const OrderedPath& place) const;
    bool closed(std::size_t path) const { return closed_[path] != 0; }

    // Paths that bring the path heat, or get some of it.
    const std::vector<std::size_t>& near(std::size_t path) const { return near_[path]; }

    // When each path is begun, the beam coming from `from`.
    std::vector<double> begins_s(std::span<const OrderedPath> order,
                                 const Eigen::Vector2d& from) const;

    // The heat index of a path that is begun then.
    double index(const OrderedPath& place,
                 double begin_s,
                 std::span<const OrderedPath> places,
                 std::span<const double> begins_s) const;

    // The largest of all.
    double peak(std::span<const OrderedPath> order, const Eigen::Vector2d& from) const;

private:
    struct Sample {
        Eigen::Vector2d point;
        double at_mm = 0.0;
        double mm = 0.0;
        std::size_t path = 0;
    };
    struct Exchange {  // What a sample gets from one of another path that has just been cut.
        std::uint32_t path = 0;
        float at_mm = 0.0F;
        float heat = 0.0F;
    };
    double burn_s(std::size_t path) const { return length_mm_[path] / options_.burn_mm_per_s; }
    double time_in(const OrderedPath& place, double at_mm) const;
    void find_exchanges(const std::vector<Sample>& samples);

    HeatOptions options_;
    std::vector<Polyline> points_;
    std::vector<std::vector<double>> stations_;
    std::vector<double> length_mm_;
    std::vector<char> closed_;
    std::vector<std::size_t> first_sample_;  // Of each path, and one past the last.
    std::vector<double> sample_at_mm_;
    std::vector<std::size_t> first_exchange_;  // Of each sample, and one past the last.
    std::vector<Exchange> exchanges_;
    std::vector<std::vector<std::size_t>> near_;
};

}  // namespace leafcutter::fab
