# embed_joined(TARGET NAME FILE...): the files one after another as bytes of the program, read by embedded_NAME(). Each
# begins on a line of its own.
# embed_packed(TARGET NAME FILE...): the same, deflated (gzip) and in base64.
#
# The bytes come in by the assembler's .incbin: the compiler would take seconds for a library as a string.
function(embed_joined target name)
  _embed(${target} ${name} "awk 1 \"$@\"" ${ARGN})
endfunction()

function(embed_packed target name)
  _embed(${target} ${name} "awk 1 \"$@\" | gzip -9nc | base64 -w0" ${ARGN})
endfunction()

function(_embed target name command)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  file(MAKE_DIRECTORY ${folder})
  set(data ${folder}/${name}.bin)
  set(source ${folder}/${name}.cpp)
  add_custom_command(
    OUTPUT ${data}
    COMMAND sh -c "${command} > '${data}'" sh ${ARGN}
    DEPENDS ${ARGN}
    COMMENT "Embedding ${name}"
    VERBATIM)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT [[
// Made by CMake.
#include <string_view>

asm(".section .rodata\n"
    ".global groundloop_embedded_@name@\n"
    ".global groundloop_embedded_@name@_end\n"
    "groundloop_embedded_@name@:\n"
    ".incbin \"@data@\"\n"
    "groundloop_embedded_@name@_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" const char groundloop_embedded_@name@[];
extern "C" const char groundloop_embedded_@name@_end[];

namespace groundloop {
std::string_view embedded_@name@();
std::string_view embedded_@name@() {
  return {groundloop_embedded_@name@, static_cast<std::size_t>(groundloop_embedded_@name@_end - groundloop_embedded_@name@)};
}
}  // namespace groundloop
]])
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${data})
  target_sources(${target} PRIVATE ${source})
endfunction()
