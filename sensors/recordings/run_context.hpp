// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "scene/description/water_description.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/scene_water.hpp"

namespace tubefoot {

/// The pictures that a run writes in addition to its files, and their form.
struct PictureSettings {
  enum class Which {
    none,
    sequence,  ///< pictures that show several pings at once
    all,       ///< in addition one picture per ping, for sonars that display single pings
  };
  std::optional<Which> which{};  ///< unset: by the sensor's setting, or all
  int bits = 8;                  ///< of a PNG's components, 8 or 16
  bool animated = false;         ///< adds an animated GIF of a sequence of pings

  bool wants(Which least, Which otherwise = Which::all) const { return which.value_or(otherwise) >= least; }
};

/// Names of products (SensorKind::products()) that a sensor does not write, by request of the user.
using OmittedProducts = std::set<std::string, std::less<>>;

/// Data of a run that the files of a recording need.
struct RunContext {
  LocalFrame frame;         ///< place of the scene on Earth, if it is georeferenced
  double start_unix_s = 0;  ///< UTC of the recording's time 0
  std::uint64_t seed = 1;   ///< of speckle and noise
  WaterDescription water;
  std::string title;
  PictureSettings pictures{};
  bool with_bounds = false;  ///< reference run: adds bounds to energies and signals
  /// The water that rays cross, for the conversion of travel times and angles into positions. Null:
  /// isovelocity, with the recording's sound speed.
  std::shared_ptr<const SceneWater> layered_water{};
  OmittedProducts omitted{};  ///< of the sensor whose files are written

  bool writes(std::string_view product) const { return !omitted.contains(product); }
  /// True for a product that is one of the pictures of this kind.
  bool draws(std::string_view product,
             PictureSettings::Which least = PictureSettings::Which::sequence) const {
    return pictures.wants(least) && writes(product);
  }
};

}  // namespace tubefoot
