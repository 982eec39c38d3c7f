# SPDX-License-Identifier: GPL-3.0-or-later
# Sines, logarithms and their like, the same to the last bit on every processor of an architecture. The C library
# picks other code for them where the processor lacks AVX2 and FMA; musl's (Debian: musl-dev) is plain code, which
# does not ask. These members of its archive become one object:
# - tubefoot_mathematics, a library that every library of ours links, so that whatever they are linked into takes
#   these functions from there and not from libm. They are hidden: a Python module or somebody's shared library keeps
#   its own calls, and nobody else's, to itself.
# - tubefoot_mathematics_for_all, an object that shows them, for programs in which PROJ and GeographicLib shall call
#   them as well.
# tests/mathematics holds their accuracy and looks for functions that slipped through.
string(REPLACE "-gnu" "-musl" musl_folder "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}")
find_file(TUBEFOOT_MUSL_ARCHIVE libc.a PATHS ${musl_folder} NO_DEFAULT_PATH)
if(NOT TUBEFOOT_MUSL_ARCHIVE)
  message(FATAL_ERROR "No ${musl_folder}/libc.a: its mathematical functions are needed (Debian: musl-dev)")
endif()

set(functions acos asin atan atan2 cos sin sincos tan acosh asinh atanh cosh sinh tanh exp exp10 exp2 expm1 log log10
  log1p log2 pow cbrt hypot erf cabs)
list(TRANSFORM functions APPEND f OUTPUT_VARIABLE float_functions)
list(APPEND functions ${float_functions})
set(members ${functions})
list(APPEND functions erfc erfcf)  # with erf, erff
# What those call.
foreach(part __cos __sin __tan __rem_pio2 __expo2)
  list(APPEND members ${part} ${part}f)
endforeach()
list(TRANSFORM members REPLACE "^(__(cos|sin|tan))f$" "\\1df")
foreach(part divzero invalid oflow uflow xflow)
  list(APPEND members __math_${part} __math_${part}f)
endforeach()
list(APPEND members __rem_pio2_large exp_data exp2f_data log_data logf_data log2_data log2f_data pow_data powf_data)
list(TRANSFORM members APPEND .lo)

set(folder ${PROJECT_BINARY_DIR}/mathematics)
set(hidden "")
set(shown "")
foreach(function ${functions})
  string(APPEND hidden ".globl ${function}\n.hidden ${function}\n")
  string(APPEND shown "${function};\n")
endforeach()
file(CONFIGURE OUTPUT ${folder}/hidden.s CONTENT "${hidden}.section .note.GNU-stack,\"\",@progbits\n" @ONLY)
file(CONFIGURE OUTPUT ${folder}/shown.list CONTENT "{\n${shown}};\n" @ONLY)
list(JOIN functions "\n" names)
file(CONFIGURE OUTPUT ${folder}/names.txt CONTENT "${names}\n" @ONLY)
add_custom_command(OUTPUT ${folder}/hidden.o ${folder}/shown.o
  COMMAND ${CMAKE_AR} x ${TUBEFOOT_MUSL_ARCHIVE} ${members}
  COMMAND ${CMAKE_LINKER} -r -o all.o ${members}
  COMMAND ${CMAKE_OBJCOPY} --keep-global-symbols=names.txt all.o shown.o
  COMMAND ${CMAKE_CXX_COMPILER} -c -x assembler hidden.s -o hide.o
  COMMAND ${CMAKE_LINKER} -r -o hidden.o shown.o hide.o
  DEPENDS ${TUBEFOOT_MUSL_ARCHIVE} ${folder}/hidden.s ${folder}/names.txt
  WORKING_DIRECTORY ${folder} COMMENT "Taking the mathematical functions from musl" VERBATIM)

add_library(tubefoot_mathematics STATIC ${folder}/hidden.o)
set_target_properties(tubefoot_mathematics PROPERTIES LINKER_LANGUAGE CXX)
set_property(GLOBAL APPEND PROPERTY TUBEFOOT_LIBRARIES tubefoot_mathematics)

add_library(tubefoot_mathematics_for_all INTERFACE)
target_sources(tubefoot_mathematics_for_all INTERFACE ${folder}/shown.o)
target_link_options(tubefoot_mathematics_for_all INTERFACE -Wl,--dynamic-list=${folder}/shown.list)
