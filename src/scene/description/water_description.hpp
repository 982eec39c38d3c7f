// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

struct WaterDescription {
  SourcePlace place;
  std::optional<double> sound_speed_m_s;       ///< else Mackenzie 1981 from T, S and depth
  std::optional<double> absorption_db_per_km;  ///< else Francois-Garrison 1982 at the sensor's frequency
  double temperature_c = 10, salinity_psu = 35, ph = 8;
  double depth_m = 10;  ///< for the two formulas
  std::string sound_speed_formula = "mackenzie", absorption_model = "francois-garrison";
  std::optional<double> latitude_deg;  ///< for Leroy's formula; else 45

  // How sound speed changes with depth (scene/scene_water.hpp); depth = surface height - z.
  std::string profile = "constant";
  std::optional<std::filesystem::path> profile_file;  ///< of a table or a cast
  std::optional<double> surface_height_m;             ///< else 0
  std::optional<double> profile_bottom_m;             ///< of a profile by formula: constant below
  std::optional<double> gradient_per_s;
  std::optional<double> munk_axis_m, munk_scale_m, munk_epsilon;
  std::optional<double> profile_error_m_s, profile_step_m;  ///< of sampling a curved profile
  std::optional<double> travel_path_error_m;                ///< else as docs/refraction.md says
  std::optional<double> refraction_tolerance_db;            ///< else 0.1
  int refraction_turns = 1;                                 ///< most turning points of rays that are followed
};

}  // namespace tubefoot
