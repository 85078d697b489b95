// Reads engraved text: finds strokes of our own font (fab/strips/labels.h) among burnt lines.
//
// Position, direction and size of the texts are unknown; mirrored text is not read. A letter whose
// lines touch only each other gives the pose of its text; from there letters are looked up to both
// sides where they have to stand, the richest one that fits. Of readings that share lines the
// longest wins, so that no 9 is read out of a 6 upside down.

#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/audit.h"

namespace leafcutter::fab {

struct ReadText {
    std::string text;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();  // Left end of the base line.
    double angle_deg = 0.0;
    double height_mm = 0.0;
};

struct Reading {
    std::vector<ReadText> texts;     // In the order of their first lines.
    std::vector<BurntSegment> rest;  // What is no text.
};

// Coordinates may be off by rounding to micrometres. Every line of a letter is one segment, which
// may run either way. O(n log n) for marks that lie apart.
Reading read_texts(std::span<const BurntSegment> lines);

}  // namespace leafcutter::fab
