// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/input_error.hpp"
#include "scene/description/reflectivity_description.hpp"
#include "scene/description/relief_description.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

struct MaterialDescription {
  SourcePlace place;
  std::string name;
  double lambert_db = -27;        ///< 10 log10 mu; energy conservation requires <= -4.9715
  std::string model = "lambert";  ///< lambert | gsab | table | sediment; docs/environment.md
  std::optional<double> specular_db, specular_width_deg;      ///< gsab: A and B
  std::optional<double> oblique_db, oblique_exponent;         ///< gsab: C and D
  std::optional<double> transition_db, transition_width_deg;  ///< gsab: E and F
  std::vector<double> table_grazing_deg, table_db;            ///< table, in the scene file
  std::optional<std::filesystem::path> table_file;            ///< table in a separate file
  std::optional<std::string> sediment;                        ///< name of the sediment
  double sediment_khz = 300;                                  ///< frequency of the sediment's table
  bool unbounded = false;                                     ///< permits more scattered than received energy
  std::vector<ReliefDescription> relief;                      ///< summed; if empty, facets are flat
  std::vector<ReflectivityDescription> reflectivity;          ///< multiplied; if empty, uniform
  std::optional<double> specular_loss_db;  ///< loss of reflections; if empty, the material is no mirror
  bool smooth = false;                     ///< signals have its coherent amplitude; docs/signals.md
  double reflection = 1;   ///< smooth: reflection coefficient of pressure; +1 rigid, -1 pressure release
  double roughness_m = 0;  ///< smooth: standard deviation of the height
  /// smooth: half-space of a fluid; density and sound speed relative to the water's, attenuation in dB per
  /// wavelength
  std::optional<std::array<double, 3>> fluid;
  std::optional<double> grain_size_phi;  ///< smooth: fluid seabed from its mean grain size
};

}  // namespace tubefoot
