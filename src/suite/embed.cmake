# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=texts.cpp -DVERSIONS=numbers -DNAMES=names -DFILES=files -P embed.cmake: writes files as constants of C++, and the
# function suite_texts(version). The three lists have one entry per text: the version of the suite, its path in the suite, its file.
# Lists of bytes: compilers need not take a literal of more than 65536.
file(WRITE ${OUTPUT} "#include \"suite/texts.hpp\"\n#include <map>\n#include <vector>\n")
set(number 0)
set(rows "")
foreach(version name file IN ZIP_LISTS VERSIONS NAMES FILES)
  file(READ ${file} text HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${text}")
  # Lines that tools can still show.
  string(REGEX REPLACE "(('[^']*',){16})" "\\1\n" bytes "${bytes}")
  file(APPEND ${OUTPUT} "static constexpr char text_${number}[] = {\n${bytes}};\n")
  string(APPEND rows "  if (version == ${version}) texts.push_back({\"${name}\", {text_${number}, sizeof text_${number}}});\n")
  math(EXPR number "${number} + 1")
endforeach()
file(APPEND ${OUTPUT} "namespace tubefoot {\nstd::span<const SuiteText> suite_texts(int wanted) {\n"
  "  static const auto of = [](int version) {\n  std::vector<SuiteText> texts;\n${rows}  return texts;\n  };\n"
  "  static const std::map<int, std::vector<SuiteText>> all{{0, of(0)}, {2, of(2)}, {3, of(3)}};\n  return all.at(wanted);\n}\n}\n")
