// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "engine/rays/ray_engine.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Returns the ray settings of a transmission. Each ping draws its own sample, so that the errors of
/// neighbouring pings are independent.
RaySettings rays_of(const Transmission& transmission);

/// Returns the criteria of adaptive rays for a transmission. These are the shortest range sample of its
/// sensors, and the scattering of its materials at 45 degrees for any scattering model.
RayGuide guide_of(const Transmission& transmission);

/// The surface of a transmission, prepared for rays.
class RaySurface {
 public:
  explicit RaySurface(const Transmission& transmission)
      : RaySurface(transmission, transmission.surface_mesh()) {}
  /// Prepares another surface of the transmission.
  RaySurface(const Transmission& transmission, const TransmissionSurface& surface)
      : loaded_scene_(transmission.loaded_scene()) {
    if (!surface.is_of_loaded_scene()) own_.emplace(surface.mesh(), transmission.scene().grid);
  }
  const RayScene& operator*() const { return own_ ? *own_ : loaded_scene_.rays(); }

 private:
  const LoadedScene& loaded_scene_;
  std::optional<RayScene> own_;
};

}  // namespace tubefoot
