// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "engine/rays/ray_engine.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// The rays of a transmission: every ping draws its own sample, so that errors of neighbours are independent.
RaySettings rays_of(const Transmission& transmission);

/// What adaptive rays of a transmission go by: the shortest range samples of its sensors, and how bright its
/// materials are, whatever their law, at 45 degrees.
RayGuide guide_of(const Transmission& transmission);

/// A transmission's ground, made ready for rays.
class RaySurface {
 public:
  explicit RaySurface(const Transmission& transmission) : loaded_scene_(transmission.loaded_scene()) {
    if (transmission.surface_mesh().is_own())
      own_.emplace(transmission.surface_mesh().mesh(), transmission.scene().grid);
  }
  const RayScene& operator*() const { return own_ ? *own_ : loaded_scene_.rays(); }

 private:
  const LoadedScene& loaded_scene_;
  std::optional<RayScene> own_;
};

}  // namespace tubefoot
