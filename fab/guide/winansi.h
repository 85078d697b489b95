// Text for fonts that know one byte to a letter.

#pragma once

#include <string>
#include <string_view>

namespace leafcutter::fab::guide {

// `utf8` in the WinAnsi encoding of PDF (Windows-1252). Letters it lacks lose their accents, or
// become '?'; control characters become blanks. Takes any bytes.
std::string to_winansi(std::string_view utf8);

}  // namespace leafcutter::fab::guide
