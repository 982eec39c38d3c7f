# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=presets.cpp -DPRESETS=files -P embed_presets.cmake: writes the presets as C++.
file(WRITE ${OUTPUT} "#include <array>\n#include \"scene/file/sensor_presets.hpp\"\nnamespace tubefoot {\nnamespace {\n")
list(LENGTH PRESETS count)
file(APPEND ${OUTPUT} "constexpr std::array<SensorPreset, ${count}> presets{{\n")
foreach(preset ${PRESETS})
  get_filename_component(name ${preset} NAME_WLE)
  file(READ ${preset} text)
  file(APPEND ${OUTPUT} "{\"${name}\", R\"TOML(${text})TOML\"},\n")
endforeach()
file(APPEND ${OUTPUT} "}};\n}\nstd::span<const SensorPreset> sensor_presets() { return presets; }\n}\n")
