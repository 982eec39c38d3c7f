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
      {"didson-identification", "DIDSON acoustic camera at 1.8 MHz, two-way width 0.3 degrees",
       "beams, spacing, sector: vendor; cycles: published simulation; widths (taken as two-way), level: "
       "second-hand; side lobes: of a uniform aperture, an assumption",
       R"(kind = "didson"
frequency_khz = 1800
beams = 96
beam_centres = "lens"
vertical_deg = 14
cycles = 8
transmit_pattern = "line"
transmit_aperture_m = 0.1015
receive_pattern = "line"
receive_aperture_m = 0.1015
receive_margin_deg = 1
source_level_db = 206
samples = 512
window_start_m = 0.84
window_length_m = 5
)"},
      {"didson-detection", "DIDSON acoustic camera at 1.1 MHz, two-way width 0.4 degrees",
       "beams, spacing, sector: vendor; cycles: published simulation; widths (taken as two-way), level: "
       "second-hand; side lobes: of a uniform aperture, an assumption",
       R"(kind = "didson"
frequency_khz = 1100
beams = 48
beam_centres = "lens"
vertical_deg = 14
cycles = 4
transmit_pattern = "line"
transmit_aperture_m = 0.1246
receive_pattern = "line"
receive_aperture_m = 0.1246
receive_margin_deg = 1
source_level_db = 202
samples = 512
window_start_m = 0.84
window_length_m = 10
)"},
      {"didson-lr-identification", "DIDSON long range at 1.2 MHz, two-way width 0.5 degrees",
       "frequency, beams, width (taken as two-way), range: second-hand; sector, cycles: as the standard "
       "camera; side lobes: of a uniform aperture, an assumption",
       R"(kind = "didson"
frequency_khz = 1200
beams = 48
beam_centres = "lens"
vertical_deg = 14
cycles = 4
transmit_pattern = "line"
transmit_aperture_m = 0.0914
receive_pattern = "line"
receive_aperture_m = 0.0914
receive_margin_deg = 1
source_level_db = 206
samples = 512
window_start_m = 0.84
window_length_m = 10
)"},
      {"didson-lr-detection", "DIDSON long range at 0.7 MHz, two-way width 0.8 degrees",
       "frequency, beams, width (taken as two-way), range: second-hand; sector, cycles: as the standard "
       "camera; side lobes: of a uniform aperture, an assumption",
       R"(kind = "didson"
frequency_khz = 700
beams = 48
beam_centres = "lens"
vertical_deg = 14
cycles = 4
transmit_pattern = "line"
transmit_aperture_m = 0.0979
receive_pattern = "line"
receive_aperture_m = 0.0979
receive_margin_deg = 1
source_level_db = 202
samples = 512
window_start_m = 0.84
window_length_m = 40
)"},
      {"aris-1800", "ARIS 1800 acoustic camera, 96 beams",
       "beams, shots a frame, outermost beam centres, timing: maker's tables; height of the sector: as the "
       "DIDSON; beams: ideal and even (the maker's get narrower outwards)",
       R"(kind = "didson"
frequency_khz = 1800
beams = 96
horizontal_deg = 27.84
vertical_deg = 14
cycles = 6
samples = 512
window_start_m = 0.699
window_length_m = 4.992
)"},
      {"aris-3000", "ARIS 3000 acoustic camera, 128 beams",
       "beams, shots a frame, outermost beam centres, timing: maker's tables; height of the sector: as the "
       "DIDSON; beams: ideal and even (the maker's get narrower outwards)",
       R"(kind = "didson"
frequency_khz = 3000
beams = 128
horizontal_deg = 30.24
vertical_deg = 14
cycles = 8
samples = 512
window_start_m = 0.699
window_length_m = 2.688
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
