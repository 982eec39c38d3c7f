# SPDX-License-Identifier: GPL-3.0-or-later
# Flags of our own code, per target, so that no library's headers have to obey them.
add_library(tubefoot_house INTERFACE)
target_include_directories(tubefoot_house INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
target_compile_options(tubefoot_house INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  # A contracted multiply-add would break every floating-point error bound (docs/visibility.md).
  -ffp-contract=off)
if(TUBEFOOT_SANITIZE)
  target_compile_options(tubefoot_house INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tubefoot_house INTERFACE -fsanitize=address,undefined)
endif()

# tubefoot_library(NAME [libraries...]): a static library of all sources in the current folder.
function(tubefoot_library name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC tubefoot_house ${ARGN})
endfunction()
