// A document as PDF: A4 portrait, vector pictures, built-in fonts, no dates: equal documents give
// equal bytes.

#pragma once

#include <string>

#include "fab/guide/document.h"

namespace leafcutter::fab::guide {

// Throws Error(SelfCheck) where the library refuses.
std::string write_pdf(const Document& document);

}  // namespace leafcutter::fab::guide
