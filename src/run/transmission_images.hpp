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

/// Whether [paths] asks for paths of that order.
bool is_order_wanted(const Scene& scene, std::size_t order);

/// Where a sensor's own paths begin and end: its range says how far they go.
struct PathEnds {
  TubeSet transmit, receive;
  PathEnds(const Transmission& transmission, std::size_t sensor);
};

/// The images of a transmission's ends, for what a sensor receives over mirrors and scattered once. The
/// transmission outlives them.
class TransmissionImages {
 public:
  /// `settings`: path_settings() of the sensor. `open_water`: whether images tell what they see of it,
  /// `weights` as TransmissionEnds(). Throws InputError where there are too many images, or facets.
  TransmissionImages(const Transmission& transmission, std::size_t sensor, PathSettings settings,
                     PathEnds ends, bool open_water = false, bool weights = false);
  TransmissionImages(const TransmissionImages&) = delete;
  TransmissionImages& operator=(const TransmissionImages&) = delete;

  const PathSettings& settings() const { return settings_; }
  const PathEnds& ends() const { return ends_; }
  /// Where it lies.
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

/// Calls `use` with what holds of the paths of a transmission that are scattered once over mirrors, for each
/// of its sensors that has any; of a receiver pair for each of its fans and ends. `label` as
/// Transmission::audit(). Throws as TransmissionImages.
void audit_paths(const Transmission& transmission, std::uint64_t label,
                 const std::function<void(const PathAudit&)>& use);

}  // namespace tubefoot
