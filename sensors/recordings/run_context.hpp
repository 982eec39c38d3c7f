// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "scene/description/water_description.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/scene_water.hpp"

namespace tubefoot {

/// Which pictures a run writes beside its files, and how.
struct PictureSettings {
  enum class Which {
    none,
    sequence,  ///< those that show several pings at once
    all,       ///< and one of each ping, where that is what the sonar shows
  };
  std::optional<Which> which{};  ///< unset: as the sensor says, else all
  int bits = 8;                  ///< of a PNG's components, 8 or 16
  bool animated = false;         ///< sequences of pings as a GIF as well

  bool wants(Which least, Which otherwise = Which::all) const { return which.value_or(otherwise) >= least; }
};

/// What the files of a recording need to know of its run.
struct RunContext {
  LocalFrame frame;         ///< where the scene lies on Earth, if it says so
  double start_unix_s = 0;  ///< UTC of the recording's time 0
  std::uint64_t seed = 1;   ///< of speckle and noise
  WaterDescription water;
  std::string title;
  PictureSettings pictures{};
  bool with_bounds = false;  ///< of a reference run: bounds beside energies and signals
  /// The water that rays pass, by which travel times and angles become places; null: uniform, with the
  /// recording's sound speed.
  std::shared_ptr<const SceneWater> layered_water{};
};

}  // namespace tubefoot
