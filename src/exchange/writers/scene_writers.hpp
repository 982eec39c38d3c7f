// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "exchange/exchanged_scene.hpp"

namespace tubefoot {

/// Files that were written into a folder.
struct WrittenScene {
  std::vector<std::string> files;  ///< names in the folder, the main file first
  std::vector<std::string> notes;  ///< properties that the engine cannot represent exactly, one line each
};

/// Writes the scene for an engine into an existing folder. README.txt describes properties that the file of
/// the engine cannot represent. Throws std::runtime_error on a write error.
WrittenScene write_scene(ExchangeFormat format, const ExchangedScene& scene,
                         const std::filesystem::path& folder);

// Writers of each format, without README.txt.
WrittenScene write_obj_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_gltf_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_sdf_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_stonefish_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_holoocean_scene(const ExchangedScene& scene, const std::filesystem::path& folder);

/// Describes the conversion of axes in a few lines, for a comment in each file.
std::string axes_words(ExchangeFormat format);
/// Writes one OBJ per piece, in the world axes of an engine. Returns the file names.
std::vector<std::string> write_piece_meshes(ExchangeFormat format, const ExchangedScene& scene,
                                            const std::filesystem::path& folder);
/// Range bins for an engine that uses the minimum range as its near clipping plane. Bins in front of those of
/// the sonar keep nearer surfaces in the picture, so that these surfaces cast shadows.
struct EngineRanges {
  double range_min_m = 0, range_max_m = 0;
  int samples = 0;
  int nearer = 0;   ///< bins in front of those of the sonar; negative: missing bins of the sonar
  int farther = 0;  ///< bins behind those of the sonar
};
/// `least_m`: smallest minimum range of the engine. `even`: the engine needs an even number of bins.
EngineRanges engine_ranges(const ExchangedSonar& sonar, double least_m, bool even);
/// Describes the difference between both divisions into bins; empty without a difference.
std::string ranges_words(const ExchangedSonar& sonar, const EngineRanges& ranges);

/// Returns a placement whose forward axis is at this azimuth of the given one, starboard positive.
Placement turned_to(const Placement& ours, double azimuth_rad);

/// Returns a grey value from 0.1 to 0.9 that increases with the backscattering strength of a material.
double grey_of(const ExchangedMaterial& material);

}  // namespace tubefoot
