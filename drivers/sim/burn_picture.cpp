#include "drivers/sim/burn_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <png.h>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr double kMarginMm = 3.0;
constexpr double kBeamMm = 0.15;
constexpr double kTravelMm = 0.05;
constexpr double kSameMm = 0.02;  // A gap that no head has to travel.
constexpr double kSpotMm = 0.4;   // A beam that stood.
constexpr Colour kTravel{150, 170, 190};

struct Line {
    double x0 = 0.0;
    double y0 = 0.0;
    double x1 = 0.0;
    double y1 = 0.0;
};

struct Frame {
    double left = 0.0;
    double bottom = 0.0;
    double width = 1.0;
    double height = 1.0;
};

Line line_of(const BurntPiece& piece) {
    return {piece.x0_mm, piece.y0_mm, piece.x1_mm, piece.y1_mm};
}

Frame frame_of(std::span<const BurntPiece> pieces) {
    if (pieces.empty()) {
        return {};
    }
    double left = 1e300;
    double right = -1e300;
    double bottom = 1e300;
    double top = -1e300;
    for (const BurntPiece& piece : pieces) {
        left = std::min({left, piece.x0_mm, piece.x1_mm});
        right = std::max({right, piece.x0_mm, piece.x1_mm});
        bottom = std::min({bottom, piece.y0_mm, piece.y1_mm});
        top = std::max({top, piece.y0_mm, piece.y1_mm});
    }
    return {left - kMarginMm, bottom - kMarginMm, right - left + 2.0 * kMarginMm,
            top - bottom + 2.0 * kMarginMm};
}

// As the crow flies: a log has no dark moves.
std::vector<Line> travel_of(std::span<const BurntPiece> pieces) {
    std::vector<Line> travel;
    for (std::size_t i = 1; i < pieces.size(); ++i) {
        const BurntPiece& from = pieces[i - 1];
        const BurntPiece& to = pieces[i];
        if (std::hypot(to.x0_mm - from.x1_mm, to.y0_mm - from.y1_mm) > kSameMm) {
            travel.push_back({from.x1_mm, from.y1_mm, to.x0_mm, to.y0_mm});
        }
    }
    return travel;
}

// By S word, weakest first: what is strong lies on top.
std::map<double, std::vector<Line>> layers_of(std::span<const BurntPiece> pieces) {
    std::map<double, std::vector<Line>> layers;
    for (const BurntPiece& piece : pieces) {
        layers[std::round(piece.s * 10.0) / 10.0].push_back(line_of(piece));
    }
    return layers;
}

// From a light ochre to black with the part of the strongest power.
Colour colour_of(double part) {
    const auto blend = [part](double weak, double strong) {
        return static_cast<std::uint8_t>(std::lround(weak + (strong - weak) * part));
    };
    return {blend(230, 20), blend(160, 10), blend(60, 10)};
}

class Canvas {
public:
    Canvas(const Frame& frame, std::size_t pixels)
        : frame_(frame),
          scale_(static_cast<double>(pixels) / std::max(frame.width, frame.height)),
          width_(std::max<std::size_t>(1, static_cast<std::size_t>(frame.width * scale_))),
          height_(std::max<std::size_t>(1, static_cast<std::size_t>(frame.height * scale_))),
          bytes_(width_ * height_ * 3, 255) {}

    // A pixel is covered as far as the line's edge lies inside it; thin lines are a pixel wide.
    void draw(const Line& mm, double width_mm, const Colour& colour) {
        const Line line{to_x(mm.x0), to_y(mm.y0), to_x(mm.x1), to_y(mm.y1)};
        const double half = std::max(width_mm * scale_, 1.0) / 2.0;
        const double reach = half + 1.0;
        const auto columns = range(line.x0, line.x1, reach, width_);
        const auto rows = range(line.y0, line.y1, reach, height_);
        for (std::size_t y = rows.first; y < rows.second; ++y) {
            for (std::size_t x = columns.first; x < columns.second; ++x) {
                const double off =
                    distance(line, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
                blend(x, y, std::clamp(half + 0.5 - off, 0.0, 1.0), colour);
            }
        }
    }

    std::string png() const {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = static_cast<png_uint_32>(width_);
        image.height = static_cast<png_uint_32>(height_);
        image.format = PNG_FORMAT_RGB;
        png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
        std::string file(size, '\0');
        if (png_image_write_to_memory(&image, file.data(), &size, 0, bytes_.data(), 0, nullptr) ==
            0) {
            throw std::runtime_error(fmt::format("PNG: {}", image.message));
        }
        file.resize(size);
        return file;
    }

private:
    double to_x(double mm) const { return (mm - frame_.left) * scale_; }
    double to_y(double mm) const { return (frame_.bottom + frame_.height - mm) * scale_; }

    static std::pair<std::size_t, std::size_t> range(double a,
                                                     double b,
                                                     double reach,
                                                     std::size_t size) {
        const auto most = static_cast<double>(size);
        const double low = std::clamp(std::floor(std::min(a, b) - reach), 0.0, most);
        const double high = std::clamp(std::ceil(std::max(a, b) + reach), 0.0, most);
        return {static_cast<std::size_t>(low), static_cast<std::size_t>(high)};
    }

    static double distance(const Line& line, double x, double y) {
        const double dx = line.x1 - line.x0;
        const double dy = line.y1 - line.y0;
        const double squared = dx * dx + dy * dy;
        const double along =
            squared > 0.0
                ? std::clamp(((x - line.x0) * dx + (y - line.y0) * dy) / squared, 0.0, 1.0)
                : 0.0;
        return std::hypot(x - line.x0 - along * dx, y - line.y0 - along * dy);
    }

    void blend(std::size_t x, std::size_t y, double part, const Colour& colour) {
        std::uint8_t* pixel = &bytes_[(y * width_ + x) * 3];
        for (std::size_t i = 0; i < 3; ++i) {
            const double mixed = pixel[i] * (1.0 - part) + colour[i] * part;
            pixel[i] = static_cast<std::uint8_t>(std::lround(mixed));
        }
    }

    Frame frame_;
    double scale_;
    std::size_t width_;
    std::size_t height_;
    std::vector<std::uint8_t> bytes_;
};

void add_layer(std::string& svg,
               const std::vector<Line>& lines,
               std::string_view name,
               std::string_view stroke) {
    fmt::format_to(std::back_inserter(svg),
                   "<g inkscape:groupmode=\"layer\" inkscape:label=\"{}\" {}>\n<path d=\"", name,
                   stroke);
    for (const Line& line : lines) {
        fmt::format_to(std::back_inserter(svg), "M{:.3f} {:.3f}L{:.3f} {:.3f}", line.x0, line.y0,
                       line.x1, line.y1);
    }
    svg += "\"/>\n</g>\n";
}

}  // namespace

std::string burn_svg(std::span<const BurntPiece> pieces) {
    const Frame frame = frame_of(pieces);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
        "width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" viewBox=\"0 0 {0:.3f} {1:.3f}\">\n"
        "<g transform=\"translate({2:.3f} {3:.3f}) scale(1 -1)\" fill=\"none\" "
        "stroke-linecap=\"round\">\n",
        frame.width, frame.height, -frame.left, frame.bottom + frame.height);
    add_layer(svg, travel_of(pieces), "travel",
              fmt::format("stroke=\"#{:02x}{:02x}{:02x}\" stroke-width=\"{}\"", kTravel[0],
                          kTravel[1], kTravel[2], kTravelMm));
    const auto layers = layers_of(pieces);
    for (const auto& [s, lines] : layers) {
        const Colour colour = colour_of(s / std::max(layers.rbegin()->first, 1e-9));
        add_layer(svg, lines, fmt::format("S {:g}", s),
                  fmt::format("stroke=\"#{:02x}{:02x}{:02x}\" stroke-width=\"{}\"", colour[0],
                              colour[1], colour[2], kBeamMm));
    }
    return svg + "</g>\n</svg>\n";
}

std::string burn_png(std::span<const BurntPiece> pieces, std::size_t pixels) {
    constexpr std::size_t kMostPixels = 16384;
    if (pixels < 16 || pixels > kMostPixels) {
        throw std::invalid_argument("a picture has 16 to 16384 pixels on its longer side");
    }
    Canvas canvas(frame_of(pieces), pixels);
    for (const Line& line : travel_of(pieces)) {
        canvas.draw(line, kTravelMm, kTravel);
    }
    const auto layers = layers_of(pieces);
    for (const auto& [s, lines] : layers) {
        const Colour colour = colour_of(s / std::max(layers.rbegin()->first, 1e-9));
        for (const Line& line : lines) {
            const bool stood = line.x0 == line.x1 && line.y0 == line.y1;
            canvas.draw(line, stood ? kSpotMm : kBeamMm, colour);
        }
    }
    return canvas.png();
}

}  // namespace leafcutter::drivers
