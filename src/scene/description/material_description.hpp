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

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

struct MaterialDescription {
  SourcePlace place;
  std::string name;
  double lambert_db = -27;        ///< 10 log10 mu; energy conservation wants <= -4.9715
  std::string model = "lambert";  ///< lambert | gsab | table | sediment; docs/scattering.md
  std::optional<double> specular_db, specular_width_deg;      ///< gsab: A and B
  std::optional<double> oblique_db, oblique_exponent;         ///< gsab: C and D
  std::optional<double> transition_db, transition_width_deg;  ///< gsab: E and F
  std::vector<double> table_grazing_deg, table_db;            ///< table, in the scene file
  std::optional<std::filesystem::path> table_file;            ///< table, apart
  std::optional<std::string> sediment;                        ///< sediment: its name
  double sediment_khz = 300;                                  ///< sediment: frequency of its table
  bool unbounded = false;                                     ///< may scatter more than it receives
  std::vector<ReliefDescription> relief;                      ///< their sum; none: facets are flat
  std::vector<ReflectivityDescription> reflectivity;          ///< their product; none: even
  std::optional<double> specular_loss_db;  ///< of what it mirrors; none: it mirrors nothing
  bool smooth = false;                     ///< signals have its coherent amplitude; docs/smooth-surfaces.md
  double reflection = 1;                   ///< smooth: of pressure; +1 rigid, -1 pressure release
  double roughness_m = 0;                  ///< smooth: standard deviation of its height
  /// smooth: a half-space of a fluid; density and sound speed over the water's, attenuation in dB a
  /// wavelength.
  std::optional<std::array<double, 3>> fluid;
  std::optional<double> grain_size_phi;  ///< smooth: a fluid seabed by its mean grain size
};

}  // namespace tubefoot
