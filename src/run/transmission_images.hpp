// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "engine/paths/path_audit.hpp"
#include "engine/paths/path_images.hpp"
#include "run/paths.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Returns whether [paths] requests paths of that order.
bool is_order_wanted(const Scene& scene, std::size_t order);

/// Start and end of a sensor's own paths. The range of the sensor limits their length.
struct PathEnds {
  TubeSet transmit, receive;
  PathEnds(const Transmission& transmission, std::size_t sensor);
};

/// The images of a transmission's ends, for echoes that a sensor receives over mirrors with one scattering.
/// The transmission must outlive this object.
class TransmissionImages {
 public:
  /// `settings`: path_settings() of the sensor. `open_water`: whether images report their unobstructed
  /// region. `weights`: see TransmissionEnds(). Throws InputError if there are too many images or facets.
  TransmissionImages(const Transmission& transmission, std::size_t sensor, PathSettings settings,
                     PathEnds ends, bool open_water = false, bool weights = false);
  TransmissionImages(const TransmissionImages&) = delete;
  TransmissionImages& operator=(const TransmissionImages&) = delete;

  const PathSettings& settings() const { return settings_; }
  const PathEnds& ends() const { return ends_; }
  /// Returns the surface at its true position.
  const TransmissionSurface& surface_mesh() const { return lying_ ? *lying_ : transmission_.surface_mesh(); }
  const PathImages& images() const { return *images_; }

 private:
  const Transmission& transmission_;
  PathSettings settings_;
  PathEnds ends_;
  std::optional<TransmissionSurface> lying_;
  std::optional<PathWater> water_;
  std::unique_ptr<const PathImages> images_;
};

/// Calls `use` with the audit of the paths of a transmission that have one scattering and pass mirrors. It
/// does so for each sensor with such paths, and for each fan and end of a receiver pair. `label`: see
/// Transmission::audit(). Throws the errors of TransmissionImages.
void audit_paths(const Transmission& transmission, std::uint64_t label,
                 const std::function<void(const PathAudit&)>& use);

}  // namespace tubefoot
