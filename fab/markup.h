// Text inside of HTML and SVG.

#pragma once

#include <string>
#include <string_view>

namespace leafcutter::fab {

// `text` so that it can stand in an element or a quoted attribute: valid UTF-8 without anything
// that would be read as markup, control characters as blanks.
std::string escaped(std::string_view text);

}  // namespace leafcutter::fab
