// What stores throw when they can't do what they should, whatever engine is below.

#pragma once

#include <stdexcept>
#include <string>

namespace leafcutter::server {

enum class StoreTrouble {
    Busy,      // Somebody else holds it: try again soon.
    Full,      // The disk has no room; nothing was changed.
    ReadOnly,  // It takes no changes until an operator has seen to it.
    Damaged,   // What is there can't be read.
    Failed     // The disk, or a mistake of ours.
};

class StoreError : public std::runtime_error {
public:
    StoreError(StoreTrouble trouble, const std::string& what)
        : std::runtime_error(what), trouble_(trouble) {}

    StoreTrouble trouble() const { return trouble_; }

private:
    StoreTrouble trouble_;
};

// The database can't be used: written by a newer Leafcutter, or damaged with nothing to restore.
class DatabaseUnusable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace leafcutter::server
