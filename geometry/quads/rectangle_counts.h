// How many cells the rectangles of a one-form have, so that they meet cell by cell: columns of each
// rectangle, rows of each band of connected leaves of F.
//
// Rows match along sides if every zero lies between rows: so bands, which end at zeros, have whole
// numbers of them. Columns never go on from one rectangle into another, so theirs are free, but
// for colours: those alternate everywhere if the columns round every loop are an even number.

#pragma once

#include <string>
#include <vector>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/critical_sides.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/spacing.h"

namespace leafcutter::geometry {

struct RectangleWish {
    double cells = 1.0;              // On all rectangles.
    std::vector<RowsCols> counts;    // Per cylinder of the foliation: fixed ones,
    std::vector<std::string> paths;  // and where they stand in the job's parameters.
    Parity parity = Parity::Even;
};

struct RectangleCounts {
    std::vector<int> cols;  // Per cylinder.
    std::vector<int> rows;  // Per band; 0 where the zeros at its ends share a row.
    double cells = 0.0;
    int tightest = -1;  // The cylinder with most columns for its width.
};

constexpr int kAnyParity = -1;

// The nearest whole number of one parity, in proportion.
int nearest_count(double ideal, int least, int parity);

// How far a count is from the ideal one: the square of the difference of logarithms.
double count_misfit(int count, double ideal);

class RectangleCounter {
public:
    // Keeps both by reference.
    RectangleCounter(const Foliation& foliation, const SideNetwork& network, RectangleWish wish);

    double wanted_cells() const { return wanted_; }
    bool has_fixed_counts() const { return fixed_; }

    // About so many cells, as square as they come out.
    // Throws Error(BadOption) naming the counts that can't be had.
    RectangleCounts choose(double cells, const Context& context) const;

    // Levels of f, from zero to zero, that part a band into so many strips evenly wide.
    std::vector<double> band_levels(int band, int rows) const;

private:
    struct Scored {
        RectangleCounts counts;
        double score = 0.0;
    };

    void set_wanted();
    void find_mergeable();
    void set_least_rows();
    void set_cols(RectangleCounts& counts, double size) const;
    void widen_rings(RectangleCounts& counts, double size) const;
    void set_rows(RectangleCounts& counts, double size, const Context& context) const;
    void set_free_rows(RectangleCounts& counts, double size) const;
    void set_fixed_rows(RectangleCounts& counts, double size, const Context& context) const;
    void adjust_rows(Scored& found, double size, double cells) const;
    double score(const RectangleCounts& counts, double size, double cells) const;
    double cells_of(const RectangleCounts& counts) const;
    double strain(const RectangleCounts& counts, double size) const;
    void check_fixed(const RectangleCounts& counts) const;

    const Foliation& foliation_;
    const SideNetwork& network_;
    RectangleWish wish_;
    std::vector<double> width_;      // Per cylinder, mm on the surface in the mean.
    std::vector<LevelScale> scale_;  // Per band.
    std::vector<double> low_;        // Per band its lowest f,
    std::vector<double> high_;       // and its highest.
    std::vector<char> mergeable_;    // Per band whether it may have no rows,
    std::vector<int> least_rows_;    // and how many it has at least, if any.
    double wanted_ = 1.0;
    bool fixed_ = false;
    bool fixed_rows_ = false;
};

}  // namespace leafcutter::geometry
