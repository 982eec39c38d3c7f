// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/water/water_column.hpp"
#include "scene/description/water_description.hpp"

namespace tubefoot {

/// One-way absorption of isovelocity water at a frequency, dB/km, as the description says.
double absorption_db_per_km(const WaterDescription& water, double frequency_khz);

/// A scene's water: the sound-speed profile, and the absorption of each of its layers.
class SceneWater {
 public:
  /// Reads the profile's file if there is one. Throws InputError: at the file's line and column, or at the
  /// description's place.
  explicit SceneWater(const WaterDescription& description);

  const SoundSpeedProfile& profile() const { return profile_; }
  bool refracts() const { return !profile_.is_constant(); }
  /// Height of the sea surface in the local frame: depth = this - z.
  double surface_height_m() const { return description_.surface_height_m.value_or(0); }
  /// The profile with absorption: by the model at each layer's middle, from the cast's temperature and
  /// salinity there if it is a cast's; or the description's own figure.
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
