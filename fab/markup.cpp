#include "fab/markup.h"

#include "fab/utf8.h"

namespace leafcutter::fab {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char letter : valid_utf8(text)) {
        switch (letter) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += static_cast<unsigned char>(letter) < ' ' ? ' ' : letter;
        }
    }
    return out;
}

}  // namespace leafcutter::fab
