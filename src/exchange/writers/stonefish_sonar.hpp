// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "exchange/writers/scene_writers.hpp"

namespace tubefoot {

/// Range bins of a sonar in Stonefish, whose minimum range is at least 0.02 m and whose number of bins is
/// even.
EngineRanges stonefish_ranges(const ExchangedSonar& sonar);

/// A fan as an FLS of Stonefish, which has an even number of beams.
struct StonefishFan {
  int beams = 0;
  double width_deg = 0;
  Placement placement;
  bool added = false;  ///< the last beam is not a beam of the sonar
};
StonefishFan stonefish_fan(const ExchangedSonar& sonar);

/// Writes the scene as Stonefish's FLS sees it, a scene for its solid angles, and the output model. Does
/// nothing but a note if a sonar is not an FLS.
void add_stonefish_reference(const ExchangedScene& scene, const std::vector<std::string>& meshes,
                             const std::filesystem::path& folder, WrittenScene& written);

}  // namespace tubefoot
