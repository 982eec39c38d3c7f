# SPDX-License-Identifier: GPL-3.0-or-later
find_program(TUBEFOOT_PYTHON3 python3 HINTS /usr/bin NO_DEFAULT_PATH REQUIRED)  # runs tools/

# Flags of our own code, per target, so that no library's headers have to obey them.
# Other compilers have other warnings: only CI stops at them.
option(TUBEFOOT_WARNINGS_AS_ERRORS "Stop the build at a compiler's warning" OFF)
# Files of one folder in one unit: tubefoot_unity(), below. There a local variable may have the name of another file's constant.
option(TUBEFOOT_UNITY "Compile several files of a folder in one unit" ON)
add_library(tubefoot_project INTERFACE)
target_compile_options(tubefoot_project INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow$<$<AND:$<BOOL:${TUBEFOOT_UNITY}>,$<CXX_COMPILER_ID:GNU>>:=local> -Wconversion -Wno-sign-conversion
  $<$<BOOL:${TUBEFOOT_WARNINGS_AS_ERRORS}>:-Werror>
  # A contracted multiply-add would break every floating-point error bound (docs/notes/visibility.md).
  -ffp-contract=off)
if(TUBEFOOT_SANITIZE STREQUAL "address")
  # The counters are for the fuzz targets (tests/fuzz/), which steer by them; clang has them, g++ does not.
  set(sanitizers address,undefined $<$<CXX_COMPILER_ID:Clang>:,fuzzer-no-link>)
  list(JOIN sanitizers "" sanitizers)
elseif(TUBEFOOT_SANITIZE STREQUAL "thread")
  set(sanitizers thread)
elseif(TUBEFOOT_SANITIZE)
  message(FATAL_ERROR "TUBEFOOT_SANITIZE is address or thread, not ${TUBEFOOT_SANITIZE}")
endif()
if(TUBEFOOT_SANITIZE)
  target_compile_definitions(tubefoot_project INTERFACE TUBEFOOT_SANITIZED)  # tests do less: tests/geometry
  target_compile_options(tubefoot_project INTERFACE -fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tubefoot_project INTERFACE -fsanitize=${sanitizers})
endif()

# What nearly every file includes is parsed once (validation/performance.md has what that saves): tubefoot_headers(NAME
# [headers...]) compiles it, with these headers more, and tubefoot_precompiled(TARGET NAME) has a target of the same
# flags read it. Not with a launcher (ccache shares more without) and not with sanitizers: those builds see includes
# that a file forgot. Files of other flags (-frounding-math) skip it.
set(TUBEFOOT_COMMON_HEADERS
  <algorithm> <array> <cmath> <cstddef> <cstdint> <cstring> <exception> <filesystem> <functional> <limits> <map> <memory>
  <optional> <span> <sstream> <stdexcept> <string> <string_view> <type_traits> <unordered_map> <utility> <variant>
  <vector> <fmt/format.h> <glm/common.hpp> <glm/geometric.hpp> <glm/vec2.hpp> <glm/vec3.hpp>)
set(TUBEFOOT_PRECOMPILED OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND NOT TUBEFOOT_SANITIZE)
  set(TUBEFOOT_PRECOMPILED ON)
endif()
function(tubefoot_headers name)
  if(TUBEFOOT_PRECOMPILED)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${name}.cpp CONTENT "// Carries precompiled headers: cmake/project.cmake.\n")
    add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/${name}.cpp)
    target_link_libraries(${name} PRIVATE tubefoot_project fmt::fmt)
    target_compile_options(${name} PRIVATE -pthread)
    target_precompile_headers(${name} PRIVATE ${TUBEFOOT_COMMON_HEADERS} ${ARGN})
  endif()
endfunction()
function(tubefoot_precompiled target name)
  if(TUBEFOOT_PRECOMPILED)
    target_precompile_headers(${target} REUSE_FROM ${name})
    target_compile_options(${target} PRIVATE -pthread)  # which librsvg's flags have: all have it, or none share
    # g++ 12 takes inlined copies of std::string for overflows. In a precompiled header it does not hush them.
    target_compile_options(${target} PRIVATE
      -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict -Wno-maybe-uninitialized)
  endif()
endfunction()
tubefoot_headers(tubefoot_library_headers)

# tubefoot_unity(TARGET [SIZE]): files of one folder are compiled together, SIZE (or eight) in a unit, so that their common
# headers are parsed once. A name that is local to a file (of an anonymous namespace) is then unique among them. Files with
# COMPILE_OPTIONS stay alone. Builds with sanitizers compile each file alone: they see includes that a file forgot.
function(tubefoot_unity target)
  set(size 8)
  if(ARGC GREATER 1)
    set(size ${ARGV1})
  endif()
  if(NOT TUBEFOOT_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  foreach(source ${sources})
    cmake_path(GET source PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    string(APPEND in_${folder} "|")
    string(LENGTH "${in_${folder}}" count)
    math(EXPR unit "(${count} - 1) / ${size}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${unit})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE -Wno-subobject-linkage)  # of a class of a .cpp file whose member has a local type
endfunction()

# tubefoot_library(NAME [libraries...] [UNITS size] [EXCEPT sources...]): a static library of all sources in the current
# folder and the folders below it, installed with its headers (cmake/install.cmake).
function(tubefoot_library name)
  cmake_parse_arguments(PARSE_ARGV 1 library "" UNITS EXCEPT)
  set(libraries ${library_UNPARSED_ARGUMENTS})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/main.cpp ${library_EXCEPT})
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:tubefoot_project> ${libraries} tubefoot_mathematics)
  target_include_directories(${name} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR};${PROJECT_SOURCE_DIR}/src>" $<INSTALL_INTERFACE:include/tubefoot>)
  if(libraries)  # else it is without fmt, which is among the common headers
    tubefoot_precompiled(${name} tubefoot_library_headers)
  endif()
  tubefoot_unity(${name} ${library_UNITS})
  set_property(GLOBAL APPEND PROPERTY TUBEFOOT_LIBRARIES ${name})
endfunction()
