// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "advice/advice.hpp"

namespace tubefoot {

/// Pings that the advice did not use, with exact cuts as the reference. If a sensor has no further pings,
/// all sensors are displaced and rotated by decimetres and degrees, `moved_places` times.
class UnseenPings {
 public:
  static constexpr int moved_places = 3;

  /// Takes at most `count` pings per sensor and place. Throws as TrialScene does.
  UnseenPings(const SceneDescription& scene, const std::vector<LookedAt>& seen, std::size_t count);

  /// "8 other pings per sensor" or "3 other positions".
  const std::string& what() const { return what_; }
  std::size_t beams() const { return places_.front()->beams(); }

  /// Runs a setting with a seed that advice does not use. Errors are those of all pings together, for the
  /// worst sensor. Seconds are those of one ping.
  Trial run(EngineSetting setting, int repeats);

 private:
  std::vector<std::unique_ptr<TrialScene>> places_;
  std::string what_;
};

/// Setting and trial of a sampling. fine_ladder() increases the rays from 32 per beam by factors of 1.25.
/// It ends at `seconds` per ping or `most_rays` per beam.
struct Measured {
  EngineSetting setting;
  Trial trial;
};
std::vector<Measured> fine_ladder(UnseenPings& pings, RaySampling sampling, int repeats, double seconds,
                                  double most_rays);

}  // namespace tubefoot
