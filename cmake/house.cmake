# SPDX-License-Identifier: GPL-3.0-or-later
# Flags of our own code, per target, so that no library's headers have to obey them.
add_library(tubefoot_house INTERFACE)
target_compile_options(tubefoot_house INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  # A contracted multiply-add would break every floating-point error bound (docs/visibility.md).
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
  target_compile_definitions(tubefoot_house INTERFACE TUBEFOOT_SANITIZED)  # tests do less: tests/geometry
  target_compile_options(tubefoot_house INTERFACE -fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tubefoot_house INTERFACE -fsanitize=${sanitizers})
endif()

# tubefoot_library(NAME [libraries...]): a static library of all sources in the current folder and the rooms below it,
# installed with its headers (cmake/install.cmake).
function(tubefoot_library name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/main.cpp)
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:tubefoot_house> ${ARGN} tubefoot_mathematics)
  target_include_directories(${name} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR};${PROJECT_SOURCE_DIR}/src>" $<INSTALL_INTERFACE:include/tubefoot>)
  set_property(GLOBAL APPEND PROPERTY TUBEFOOT_LIBRARIES ${name})
endfunction()
