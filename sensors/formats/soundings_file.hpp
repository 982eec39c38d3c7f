// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "scene/rasters/georeference.hpp"
#include "sensors/detection/sounding.hpp"

namespace tubefoot {

/// A file of soundings (docs/soundings.md), the ending chooses: .csv (text, units and signs in the header
/// line) or .gpkg (GeoPackage, layer "soundings" of 3-D points in the scene's CRS: the projected one;
/// longitude and latitude on WGS 84 for a tangent frame; local metres without georeference). Written in
/// batches; the file is taken away without finish().
class SoundingsFile {
 public:
  /// Throws std::invalid_argument for another ending, std::runtime_error naming the file.
  SoundingsFile(const std::filesystem::path& file, const LocalFrame& frame);
  ~SoundingsFile();

  /// Best many at a time: all beams of a ping. `on_earth`: longitude, latitude and height of each, from who
  /// has them already: of all that are added, or of none. Throws std::runtime_error where writing fails,
  /// InputError for a sounding that has no place on Earth.
  void add(std::span<const Sounding> soundings, std::span<const glm::dvec3> on_earth = {});
  /// Completes the file; throws std::runtime_error where that fails.
  void finish();

  class Writer;

 private:
  std::unique_ptr<Writer> writer_;
};

}  // namespace tubefoot
