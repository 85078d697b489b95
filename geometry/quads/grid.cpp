#include "geometry/quads/grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "geometry/quads/spacing.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {

namespace {

// More is no paper model any more, and would only fill the memory.
constexpr double kMostCells = 4e6;
// A torus whose generators are this close to a right angle is cut along them.
constexpr double kAlignedDeg = 1.0;
// Weight of the slant against the logarithms of aspect and cell count: 1 degree is as bad as a cell
// 7 % too long.
constexpr double kSlantWeight = 4.0;
// Strips are as wide as asked for, in the mean, to half this; beyond, 10 % more cells are as bad
// as cells 34 % too long.
constexpr double kCountTolerance = 0.03;
constexpr double kCountWeight = 20.0;
// Of a pattern that does not close: as much as cells 25 % too long.
constexpr double kBrokenPattern = 0.05;
// Costs below which grids are looked for, at first and if there are none.
constexpr double kFirstLimit = 0.003;
constexpr double kLastLimit = 1e4;
// Pillowcase: a column that comes back to itself after one round more is as bad as a cell 7 % too
// long; ten times as many rounds, as one 26 % too long.
constexpr double kRoundsWeight = 0.1;

double square(double x) {
    return x * x;
}
double degrees(double radians) {
    return radians * 180.0 / std::numbers::pi;
}

int floor_mod(int value, int modulus) {
    const int rest = value % modulus;
    return rest < 0 ? rest + modulus : rest;
}

int floor_div(int value, int divisor) {
    return (value - floor_mod(value, divisor)) / divisor;
}

struct Least {
    int rows = 1;
    int cols = 1;
    bool even_cols = false;
};

// Fewer than 3 cells around a ring double its edges.
Least least_counts(ChartShape shape, Parity parity) {
    const bool even = parity == Parity::Even;
    switch (shape) {
        case ChartShape::Rectangle:
            return {};
        case ChartShape::Pillowcase:
            // Fewer rows double the edges next to singular points.
            return {.rows = 2, .cols = 4, .even_cols = true};
        case ChartShape::Annulus:
            return {.rows = 1, .cols = even ? 4 : 3, .even_cols = even};
        case ChartShape::Torus:
            return {.rows = 3, .cols = even ? 4 : 3, .even_cols = even};
    }
    return {};
}

void check_fixed(const RowsCols& counts,
                 const Least& least,
                 ChartShape shape,
                 const std::string& path) {
    const char* even_advice = shape == ChartShape::Pillowcase
                                  ? ", and an even number"
                                  : ", and an even number (or grid.parity any)";
    if (counts.rows && *counts.rows < least.rows) {
        throw Error(ErrorKind::BadOption, "too-few-rows",
                    fmt::format("{}.rows: {} can't carry the surface; use at least {}", path,
                                *counts.rows, least.rows));
    }
    if (counts.cols && (*counts.cols < least.cols || (least.even_cols && *counts.cols % 2 != 0))) {
        throw Error(ErrorKind::BadOption, "bad-cols",
                    fmt::format("{}.cols: {} can't close a ring; use at least {}{}", path,
                                *counts.cols, least.cols, least.even_cols ? even_advice : ""));
    }
}

void check_size(double cells, const std::string& path) {
    if (!(cells <= kMostCells)) {
        throw Error(ErrorKind::BadOption, "too-many-cells",
                    fmt::format("{}: asks for {:.3g} cells; at most {:.0f} are made, so use wider "
                                "strips",
                                path, cells, kMostCells));
    }
}

struct Candidate {
    int rows = 0;
    int cols = 0;
    int shift = 0;
    double cost = 0.0;
};

bool is_slanted(ChartShape shape) {
    return shape == ChartShape::Torus || shape == ChartShape::Pillowcase;
}

// Whether columns may come out shifted into one another: then they are even ones.
bool may_shift(const Cylinder& chart) {
    return is_slanted(chart.shape) &&
           std::abs(degrees(std::atan2(chart.shear, chart.height))) > kAlignedDeg;
}

// Whole column shifts to consider for a slanted chart of `cols` columns: none if it is (nearly)
// square on; else the nearest of both parities.
std::vector<int> shifts_near(const Cylinder& chart, int cols) {
    if (!may_shift(chart)) {
        return {0};
    }
    const int low = static_cast<int>(std::floor(chart.shear * cols / chart.width));
    if (chart.shape == ChartShape::Pillowcase) {
        return {0, low, low + 1};
    }
    return {low, low + 1};
}

double slant_of(const Cylinder& chart, int cols, int shift) {
    return (chart.shear - shift * chart.width / cols) / chart.height;
}

// How many times a thread along a column goes up and down a pillowcase before it closes: each time
// it comes back 2 x shift columns aside.
int rounds_of(ChartShape shape, int cols, int shift) {
    return shape == ChartShape::Pillowcase ? cols / std::gcd(cols, 2 * shift) : 1;
}

// Where columns are shifted into one another, only even ones fit.
std::vector<double> even_levels(double length, int count) {
    std::vector<double> levels;
    levels.reserve(static_cast<std::size_t>(count) + 1);
    for (int i = 0; i < count; ++i) {
        levels.push_back(length * i / count);
    }
    levels.push_back(length);
    return levels;
}

// Looks for the grid that is least distorted: as many cells as wished, square, and upright. Exact:
// what is not looked at costs more than what is found.
class GridSearch {
public:
    // `aspect`: mean height over mean width of the chart on the surface.
    GridSearch(const Cylinder& chart, double aspect, const GridWish& wish, const Least& least)
        : chart_(chart), aspect_(aspect), wish_(wish), least_(least), cells_(wish.cells) {
        if (wish.counts.rows && wish.counts.cols) {
            cells_ = static_cast<double>(*wish.counts.rows) * *wish.counts.cols;
        } else if (wish.counts.rows) {
            cells_ = square(*wish.counts.rows) / aspect;
        } else if (wish.counts.cols) {
            cells_ = square(*wish.counts.cols) * aspect;
        }
        check_size(cells_, wish.path);
    }

    // No rows if none will do.
    Candidate best() {
        double limit = kFirstLimit;
        look_below(limit);
        while (best_.rows == 0 && limit < kLastLimit) {
            limit *= 4.0;
            look_below(limit);
        }
        if (best_.cost > limit) {
            look_below(best_.cost);
        }
        return best_;
    }

private:
    // All grids that cost less than the limit, and a few more.
    void look_below(double limit) {
        const double size = kCountTolerance + std::sqrt(limit / kCountWeight);
        const bool free = !wish_.counts.rows && !wish_.counts.cols;
        const double stretch = std::min(std::sqrt(limit), free ? wish_.most_stretch : kLastLimit);
        const double fewest = cells_ * std::exp(-size);
        const double most = std::min(cells_ * std::exp(size), kMostCells);
        const int first_col = wish_.counts.cols.value_or(std::max(
            least_.cols, static_cast<int>(std::sqrt(fewest / aspect_) * std::exp(-0.5 * stretch))));
        const int last_col = wish_.counts.cols.value_or(static_cast<int>(
            std::min(std::sqrt(most / aspect_) * std::exp(0.5 * stretch), most / least_.rows)));
        for (int cols = first_col; cols <= last_col; ++cols) {
            if (least_.even_cols && cols % 2 != 0) {
                continue;
            }
            const double square = aspect_ * cols;
            const int first_row = wish_.counts.rows.value_or(
                std::max(least_.rows,
                         static_cast<int>(std::max(fewest / cols, square * std::exp(-stretch)))));
            const int last_row = wish_.counts.rows.value_or(
                static_cast<int>(std::min(most / cols, square * std::exp(stretch))));
            for (const int shift : shifts_near(chart_, cols)) {
                for (int rows = first_row; rows <= last_row; ++rows) {
                    look_at(rows, cols, shift);
                }
            }
        }
    }

    void look_at(int rows, int cols, int shift) {
        const bool torus = chart_.shape == ChartShape::Torus;
        if (least_.even_cols && torus && (rows + shift) % 2 != 0) {
            return;
        }
        const double count = static_cast<double>(rows) * cols;
        const double off = std::max(0.0, std::abs(std::log(count / cells_)) - kCountTolerance);
        const double stretch = std::log(aspect_ * cols / rows);
        if (!wish_.counts.rows && !wish_.counts.cols && std::abs(stretch) > wish_.most_stretch) {
            return;
        }
        const double cost = kCountWeight * square(off) + square(stretch) +
                            square(kSlantWeight * slant_of(chart_, cols, shift)) +
                            square(kRoundsWeight * std::log(rounds_of(chart_.shape, cols, shift))) +
                            (closes_pattern(rows, cols, shift) ? 0.0 : kBrokenPattern);
        if (best_.rows == 0 || cost < best_.cost) {
            best_ = {.rows = rows, .cols = cols, .shift = shift, .cost = cost};
        }
    }

    bool closes_pattern(int rows, int cols, int shift) const {
        if (wish_.parity != Parity::Even || chart_.shape == ChartShape::Rectangle) {
            return true;
        }
        const bool along = cols % wish_.period == 0;
        const bool across = rows % wish_.period == 0 && shift % wish_.period == 0;
        return wish_.period <= 2 || (along && (across || chart_.shape != ChartShape::Torus));
    }

    const Cylinder& chart_;
    double aspect_;
    const GridWish& wish_;
    const Least& least_;
    double cells_;
    Candidate best_;
};

// A chart that is only slanted by its own angle, not by rounding: said as that angle.
double shear_deg(const Cylinder& chart, const Candidate& chosen) {
    return is_slanted(chart.shape) ? degrees(std::atan(slant_of(chart, chosen.cols, chosen.shift)))
                                   : 0.0;
}

std::vector<double> column_levels(const Cylinder& chart,
                                  const LevelScale& scale,
                                  const Candidate& chosen) {
    if (chosen.shift != 0) {
        return even_levels(chart.width, chosen.cols);
    }
    std::vector<double> levels = scale.levels(chosen.cols);
    return chart.shape == ChartShape::Pillowcase ? folded_levels(levels) : levels;
}

}  // namespace

std::vector<double> folded_levels(const std::vector<double>& levels) {
    std::vector<double> folded;
    folded.reserve(levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i) {
        folded.push_back(0.5 * (levels[i] + levels.back() - levels[levels.size() - 1 - i]));
    }
    return folded;
}

namespace {

double leaf_height(const Cylinder& chart, const LevelScale& g_scale) {
    return may_shift(chart) ? g_scale.mean_even_leaf_mm() : g_scale.mean_leaf_mm();
}

}  // namespace

double cells_per_square(const Cylinder& chart) {
    const double own_slant = is_slanted(chart.shape) ? chart.shear / chart.height : 0.0;
    const double height = leaf_height(chart, LevelScale(chart, Axis::G, own_slant));
    return surface_area(chart.mesh) / (height * LevelScale(chart, Axis::F, 0.0).mean_leaf_mm());
}

CylinderGrid choose_grid(const Cylinder& chart, const GridWish& wish) {
    const Least least = least_counts(chart.shape, wish.parity);
    check_fixed(wish.counts, least, chart.shape, wish.path);
    const LevelScale f_scale(chart, Axis::F, 0.0);
    const double own_slant = is_slanted(chart.shape) ? chart.shear / chart.height : 0.0;
    const LevelScale g_scale(chart, Axis::G, own_slant);
    // Leaves of F* are as long as the chart is high, in the mean, those of F as it is wide.
    const double height = leaf_height(chart, g_scale);
    const double width = f_scale.mean_leaf_mm();
    const double aspect = height / width;
    GridWish even = wish;
    even.cells *= surface_area(chart.mesh) / (height * width);
    const Candidate chosen = GridSearch(chart, aspect, even, least).best();
    if (chosen.rows == 0) {
        throw Error(ErrorKind::BadOption, "odd-rows",
                    fmt::format("{}.rows: {} closes the rings of this torus with a fault in the "
                                "weave; use an even number (or grid.parity any)",
                                wish.path, wish.counts.rows.value_or(0)));
    }
    check_size(static_cast<double>(chosen.rows) * chosen.cols, wish.path);
    return {.shape = chart.shape,
            .rows = chosen.rows,
            .cols = chosen.cols,
            .column_shift = chosen.shift,
            .shear_deg = shear_deg(chart, chosen),
            .stretch = aspect * chosen.cols / chosen.rows,
            .f_levels = f_scale.levels(chosen.rows),
            .g_levels = column_levels(chart, g_scale, chosen)};
}

ChartGrid::ChartGrid(const Cylinder& chart, CylinderGrid grid)
    : grid_(std::move(grid)), width_(chart.width), height_(chart.height) {
    if (is_slanted(grid_.shape)) {
        slant_ = slant_of(chart, grid_.cols, grid_.column_shift);
    }
}

int ChartGrid::vertices_in(int row) const {
    return on_fold(row) ? grid_.cols / 2 + 1 : grid_.cols + (closed_across() ? 0 : 1);
}

int ChartGrid::vertex(int row, int col) const {
    if (closed_along()) {
        const int turns = floor_div(row, grid_.rows);
        row -= turns * grid_.rows;
        col -= turns * grid_.column_shift;
    }
    const int before = row == 0 ? 0 : vertices_in(0) + (row - 1) * vertices_in(1);
    col -= first_col(row);
    if (closed_across()) {
        col = floor_mod(col, grid_.cols);
    }
    if (on_fold(row)) {
        col = std::min(col, grid_.cols - col);
    }
    return before + col;
}

int ChartGrid::cell(int row, int col) const {
    if (closed_along()) {
        const int turns = floor_div(row, grid_.rows);
        row -= turns * grid_.rows;
        col -= turns * grid_.column_shift;
    }
    if (closed_across()) {
        col = floor_mod(col, grid_.cols);
    }
    return row * grid_.cols + col;
}

double ChartGrid::f_level(int row) const {
    const int turns = closed_along() ? floor_div(row, grid_.rows) : 0;
    return grid_.f_levels[static_cast<std::size_t>(row - turns * grid_.rows)] + turns * height_;
}

double ChartGrid::s_level(int col) const {
    const int turns = closed_across() ? floor_div(col, grid_.cols) : 0;
    return grid_.g_levels[static_cast<std::size_t>(col - turns * grid_.cols)] + turns * width_;
}

namespace {

// Largest index of a non-empty ascending list whose value is at most `value`; 0 if there is none.
int last_at_most(const std::vector<double>& levels, double value) {
    const auto above = std::upper_bound(levels.begin(), levels.end(), value);
    return std::max(0, static_cast<int>(above - levels.begin()) - 1);
}

}  // namespace

int ChartGrid::row_at(double f) const {
    if (!closed_along()) {
        return std::min(last_at_most(grid_.f_levels, f), grid_.rows - 1);
    }
    const int turns = static_cast<int>(std::floor(f / height_));
    return turns * grid_.rows + last_at_most(grid_.f_levels, f - turns * height_);
}

int ChartGrid::col_at(double s) const {
    if (!closed_across()) {
        return std::min(last_at_most(grid_.g_levels, s), grid_.cols - 1);
    }
    const int turns = static_cast<int>(std::floor(s / width_));
    return turns * grid_.cols + last_at_most(grid_.g_levels, s - turns * width_);
}

Eigen::Vector2d ChartGrid::straight(const Eigen::Vector2d& gf) const {
    return {gf.x() - slant_ * gf.y(), gf.y()};
}

Eigen::Vector2d ChartGrid::unstraight(const Eigen::Vector2d& sf) const {
    return {sf.x() + slant_ * sf.y(), sf.y()};
}

}  // namespace leafcutter::geometry
