// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/gradient_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>

#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/scene_water.hpp"
#include "scene/surfaces/scattering.hpp"

// This file derives the names of the parameters of derivatives from a scene.

namespace tubefoot {
namespace {

/// A line of the list of names: up to three parameters of one owner, which differ in their axis.
struct ParameterFamily {
  std::string stem;  ///< name, without the axis
  std::vector<std::string> axes;
  GradientParameter::Kind kind;
  std::size_t owner;
  std::string units, meaning, key{};
};

/// Adds the parameters of a scattering model: the keys of the material that contain numbers.
void add_scattering(const MaterialDescription& material, std::size_t number,
                    std::vector<ParameterFamily>& families) {
  for (const ScatteringKey& key : scattering_keys(material)) {
    std::vector<std::string> numbers;
    for (std::size_t k = 0; key.is_table && k < material.table_db.size(); ++k)
      numbers.push_back(std::to_string(k));
    families.push_back({fmt::format("material.{}.{}", material.name, key.name), std::move(numbers),
                        GradientParameter::Kind::scattering, number,
                        key.unit == "degrees" ? "J m-2 degree-1" : "J m-2",
                        fmt::format("key {} of the material{}{}", key.name,
                                    key.is_table ? ", by the number of the angle, counted from 0" : "",
                                    key.unit.empty() ? "" : fmt::format(" [{}]", key.unit)),
                        std::string(key.name)});
  }
}

/// Adds the parameters of the sound speed.
void add_sound_speed(const WaterDescription& water, const SceneWater* known,
                     std::vector<ParameterFamily>& families) {
  constexpr const char* per_speed = "J m-2 m-1 s";
  using enum GradientParameter::Kind;
  std::optional<SceneWater> own;
  if (known == nullptr && water.profile != "constant") known = &own.emplace(water);
  const bool refracts = known != nullptr && known->refracts();
  families.push_back({"water.sound_speed",
                      {},
                      sound_speed,
                      0,
                      per_speed,
                      fmt::format("sound speed{} [m/s], for range bins that are intervals of time",
                                  refracts ? ", by an equal increase at all depths" : "")});
  if (!refracts) return;
  if (water.profile == "gradient")
    families.push_back({"water.gradient_per_s",
                        {},
                        profile_gradient,
                        0,
                        "J m-2 s",
                        "gradient of the sound speed [1/s], with the sound speed at the surface fixed"});
  if (water.profile != "table" && water.profile != "cast") return;
  std::vector<std::string> numbers;
  for (std::size_t k = 0; k < known->profile().points().size(); ++k) numbers.push_back(std::to_string(k));
  families.push_back(
      {"water.profile", std::move(numbers), profile, 0, per_speed,
       "sound speed at a point of the profile, by the number of the row, counted from 0 [m/s]"});
}

std::vector<ParameterFamily> families_of(const SceneDescription& description, const SceneWater* water) {
  using enum GradientParameter::Kind;
  using Axes = std::array<const char*, 3>;
  constexpr Axes of_frame{"east", "north", "up"}, own{"x", "y", "z"}, angles{"yaw", "tilt", "roll"};
  constexpr const char *per_metre = "J m-2 m-1", *per_radian = "J m-2 rad-1";
  std::vector<ParameterFamily> families;
  const auto add = [&](const std::string& owner, const char* what, const Axes& axes,
                       GradientParameter::Kind kind, std::size_t number, const char* units,
                       const char* meaning) {
    families.push_back({owner + what, {axes.begin(), axes.end()}, kind, number, units, meaning});
  };
  for (std::size_t s = 0; s < description.sensors.size(); ++s) {
    const SensorDescription& sensor = description.sensors[s];
    add(sensor.name, ".position", of_frame, sonar_position, s, per_metre, "position of the sonar [m]");
    add(sensor.name, ".rotation", own, sonar_rotation, s, per_radian,
        "rotation of the sonar about its own axis (x starboard, y forward, z up) [rad]");
    if (!sensor.look_at_m)
      add(sensor.name, ".mounting", angles, mounting, s, per_radian,
          "mounting angle of the sonar, in the sense of yaw_deg, tilt_deg and roll_deg [rad]");
    add(sensor.name, ".patterns", own, patterns, s, per_radian,
        "rotation of the beam patterns alone about the sonar's own axis [rad]");
  }
  for (std::size_t k = 0; k < description.objects.size(); ++k) {
    const std::string& name = description.objects[k].name;
    add(name, ".position", of_frame, object_position, k, per_metre, "position of the object [m]");
    add(name, ".rotation", own, object_rotation, k, per_radian,
        "rotation of the object about its own axis through its origin [rad]");
  }
  for (std::size_t m = 0; m < description.materials.size(); ++m) {
    if (description.materials[m].model == "lambert")
      families.push_back({fmt::format("material.{}.mu", description.materials[m].name),
                          {},
                          mu,
                          m,
                          "J m-2",
                          "Lambert's parameter of the material, 10^(lambert_db / 10)"});
    else
      add_scattering(description.materials[m], m, families);
  }
  add_sound_speed(description.water, water, families);
  families.push_back({"water.absorption", {}, absorption, 0, "J m-2 km", "one-way absorption [dB/km]"});
  return families;
}

std::string family_text(const ParameterFamily& family) {
  if (family.axes.empty()) return family.stem;
  constexpr std::size_t most = 6;
  return family.axes.size() <= most
             ? fmt::format("{}.{}", family.stem, fmt::join(family.axes, "|"))
             : fmt::format("{}.{}|...|{}", family.stem, family.axes.front(), family.axes.back());
}

std::string all_names(const SceneDescription& description, const SceneWater* water) {
  constexpr std::size_t most = 40;
  std::string names;
  const std::vector<ParameterFamily> families = families_of(description, water);
  for (std::size_t k = 0; k < std::min(most, families.size()); ++k)
    names += (k == 0 ? "" : ", ") + family_text(families[k]);
  if (families.size() > most) names += fmt::format(", and {} more lines", families.size() - most);
  return names;
}

}  // namespace

std::vector<GradientParameter> gradient_parameters(const SceneDescription& description,
                                                   const SceneWater* water) {
  std::vector<GradientParameter> parameters;
  for (const ParameterFamily& family : families_of(description, water)) {
    const auto add = [&](const std::string& axis, int number) {
      parameters.push_back(
          {family.stem + axis, family.kind, family.owner, number, family.units, family.meaning, family.key});
    };
    if (family.axes.empty()) add("", 0);
    for (std::size_t axis = 0; axis < family.axes.size(); ++axis)
      add("." + family.axes[axis], static_cast<int>(axis));
  }
  return parameters;
}

std::vector<GradientParameter> gradient_parameters(const SceneDescription& description,
                                                   const std::vector<std::string>& names,
                                                   const SceneWater* water) {
  std::vector<GradientParameter> chosen;
  if (names.empty()) return chosen;
  const std::vector<GradientParameter> all = gradient_parameters(description, water);
  for (const std::string& name : names) {
    const auto found = std::ranges::find(all, name, &GradientParameter::name);
    if (found == all.end()) {
      std::vector<std::string> known;
      for (const GradientParameter& parameter : all) known.push_back(parameter.name);
      const std::string_view similar = nearest(name, known);
      throw UsageError(
          fmt::format("--gradient: there is no parameter '{}'{}: the parameters of the scene are {}",
                      shown(name), similar.empty() ? "" : fmt::format(" (did you mean '{}'?)", similar),
                      shown(all_names(description, water))));
    }
    if (std::ranges::find(chosen, name, &GradientParameter::name) != chosen.end())
      throw UsageError(
          fmt::format("--gradient: the list contains the parameter '{}' twice: name it once", shown(name)));
    if (std::ranges::count(all, name, &GradientParameter::name) > 1)
      throw UsageError(fmt::format(
          "--gradient: '{}' is a parameter of a sensor and of an object: rename one of them", shown(name)));
    if (name.find('/') != std::string::npos)
      throw UsageError(
          fmt::format("--gradient: the names of variables in echoes.nc cannot contain '/' as in '{}': rename "
                      "the owner of "
                      "the parameter",
                      shown(name)));
    chosen.push_back(*found);
  }
  return chosen;
}

std::vector<std::string> gradient_names(const std::string& list) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t comma = std::min(list.find(',', begin), list.size());
    names.push_back(list.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return names;
}

std::string gradient_help(const SceneDescription& description) {
  const std::vector<ParameterFamily> families = families_of(description, nullptr);
  std::size_t width = 0;
  for (const ParameterFamily& family : families) width = std::max(width, family_text(family).size());
  std::string help;
  for (const ParameterFamily& family : families)
    help += fmt::format("{:<{}}  {}; unit of derivatives: {}\n", family_text(family), width, family.meaning,
                        family.units);
  return help;
}

}  // namespace tubefoot
