// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

struct RunDescription {
  SourcePlace place;
  std::string start_utc = "2000-01-01T00:00:00Z";  ///< UTC at time 0 of the scene (unix_time_s)
  std::string engine = "tube";                     ///< tube | ray
  std::string arithmetic = "fixed";                ///< fixed | filtered | rational | double
  std::string binning = "exact";  ///< exact | spread | centroid: assignment of footprints to range samples
  std::int64_t facets_per_split = 64;  ///< VisibilityOptions::facets_per_split
  double zero_tolerance = 0;           ///< VisibilityOptions::tolerance, for arithmetic "double"
  std::string sampling =
      "stratified";  ///< ray engine: stratified | sobol | adaptive | regular | random | column
  std::int64_t rays_per_ping = 100000;        ///< ray engine
  std::optional<std::int64_t> rays_per_beam;  ///< ray engine: instead of rays_per_ping
  std::uint64_t seed = 1;
  std::optional<int> grid_exponent;  ///< grid unit 2^-k m
  int threads = 0;                   ///< 0 means all cores
  int terrain_cache_mb = 512;        ///< for terrain that is read by tiles
};

}  // namespace tubefoot
