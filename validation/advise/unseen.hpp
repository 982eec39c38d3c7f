// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "advice/advice.hpp"

namespace tubefoot {

/// Pings that advice has not seen, with exact cuts to hold settings against. Where a sensor has none left,
/// all sensors are moved and turned a little: `moved_places` times, by decimetres and degrees.
class UnseenPings {
 public:
  static constexpr int moved_places = 3;

  /// At most `count` pings of each sensor and place. Throws as TrialScene does.
  UnseenPings(const SceneDescription& scene, const std::vector<LookedAt>& seen, std::size_t count);

  /// "8 other pings a sensor" or "3 other places".
  const std::string& what() const { return what_; }
  std::size_t beams() const { return places_.front()->beams(); }

  /// With a seed that no advice uses. Errors are those of all these pings together, of the worst sensor;
  /// seconds those of a ping.
  Trial run(EngineSetting setting, int repeats);

 private:
  std::vector<std::unique_ptr<TrialScene>> places_;
  std::string what_;
};

/// Every sampling that advice considers on rungs of rays 1.25 apart, from 32 a beam on, up to `seconds` a
/// ping or `most_rays` a beam; with their settings.
struct Measured {
  EngineSetting setting;
  Trial trial;
};
std::vector<Measured> fine_ladder(UnseenPings& pings, const std::string& sampling, int repeats,
                                  double seconds, double most_rays);

}  // namespace tubefoot
