// Pictures of the model: woven, its regions, what is done so far.

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fab/guide/document.h"
#include "fab/guide/view.h"
#include "fab/job_result.h"

namespace leafcutter::fab::guide {

struct Palette {
    Colour weft;
    Colour warp;
    Colour accent;  // Unlike both: what is new in a step.

    const Colour& of(Family family) const { return family == Family::Weft ? weft : warp; }
};

Palette palette_of(const JobResult& job);

// Colours that can be told from each other, over and over again.
Colour region_colour(std::size_t region);

Colour mixed(const Colour& one, const Colour& other, double part_of_other);

struct PictureSize {
    double width_mm = 0.0;
    double height_mm = 0.0;
};

// The view from where most is seen, rather from above.
std::size_t best_view(const Views& views);

// The finished object: each cell as the strip that lies on top, as large as the size allows.
Drawing woven_picture(const JobResult& job, Views& views, std::size_t view, PictureSize size);

// The region of every quad; -1: none.
std::vector<int> region_of_quads(const JobResult& job);

// Regions in their colours, with their numbers.
Drawing region_picture(const JobResult& job, Views& views, std::size_t view, PictureSize size);

// Views that together show every region: some, the best first.
std::vector<std::size_t> region_views(const JobResult& job, const Views& views, std::size_t most);

// Which strips lie on each quad by now.
struct Progress {
    std::vector<std::uint8_t> weft;
    std::vector<std::uint8_t> warp;
    std::vector<int> finished;  // Regions: drawn from a shared picture each.
};

struct Highlight {
    std::vector<int> over;   // Quads where something new lies on top,
    std::vector<int> under;  // and where it lies below.
};

// What is done so far, always at the same size. Parts that many pictures have in common become
// shared drawings.
class ModelPictures {
public:
    ModelPictures(const JobResult& job,
                  Views& views,
                  PictureSize size,
                  std::vector<Drawing>& shared);

    // Where the quads are seen best; the view before is kept if it shows them nearly as well.
    std::size_t view_for(const std::vector<int>& quads);

    Drawing picture(std::size_t view, const Progress& progress, const Highlight& highlight);

private:
    struct Layer;

    std::size_t base(std::size_t view);
    std::size_t outline(std::size_t view);
    std::size_t finished(std::size_t view, int region);
    std::size_t add_shared(Drawing drawing);

    const JobResult& job_;
    Views& views_;
    PictureSize size_;
    std::vector<Drawing>& shared_;
    Palette palette_;
    std::vector<int> region_of_;
    std::size_t last_view_;
    std::map<std::pair<std::size_t, int>, std::size_t> known_;  // (view, layer) to shared drawing.
};

}  // namespace leafcutter::fab::guide
