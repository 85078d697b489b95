// A document as one page of HTML that needs nothing else: no scripts, no files, no network. It
// reads well on a phone and prints as A4.

#pragma once

#include <string>

#include "fab/guide/document.h"

namespace leafcutter::fab::guide {

std::string write_html(const Document& document);

}  // namespace leafcutter::fab::guide
