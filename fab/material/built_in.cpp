// The materials that come with Leafcutter. All are flexible enough to weave and known to be safe in
// a laser: no PVC, no leather.
//
// Thickness of papers is weight times a bulk of 1.25 cm³/g, usual for uncoated ones. The tightest
// bend is the one at which the outer face is strained as far as the material bears: paper and felt
// some percent without harm, wood about 1 % (thickness / 2 / 0.01), polypropylene far more.
// Settings are estimates to start from, no test cuts: a test cut on the machine at hand decides.
// They are scaled from the energy that a cut takes for each millimetre of its length: about 1 J
// for each millimetre of wood's thickness, 0.15 J for paper of 160 g/m², 0.3 J for 1 mm of felt.
// Prices are of the order of what a shop takes for single sheets.

#include <array>
#include <vector>

#include "fab/material/material.h"

namespace leafcutter::fab {

namespace {

// What papers of one weight, veneers of one thickness have in common.
struct Kind {
    double thickness_mm;
    double weight_g_per_m2;
    double min_strip_width_mm;
    double min_radius_mm;
    double min_length_mm;
    double price_per_m2;
    bool grain;  // Along the sheet's width.
    LaserSettings cut;
    LaserSettings score;
    LaserSettings engrave;
    double kerf_mm;
    MachineSettings diode;
    MachineSettings co2;
};

constexpr const char* kDiode = "diode-10w";  // 10 W of light at 450 nm in a spot of 0.08 mm.
constexpr const char* kCo2 = "co2-40w";      // A tube of 40 W, which fires from about 10 % on.

const Kind& paper_80() {
    static const Kind kind{0.1,
                           80.0,
                           1.0,
                           1.5,
                           10.0,
                           0.6,
                           false,
                           {14.0, 2700.0, 1},
                           {7.0, 3300.0, 1},
                           {5.0, 4000.0, 1},
                           0.1,
                           {kDiode, 0.08, {30.0, 3000.0, 1}, {12.0, 3600.0, 1}, {8.0, 4000.0, 1}},
                           {kCo2, 0.15, {13.0, 3000.0, 1}, {10.0, 4500.0, 1}, {10.0, 6000.0, 1}}};
    return kind;
}

const Kind& paper_120() {
    static const Kind kind{0.15,
                           120.0,
                           1.0,
                           1.5,
                           10.0,
                           0.9,
                           false,
                           {17.0, 2500.0, 1},
                           {8.0, 3000.0, 1},
                           {6.0, 4000.0, 1},
                           0.1,
                           {kDiode, 0.09, {38.0, 2700.0, 1}, {14.0, 3300.0, 1}, {9.0, 4000.0, 1}},
                           {kCo2, 0.16, {15.0, 2700.0, 1}, {10.0, 4000.0, 1}, {10.0, 6000.0, 1}}};
    return kind;
}

const Kind& paper_160() {
    static const Kind kind{0.2,
                           160.0,
                           1.0,
                           2.0,
                           10.0,
                           1.2,
                           false,
                           {20.0, 2400.0, 1},
                           {8.0, 3000.0, 1},
                           {6.0, 4000.0, 1},
                           0.1,
                           {kDiode, 0.1, {45.0, 2400.0, 1}, {16.0, 3000.0, 1}, {10.0, 4000.0, 1}},
                           {kCo2, 0.16, {17.0, 2400.0, 1}, {11.0, 3600.0, 1}, {10.0, 5500.0, 1}}};
    return kind;
}

const Kind& paper_200() {
    static const Kind kind{0.25,
                           200.0,
                           1.2,
                           2.5,
                           10.0,
                           1.5,
                           false,
                           {24.0, 2200.0, 1},
                           {9.0, 2800.0, 1},
                           {7.0, 4000.0, 1},
                           0.11,
                           {kDiode, 0.1, {55.0, 2200.0, 1}, {18.0, 2800.0, 1}, {11.0, 4000.0, 1}},
                           {kCo2, 0.17, {19.0, 2200.0, 1}, {11.0, 3300.0, 1}, {10.0, 5000.0, 1}}};
    return kind;
}

const Kind& card_300() {
    static const Kind kind{0.4,
                           300.0,
                           1.5,
                           4.0,
                           12.0,
                           2.4,
                           false,
                           {30.0, 1800.0, 1},
                           {12.0, 2400.0, 1},
                           {8.0, 3600.0, 1},
                           0.12,
                           {kDiode, 0.11, {75.0, 1800.0, 1}, {22.0, 2400.0, 1}, {13.0, 3600.0, 1}},
                           {kCo2, 0.18, {24.0, 1800.0, 1}, {12.0, 3000.0, 1}, {11.0, 4500.0, 1}}};
    return kind;
}

const Kind& veneer() {
    static const Kind kind{0.6,
                           390.0,
                           2.0,
                           30.0,
                           20.0,
                           18.0,
                           true,
                           {45.0, 1200.0, 1},
                           {15.0, 2000.0, 1},
                           {10.0, 3000.0, 1},
                           0.15,
                           {kDiode, 0.12, {100.0, 900.0, 1}, {35.0, 2000.0, 1}, {16.0, 3000.0, 1}},
                           {kCo2, 0.18, {28.0, 1500.0, 1}, {13.0, 2500.0, 1}, {11.0, 4000.0, 1}}};
    return kind;
}

// Three crossed layers of birch: bends alike either way, about 680 kg/m³.
const Kind& plywood() {
    static const Kind kind{0.8,
                           545.0,
                           3.0,
                           40.0,
                           20.0,
                           28.0,
                           false,
                           {60.0, 900.0, 1},
                           {18.0, 1800.0, 1},
                           {11.0, 3000.0, 1},
                           0.16,
                           {kDiode, 0.13, {100.0, 600.0, 1}, {40.0, 1800.0, 1}, {17.0, 3000.0, 1}},
                           {kCo2, 0.2, {35.0, 1200.0, 1}, {14.0, 2200.0, 1}, {12.0, 3600.0, 1}}};
    return kind;
}

const Kind& felt() {
    static const Kind kind{1.0,
                           200.0,
                           3.0,
                           2.0,
                           15.0,
                           6.0,
                           false,
                           {35.0, 1500.0, 1},
                           {10.0, 2400.0, 1},
                           {7.0, 3000.0, 1},
                           0.2,
                           {kDiode, 0.2, {85.0, 1000.0, 1}, {20.0, 2400.0, 1}, {12.0, 3000.0, 1}},
                           {kCo2, 0.25, {24.0, 1800.0, 1}, {12.0, 3000.0, 1}, {10.0, 4000.0, 1}}};
    return kind;
}

// 0.91 g/cm³. Black, for blue light goes through the others. It melts: cut it with air.
const Kind& polypropylene() {
    static const Kind kind{0.5,
                           455.0,
                           2.5,
                           5.0,
                           15.0,
                           8.0,
                           false,
                           {50.0, 900.0, 1},
                           {14.0, 2000.0, 1},
                           {9.0, 3000.0, 1},
                           0.2,
                           {kDiode, 0.18, {100.0, 500.0, 2}, {30.0, 2000.0, 1}, {15.0, 3000.0, 1}},
                           {kCo2, 0.25, {30.0, 1200.0, 1}, {13.0, 2400.0, 1}, {11.0, 3600.0, 1}}};
    return kind;
}

struct Naming {
    const char* id;
    const char* name;
    const char* colour;
};

Material material(const Naming& naming, const Kind& kind) {
    constexpr double kGrainToleranceDeg = 10.0;
    constexpr StockSheet kBed{{600.0, 400.0}, {}};
    constexpr StockSheet kA3{{420.0, 297.0}, {}};
    Material result;
    result.id = naming.id;
    result.name = naming.name;
    result.colour = naming.colour;
    result.thickness_mm = kind.thickness_mm;
    result.weight_g_per_m2 = kind.weight_g_per_m2;
    result.kerf_mm = kind.kerf_mm;
    result.min_strip_width_mm = kind.min_strip_width_mm;
    result.min_radius_mm = kind.min_radius_mm;
    result.min_length_mm = kind.min_length_mm;
    if (kind.grain) {
        result.grain_deg = 0.0;
        result.grain_tolerance_deg = kGrainToleranceDeg;
    }
    result.sheets = {kBed, kA3};
    result.price_per_m2 = kind.price_per_m2;
    result.cut = kind.cut;
    result.score = kind.score;
    result.engrave = kind.engrave;
    result.settings = {kind.diode, kind.co2};
    return result;
}

}  // namespace

std::span<const Material> built_in_materials() {
    static const std::vector<Material> materials = {
        material({"paper-80-white", "Paper 80 g/m², white", "#f7f6f2"}, paper_80()),
        material({"paper-120-ivory", "Paper 120 g/m², ivory", "#efe6cf"}, paper_120()),
        material({"paper-120-green", "Paper 120 g/m², green", "#5c8f57"}, paper_120()),
        material({"paper-160-blue", "Paper 160 g/m², blue", "#2f5d9b"}, paper_160()),
        material({"paper-160-yellow", "Paper 160 g/m², yellow", "#f2c53d"}, paper_160()),
        material({"paper-160-white", "Paper 160 g/m², white", "#f5f3ee"}, paper_160()),
        material({"paper-160-red", "Paper 160 g/m², red", "#c23b33"}, paper_160()),
        material({"paper-200-white", "Paper 200 g/m², white", "#f4f2ec"}, paper_200()),
        material({"paper-200-kraft", "Kraft paper 200 g/m², brown", "#b08a5b"}, paper_200()),
        material({"card-300", "Card 300 g/m², grey", "#9a968e"}, card_300()),
        material({"card-300-black", "Card 300 g/m², black", "#2b2a29"}, card_300()),
        material({"veneer-0.6", "Veneer 0.6 mm, maple", "#d9b98a"}, veneer()),
        material({"veneer-0.6-walnut", "Veneer 0.6 mm, walnut", "#6f4c34"}, veneer()),
        material({"plywood-0.8", "Plywood 0.8 mm, birch", "#e0c79b"}, plywood()),
        material({"felt-1", "Felt 1 mm, grey", "#8a8f94"}, felt()),
        material({"felt-1-red", "Felt 1 mm, red", "#b4453f"}, felt()),
        material({"polypropylene-0.5", "Polypropylene 0.5 mm, black", "#26282b"}, polypropylene()),
    };
    return materials;
}

}  // namespace leafcutter::fab
