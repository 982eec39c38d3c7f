// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/sensor_presets.hpp"

namespace tubefoot {

const std::vector<SensorPreset>& sensor_presets() {
  static const std::vector<SensorPreset> presets{
      {"klein-3000-445", "Klein 3000 towed sidescan, high frequency",
       "frequency: maker's data sheet; widths and range: published figures, second-hand",
       R"(kind = "sidescan"
frequency_khz = 445
along_track_deg = 0.21
depression_min_deg = 5
depression_max_deg = 85
range_max_m = 150
samples = 3000
)"},
      {"klein-3000-132", "Klein 3000 towed sidescan, low frequency",
       "frequency: maker's data sheet; widths and range: published figures, second-hand",
       R"(kind = "sidescan"
frequency_khz = 132
along_track_deg = 0.7
depression_min_deg = 5
depression_max_deg = 85
range_max_m = 600
samples = 4000
)"},
      {"edgetech-4125-400", "EdgeTech 4125 sidescan, 400 kHz of the 400/900 set",
       "published figures, second-hand",
       R"(kind = "sidescan"
frequency_khz = 400
along_track_deg = 0.46
depression_min_deg = 5
depression_max_deg = 85
range_max_m = 150
samples = 3000
)"},
      {"edgetech-4125-900", "EdgeTech 4125 sidescan, 900 kHz of the 400/900 set",
       "published figures, second-hand",
       R"(kind = "sidescan"
frequency_khz = 900
along_track_deg = 0.28
depression_min_deg = 5
depression_max_deg = 85
range_max_m = 75
samples = 3000
)"},
      {"reson-8101", "RESON SeaBat 8101 multibeam echosounder, 240 kHz",
       "beams: device table of CUBE and the manual; source level: manual, full power; range: second-hand; "
       "samples of 5 cm, near a pulse of 75 us",
       R"(kind = "multibeam"
frequency_khz = 240
beams = 101
swath_deg = 150
beam_across_deg = 1.5
along_track_deg = 1.5
source_level_db = 210
range_max_m = 300
samples = 5990
)"},
  };
  return presets;
}

std::vector<std::string> sensor_preset_names() {
  std::vector<std::string> names;
  for (const SensorPreset& preset : sensor_presets()) names.emplace_back(preset.name);
  return names;
}

}  // namespace tubefoot
