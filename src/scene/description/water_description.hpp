// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

struct WaterDescription {
  SourcePlace place;
  std::optional<double> sound_speed_m_s;  ///< by default Mackenzie 1981 from T, S and depth
  std::optional<double>
      absorption_db_per_km;  ///< by default Francois-Garrison 1982 at the sensor's frequency
  double temperature_c = 10, salinity_psu = 35, ph = 8;
  double depth_m = 10;  ///< depth in both formulas
  std::string sound_speed_formula = "mackenzie", absorption_model = "francois-garrison";
  std::optional<double> latitude_deg;  ///< for Leroy's formula; default 45

  // Sound speed as a function of depth (scene/scene_water.hpp); depth = surface height - z.
  std::string profile = "constant";
  std::optional<std::filesystem::path> profile_file;  ///< file of a table or a cast
  std::optional<double> surface_height_m;             ///< default 0
  std::optional<double> profile_bottom_m;             ///< for a profile by formula: constant below this depth
  std::optional<double> gradient_per_s;
  std::optional<double> munk_axis_m, munk_scale_m, munk_epsilon;
  std::optional<double> profile_error_m_s, profile_step_m;  ///< for sampling a curved profile
  std::optional<double> travel_path_error_m;                ///< by default as docs/environment.md states
  std::optional<double> refraction_tolerance_db;            ///< default 0.1
  int refraction_turns = 1;                                 ///< largest number of turning points of rays

  // Volume scattering strength S_v = 10 log10(s_v / (1 m^-1)), in dB re 1 m^-1; without both keys, the water
  // does not scatter.
  std::optional<double> volume_scattering_db;
  std::optional<std::filesystem::path> volume_scattering_file;  ///< table of layers
};

}  // namespace tubefoot
