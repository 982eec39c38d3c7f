// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tubefoot {

class SceneWater;
struct SceneDescription;

/// A parameter of a scene by which a run differentiates energies (docs/gradients.md).
struct GradientParameter {
  enum class Kind {
    sonar_position,
    sonar_rotation,
    mounting,
    patterns,
    object_position,
    object_rotation,
    mu,
    scattering,
    sound_speed,
    profile,           ///< sound speed at one point of the profile
    profile_gradient,  ///< of the profile "gradient"
    absorption
  };
  std::string name;
  Kind kind{};
  std::size_t owner = 0;  ///< number of the sensor, object or material in the description
  /// East, north, up; or x, y, z; or yaw, tilt, roll; or number in a table or in a profile.
  int axis = 0;
  std::string units;    ///< of a derivative, without decibels, which UDUNITS does not know
  std::string meaning;  ///< of the parameter, with its unit
  std::string key{};    ///< scattering: key of the material

  bool is_of_sonar() const { return kind <= Kind::patterns; }
  bool is_of_object() const { return kind == Kind::object_position || kind == Kind::object_rotation; }
  bool is_of_sound_speed() const { return kind >= Kind::sound_speed && kind <= Kind::profile_gradient; }
  bool is_translation() const { return kind == Kind::sonar_position || kind == Kind::object_position; }
  /// Whether the parameter moves walls of tubes or facets, so that visible polygons depend on it.
  bool moves_points() const { return kind <= Kind::mounting || is_of_object(); }
};

/// Returns all parameters of a scene. `water`: of this scene; null: the function reads the file of the
/// profile if there is one, and throws the errors of SceneWater.
std::vector<GradientParameter> gradient_parameters(const SceneDescription& description,
                                                   const SceneWater* water = nullptr);

/// Returns the parameters with these names. Throws UsageError for an unknown or repeated name; the message
/// contains the most similar name and all names.
std::vector<GradientParameter> gradient_parameters(const SceneDescription& description,
                                                   const std::vector<std::string>& names,
                                                   const SceneWater* water = nullptr);

/// Splits the value of --gradient at commas.
std::vector<std::string> gradient_names(const std::string& list);

/// Returns all names of a scene with their meanings, one line for each kind and owner.
std::string gradient_help(const SceneDescription& description);

}  // namespace tubefoot
