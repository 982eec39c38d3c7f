// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/water/water_column.hpp"
#include "scene/description/water_description.hpp"

namespace tubefoot {

/// Returns the one-way absorption of isovelocity water at a frequency in dB/km, as described.
double absorption_db_per_km(const WaterDescription& water, double frequency_khz);

/// The water of a scene: the sound-speed profile, and the absorption of each of its layers.
class SceneWater {
 public:
  /// Reads the file of the profile if there is one. Throws InputError at the line and column of the file,
  /// or at the place of the description.
  explicit SceneWater(const WaterDescription& description);

  const SoundSpeedProfile& profile() const { return profile_; }
  bool refracts() const { return !profile_.is_constant(); }
  /// Returns the height of the sea surface in the local frame; depth = this height - z.
  double surface_height_m() const { return description_.surface_height_m.value_or(0); }
  /// Returns whether both waters have the same sound speed at every height.
  bool has_same_speeds(const SceneWater& other) const;
  /// Returns the profile with the absorption of each layer. The absorption is the value of the description,
  /// or that of the model at the middle of the layer. For a cast, the model uses the cast's temperature and
  /// salinity there.
  WaterColumn column(double frequency_khz) const;

 private:
  struct Cast {
    double depth_m, temperature_c, salinity_psu;
  };

  std::vector<ProfilePoint> read_table() const;
  std::vector<ProfilePoint> read_cast();
  std::vector<ProfilePoint> points();

  WaterDescription description_;
  std::vector<Cast> cast_;
  SoundSpeedProfile profile_{1500};
};

}  // namespace tubefoot
