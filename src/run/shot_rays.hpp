// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "engine/rays/ray_engine.hpp"
#include "run/shot.hpp"

namespace tubefoot {

/// The rays of a shot: every ping draws its own sample, so that errors of neighbours are independent.
RaySettings rays_of(const Shot& shot);

/// What adaptive rays of a shot go by: the shortest range samples of its sensors, and how bright its
/// materials are, whatever their law, at 45 degrees.
RayGuide guide_of(const Shot& shot);

/// A shot's ground, made ready for rays.
class RayGround {
 public:
  explicit RayGround(const Shot& shot) : site_(shot.site()) {
    if (shot.ground().is_own()) own_.emplace(shot.ground().mesh(), shot.scene().grid);
  }
  const RayScene& operator*() const { return own_ ? *own_ : site_.rays(); }

 private:
  const Site& site_;
  std::optional<RayScene> own_;
};

}  // namespace tubefoot
