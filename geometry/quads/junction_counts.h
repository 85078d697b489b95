// How many cells: along every critical arc, and rows in every cylinder, so that columns go on from
// one cylinder into the next.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/integer_program.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

struct JunctionWish {
    double cells = 1.0;              // Of all cylinders in the network, where counts leave it open.
    std::vector<RowsCols> counts;    // Per cylinder of the foliation: fixed ones,
    std::vector<std::string> paths;  // and their names in the job's parameters.
    Parity parity = Parity::Even;
    int period = 2;  // Columns round a cylinder are a multiple of it, with Parity::Even.
};

struct JunctionCounts {
    std::vector<int> arc_cells;   // Per arc.
    std::vector<int> rows;        // Per cylinder of the foliation; 0 for those outside, and for
                                  // thin ones that are left out: their ends are joined.
    std::vector<int> least_rows;  // Per cylinder: fewer would double edges.
    std::vector<int> cols;
    // Levels of rows, where a cylinder has other than evenly wide ones.
    std::vector<std::vector<double>> f_levels;
    std::vector<int> twist;    // Columns by which the upper end's first vertex is aside.
    std::vector<double> slip;  // By how many columns a leaf of F* is off at the other end.
    int cells = 0;
    int misfits = 0;          // Cylinders whose fixed rows have the wrong parity.
    bool proven = true;       // No other numbers on arcs suit their lengths better.
    int tightest = -1;        // The cylinder with most cells beyond its share.
    double distortion = 0.0;  // Mean square slant and stretch of cells, about; less is better.
};

// Along the end's vertices the number of columns from the first; the last is the circumference.
std::vector<double> column_positions(const CylinderEnd& end, const std::vector<int>& arc_cells);

class JunctionCounter {
public:
    // Refers to both, which must outlive it.
    JunctionCounter(const Foliation& foliation, const ArcNetwork& network, JunctionWish wish);

    // The counts that distort least, of about `cells` cells in all: scans sizes near that, as all
    // rows jump together.
    // Throws Error(BadOption) if fixed counts don't fit together.
    JunctionCounts choose(double cells, const Context& context) const;

    // The number of cells asked for, by size or by fixed counts.
    double wanted_cells() const { return wanted_; }
    bool has_fixed_counts() const { return fixed_; }

private:
    struct Scored {
        JunctionCounts counts;
        double score = 0.0;
    };
    using Parities = std::vector<std::optional<int>>;  // Per cylinder; none where it is free.

    // Whether cells are to alternate in two colours.
    bool has_colours() const { return wish_.parity == Parity::Even && wish_.period % 2 == 0; }
    void set_wanted();
    IntegerProgram make_program() const;
    Eigen::VectorXd lengths(double cells) const;
    std::optional<Scored> try_size(double cells,
                                   double scale,
                                   std::size_t most_nodes,
                                   const Context& context) const;
    void set_twists(JunctionCounts& counts) const;
    void set_rows(JunctionCounts& counts, double cells) const;
    void leave_out_thin(JunctionCounts& counts) const;
    Parities row_parities(const JunctionCounts& counts) const;
    bool change_rows(JunctionCounts& counts, const Parities& parities, double cells) const;
    double stretch_cost(const JunctionCounts& counts, int cylinder, int rows) const;
    double ideal_rows(const JunctionCounts& counts, int cylinder) const;
    int nearest_rows(const JunctionCounts& counts, int cylinder, std::optional<int> parity) const;
    double strain(const JunctionCounts& counts, double cells) const;
    void check_fixed(const JunctionCounts& counts) const;

    const Foliation& foliation_;
    const ArcNetwork& network_;
    JunctionWish wish_;
    std::vector<double> aspect_;  // Per cylinder mean height over mean width on the surface.
    double wanted_ = 1.0;
    bool fixed_ = false;
    double unit_area_ = 0.0;  // Cells of unit size in g.
    std::optional<IntegerProgram> program_;
};

}  // namespace leafcutter::geometry
