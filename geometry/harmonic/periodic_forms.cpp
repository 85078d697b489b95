#include "geometry/harmonic/periodic_forms.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace leafcutter::geometry {
namespace {

void set_coordinates(ChartMap& map, const HarmonicForms& forms, const Eigen::Matrix2d& frame) {
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        const auto i = static_cast<Eigen::Index>(v);
        map.gf[v] = frame * Eigen::Vector2d(forms.values[0][i], forms.values[1][i]);
    }
    map.jump.resize(forms.jump[0].size());
    for (std::size_t h = 0; h < map.jump.size(); ++h) {
        map.jump[h] = frame * Eigen::Vector2d(forms.jump[0][h], forms.jump[1][h]);
    }
}

}  // namespace

std::vector<double> jumps_of(const FormClass& combination, std::span<const Jump> jump) {
    std::vector<double> out;
    out.reserve(jump.size());
    for (const Jump& pair : jump) {
        out.push_back(combination.x() * pair[0] + combination.y() * pair[1]);
    }
    return out;
}

double periodic_flux_variation(std::span<const WeightedEdge> edges,
                               const Eigen::VectorXd& values,
                               std::span<const double> jump) {
    // Every edge is cut where it passes a whole number; each vertex keeps one value in [0, 1).
    const Eigen::VectorXd home = values.array() - values.array().floor();
    std::vector<WeightedEdge> cut;
    std::vector<double> ends;
    const auto add = [&](double from, double to, double flux) {
        if (from != to) {
            const int vertex = static_cast<int>(ends.size());
            cut.push_back({vertex, vertex + 1, flux / std::abs(to - from), 0});
            ends.push_back(from);
            ends.push_back(to);
        }
    };
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const WeightedEdge& edge = edges[e];
        const double rise = values[edge.to] - values[edge.from] + jump[e];
        const double flux = edge.weight * std::abs(rise);
        const double low = rise > 0.0 ? home[edge.from] : home[edge.to];
        const double high = rise > 0.0 ? home[edge.to] : home[edge.from];
        const auto passed = static_cast<int>(std::lround(std::abs(rise) - (high - low)));
        if (passed == 0) {
            add(low, high, flux);
            continue;
        }
        add(low, 1.0, flux);
        for (int turn = 1; turn < passed; ++turn) {
            add(0.0, 1.0, flux);
        }
        add(0.0, high, flux);
    }
    return flux_variation(cut, Eigen::Map<const Eigen::VectorXd>(
                                   ends.data(), static_cast<Eigen::Index>(ends.size())));
}

std::pair<FormClass, FormClass> shortest_classes(const HarmonicForms& forms) {
    FormClass a(1, 0);
    FormClass b(0, 1);
    // Each round shortens b; rounding could only stall it at equal lengths.
    for (int round = 0; round < 64; ++round) {
        if (forms.product(b, b) < forms.product(a, a)) {
            std::swap(a, b);
        }
        const double ratio = forms.product(a, b) / forms.product(a, a);
        const int times = static_cast<int>(std::lround(ratio));
        if (times == 0 || std::abs(ratio) <= 0.5 * (1.0 + 1e-12)) {
            break;
        }
        b -= times * a;
    }
    return {a, b};
}

Eigen::Matrix2d lay_out_torus(SolvedChart& solved,
                              const HarmonicForms& forms,
                              const std::pair<FormClass, FormClass>& rising_and_round) {
    const auto& [rising, round] = rising_and_round;
    // Riemann's bilinear relation: the determinant is 1 for harmonic forms, and it is the ratio of
    // the bounds that f and g give for the modulus.
    const double determinant = forms.gram.determinant();
    solved.upper = forms.product(rising, rising);
    solved.lower = solved.upper / determinant;
    ChartMap& map = solved.map;
    map.shape = ChartShape::Torus;
    map.height = 1.0;
    map.width = solved.upper / std::sqrt(determinant);
    // g = width (the integral of `round` less its part along `rising`) is the conjugate: harmonic,
    // orthogonal to f, constant once round the leaves of f but for `width`.
    const double slope = forms.product(rising, round) / solved.upper;
    Eigen::Matrix2d frame;
    frame.row(0) = map.width * (round.cast<double>() - slope * rising.cast<double>());
    frame.row(1) = rising.cast<double>();
    map.shear = -map.width * slope;
    set_coordinates(map, forms, frame);
    if (chart_area(map) < 0.0) {
        frame.row(0) = -frame.row(0);
        map.shear = -map.shear;
        set_coordinates(map, forms, frame);
    }
    return frame;
}

}  // namespace leafcutter::geometry
