# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=texts.cpp -DNAMES=names -DFILES=files -P embed.cmake: writes texts as C++ constants of these names.
# Lists of bytes: compilers need not take a literal of more than 65536.
file(WRITE ${OUTPUT} "#include \"suite/texts.hpp\"\n")
foreach(name file IN ZIP_LISTS NAMES FILES)
  file(READ ${file} text HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${text}")
  # Lines that tools can still show.
  string(REGEX REPLACE "(('[^']*',){16})" "\\1\n" bytes "${bytes}")
  file(APPEND ${OUTPUT} "static constexpr char ${name}_bytes[] = {\n${bytes}};\n"
    "namespace tubefoot {\nconst std::string_view ${name}{${name}_bytes, sizeof ${name}_bytes};\n}\n")
endforeach()
