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
      {"geoswath-125", "GeoSwath Plus interferometric sidescan, 125 kHz",
       "frequency: maker's data sheet; beam and range (half the swath): published figures, second-hand; "
       "baseline (about 2 wavelengths), staff tilt and sampling: assumed",
       R"(kind = "interferometric"
frequency_khz = 125
along_track_deg = 0.85
depression_min_deg = 2
depression_max_deg = 88
range_max_m = 390
samples = 5000
baseline_m = 0.024
staff_tilt_deg = 30
)"},
      {"geoswath-250", "GeoSwath Plus interferometric sidescan, 250 kHz",
       "frequency: maker's data sheet; beam and range (half the swath): published figures, second-hand; "
       "baseline (about 2 wavelengths), staff tilt and sampling: assumed",
       R"(kind = "interferometric"
frequency_khz = 250
along_track_deg = 0.75
depression_min_deg = 2
depression_max_deg = 88
range_max_m = 195
samples = 5000
baseline_m = 0.012
staff_tilt_deg = 30
)"},
      {"geoswath-500", "GeoSwath Plus interferometric sidescan, 500 kHz",
       "frequency: maker's data sheet; beam and range (half the swath): published figures, second-hand; "
       "baseline (about 2 wavelengths), staff tilt and sampling: assumed",
       R"(kind = "interferometric"
frequency_khz = 500
along_track_deg = 0.5
depression_min_deg = 2
depression_max_deg = 88
range_max_m = 95
samples = 5000
baseline_m = 0.006
staff_tilt_deg = 30
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
