# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=assets.cpp -DHTML=file -DCSS=file -DJS=files -P embed.cmake: writes texts as C++ constants.
# Lists of bytes: compilers need not take a literal of more than 65536.
function(constant name)
  set(text "")
  foreach(file ${ARGN})
    file(READ ${file} part HEX)
    string(APPEND text "${part}")
  endforeach()
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${text}")
  # Lines that tools can still show.
  string(REGEX REPLACE "(('[^']*',){16})" "\\1\n" bytes "${bytes}")
  file(APPEND ${OUTPUT} "constexpr char ${name}_bytes[] = {\n${bytes}};\n")
  file(APPEND ${OUTPUT} "}\nnamespace tubefoot {\nconst std::string_view ${name}{${name}_bytes, sizeof ${name}_bytes};\n}\nnamespace {\n")
endfunction()

file(WRITE ${OUTPUT} "#include \"viewer/assets.hpp\"\nnamespace {\n")
constant(page_html ${HTML})
constant(page_css ${CSS})
constant(page_js ${JS})
file(APPEND ${OUTPUT} "}\n")
