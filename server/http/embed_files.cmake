# Puts files into a C++ source: cmake -DOUT=FILE -DOPENAPI=FILE [-DDASHBOARD=DIR] -P embed_files.cmake
#
# The assembler's .incbin takes their bytes as they are, so a megabyte compiles in no time.

set(entries "")
set(blobs "")
set(count 0)

function(embed name file)
    set(blobs "${blobs}__asm__(\".section .rodata\\n\"
        \"embedded_${count}:\\n.incbin \\\"${file}\\\"\\n\"
        \"embedded_${count}_end:\\n.byte 0\\n.previous\\n\");
extern const char embedded_${count}[] __asm__(\"embedded_${count}\");
extern const char embedded_${count}_end[] __asm__(\"embedded_${count}_end\");
" PARENT_SCOPE)
    set(entries "${entries}        {\"${name}\", {embedded_${count}, static_cast<std::size_t>(embedded_${count}_end - embedded_${count})}},
" PARENT_SCOPE)
    math(EXPR next "${count} + 1")
    set(count ${next} PARENT_SCOPE)
endfunction()

embed("openapi.json" "${OPENAPI}")
if(DASHBOARD)
    file(GLOB_RECURSE files RELATIVE "${DASHBOARD}" "${DASHBOARD}/*")
    list(SORT files)
    foreach(file IN LISTS files)
        embed("dashboard/${file}" "${DASHBOARD}/${file}")
    endforeach()
endif()

file(WRITE "${OUT}" "// Written by server/http/embed_files.cmake.
#include <cstddef>
#include <vector>

#include \"server/http/embedded.h\"

${blobs}
namespace leafcutter::server {

std::span<const EmbeddedFile> embedded_files() {
    static const std::vector<EmbeddedFile> files{
${entries}    };
    return files;
}

}  // namespace leafcutter::server
")
