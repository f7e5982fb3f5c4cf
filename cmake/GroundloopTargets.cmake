# One library a folder, strict warnings, no contraction of floating point: the same bytes from every build.
# -Wrestrict and -Wmaybe-uninitialized are left out: GCC 12 sees them in std::string and Eigen where they are not (GCC bug
# 105651, 105562). -Warray-bounds and -Wstringop-* warn but do not fail, for the same reason.

# groundloop_library(NAME [PUBLIC LIBRARY...] [PRIVATE LIBRARY...] [SYSTEM_INCLUDES FOLDER...] SOURCES FILE...): the library
# of one folder. PUBLIC names what its headers need, PRIVATE what only its sources need: that is how the direction of
# dependencies is kept.
function(groundloop_library name)
  cmake_parse_arguments(arg "" "" "PUBLIC;PRIVATE;SYSTEM_INCLUDES;SOURCES" ${ARGN})
  add_library(${name} STATIC ${arg_SOURCES})
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  if(arg_SYSTEM_INCLUDES)
    target_include_directories(${name} SYSTEM PRIVATE ${arg_SYSTEM_INCLUDES})
  endif()
  target_link_libraries(${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  groundloop_compile_options(${name})
endfunction()

function(groundloop_compile_options name)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                         -ffp-contract=off $<$<BOOL:${GROUNDLOOP_WERROR}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${name} PRIVATE -Wno-restrict -Wno-maybe-uninitialized -Wno-error=array-bounds
                           -Wno-error=stringop-overflow -Wno-error=stringop-overread)
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${name} PRIVATE -O3)
  endif()
  if(GROUNDLOOP_SANITIZE)
    # What is found ends the program; the checks of the standard library and of Eigen are on as well.
    target_compile_options(${name} PUBLIC -fsanitize=${GROUNDLOOP_SANITIZE} -fno-sanitize-recover=all
                           -fno-omit-frame-pointer -UNDEBUG)
    target_compile_definitions(${name} PUBLIC GROUNDLOOP_SANITIZED _GLIBCXX_ASSERTIONS)
    target_link_options(${name} PUBLIC -fsanitize=${GROUNDLOOP_SANITIZE})
  endif()
endfunction()
