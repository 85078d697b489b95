#include "fab/weave/slab.h"

namespace leafcutter::fab {

namespace {

// Corners of a slab's cross-section, going round it as seen looking along the strip.
enum Corner { LeftOuter, LeftInner, RightInner, RightOuter };

class Slab {
public:
    explicit Slab(const WovenStrip& strip) : strip_(strip) {}

    void fill(Solid& solid) const {
        const double half = strip_.thickness_mm / 2.0;
        solid.vertices.reserve(4 * strip_.rungs.size());
        for (const WovenRung& rung : strip_.rungs) {
            solid.vertices.emplace_back(rung.left + half * rung.left_up);
            solid.vertices.emplace_back(rung.left - half * rung.left_up);
            solid.vertices.emplace_back(rung.right - half * rung.right_up);
            solid.vertices.emplace_back(rung.right + half * rung.right_up);
        }
        solid.triangles.reserve(8 * strip_.segments.size() + 4);
        for (std::size_t i = 0; i < strip_.segments.size(); ++i) {
            add_segment(i, solid);
        }
        if (!strip_.closed && !strip_.rungs.empty()) {
            const std::size_t last = strip_.rungs.size() - 1;
            add_face({at(0, RightOuter), at(0, LeftOuter), at(0, LeftInner), at(0, RightInner)},
                     solid);
            add_face({at(last, LeftOuter), at(last, RightOuter), at(last, RightInner),
                      at(last, LeftInner)},
                     solid);
        }
    }

private:
    int at(std::size_t rung, Corner corner) const {
        return static_cast<int>(4 * (rung % strip_.rungs.size())) + static_cast<int>(corner);
    }

    // A four-sided face as triangles that share the diagonal from its first corner to its third.
    static void add_face(const std::array<int, 4>& corner, Solid& solid) {
        solid.triangles.push_back({corner[0], corner[1], corner[2]});
        solid.triangles.push_back({corner[0], corner[2], corner[3]});
    }

    void add_segment(std::size_t i, Solid& solid) const {
        const std::size_t j = i + 1;
        // Both faces fold on the diagonal of the segment.
        if (strip_.segments[i].rises) {
            add_face({at(i, RightOuter), at(j, RightOuter), at(j, LeftOuter), at(i, LeftOuter)},
                     solid);
            add_face({at(i, RightInner), at(i, LeftInner), at(j, LeftInner), at(j, RightInner)},
                     solid);
        } else {
            add_face({at(i, LeftOuter), at(i, RightOuter), at(j, RightOuter), at(j, LeftOuter)},
                     solid);
            add_face({at(i, LeftInner), at(j, LeftInner), at(j, RightInner), at(i, RightInner)},
                     solid);
        }
        add_face({at(i, LeftOuter), at(j, LeftOuter), at(j, LeftInner), at(i, LeftInner)}, solid);
        add_face({at(i, RightInner), at(j, RightInner), at(j, RightOuter), at(i, RightOuter)},
                 solid);
    }

    const WovenStrip& strip_;
};

}  // namespace

std::vector<Solid> solids_of(std::span<const Strip> strips, const WovenModel& model) {
    std::vector<Solid> solids;
    solids.reserve(model.strips.size());
    for (const WovenStrip& woven : model.strips) {
        const Strip& strip = strips[static_cast<std::size_t>(woven.strip)];
        Solid& solid = solids.emplace_back();
        solid.name = strip.id;
        solid.family = strip.family;
        Slab(woven).fill(solid);
    }
    return solids;
}

}  // namespace leafcutter::fab
