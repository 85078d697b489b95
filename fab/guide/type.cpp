#include "fab/guide/type.h"

#include <algorithm>

namespace leafcutter::fab::guide {

std::vector<std::string> wrapped(std::string_view text,
                                 const Type& type,
                                 double width_mm,
                                 const Canvas& canvas) {
    const auto fits = [&](const std::string& line) {
        return canvas.text_width_mm(line, type.size_mm(), type.bold) <= width_mm;
    };
    std::vector<std::string> lines(1);
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word(text.substr(begin, end - begin));
        begin = end + 1;
        const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
        if (fits(longer)) {
            lines.back() = longer;
            continue;
        }
        if (!lines.back().empty()) {
            lines.emplace_back();
        }
        for (std::size_t i = 0; i < word.size();) {
            std::size_t next = i + 1;
            while (next < word.size() && (static_cast<unsigned char>(word[next]) & 0xc0U) == 0x80) {
                ++next;
            }
            const std::string letter = word.substr(i, next - i);
            if (!lines.back().empty() && !fits(lines.back() + letter)) {
                lines.emplace_back();
            }
            lines.back() += letter;
            i = next;
        }
    }
    return lines;
}

}  // namespace leafcutter::fab::guide
