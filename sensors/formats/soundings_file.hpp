// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "scene/rasters/georeference.hpp"
#include "sensors/detection/sounding.hpp"

namespace tubefoot {

/// A file of soundings (docs/output-files.md); its extension selects the format. A .csv file is text with
/// units and signs in the header line. A .gpkg file is a GeoPackage with the layer "soundings" of 3-D points
/// in the scene's CRS. The CRS is the projected one, longitude and latitude on WGS 84 for a tangent frame, or
/// local metres without georeference. Soundings are written in batches. Without finish() the file is removed.
class SoundingsFile {
 public:
  /// Throws std::invalid_argument for another extension, and std::runtime_error with the file's name.
  /// `sectors`: adds the transmit sector of each sounding as the last column.
  SoundingsFile(const std::filesystem::path& file, const LocalFrame& frame, bool sectors = false);
  ~SoundingsFile();

  /// Adds soundings; larger batches, such as all beams of a ping, are faster. `on_earth` has longitude,
  /// latitude and height of each sounding if the caller knows them. It must be given for all soundings of
  /// the file or for none. Throws std::runtime_error if writing fails, and InputError for a sounding without
  /// a place on Earth.
  void add(std::span<const Sounding> soundings, std::span<const glm::dvec3> on_earth = {});
  /// Completes the file. Throws std::runtime_error if that fails.
  void finish();

  class Writer;

 private:
  std::unique_ptr<Writer> writer_;
};

}  // namespace tubefoot
