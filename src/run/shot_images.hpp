// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "engine/paths/path_audit.hpp"
#include "engine/paths/path_images.hpp"
#include "run/paths.hpp"
#include "run/shot.hpp"

namespace tubefoot {

/// Whether [paths] asks for paths of that order.
bool is_order_wanted(const Scene& scene, std::size_t order);

/// Where a sensor's own paths begin and end: its range says how far they go.
struct PathEnds {
  TubeSet transmit, receive;
  PathEnds(const Shot& shot, std::size_t sensor);
};

/// The images of a shot's ends, for what a sensor hears over mirrors and scattered once. The shot outlives
/// them.
class ShotImages {
 public:
  /// `settings`: path_settings() of the sensor. `open_water`: whether images tell what they see of it,
  /// `weights` as ShotEnds(). Throws InputError where there are too many images, or facets.
  ShotImages(const Shot& shot, std::size_t sensor, PathSettings settings, PathEnds ends,
             bool open_water = false, bool weights = false);
  ShotImages(const ShotImages&) = delete;
  ShotImages& operator=(const ShotImages&) = delete;

  const PathSettings& settings() const { return settings_; }
  const PathEnds& ends() const { return ends_; }
  /// Where it lies.
  const ShotGround& ground() const { return lying_ ? *lying_ : shot_.ground(); }
  const PathImages& images() const { return *images_; }

 private:
  const Shot& shot_;
  PathSettings settings_;
  PathEnds ends_;
  std::optional<ShotGround> lying_;
  std::optional<PathWater> water_;
  std::unique_ptr<const PathImages> images_;
};

/// Calls `use` with what holds of the paths of a shot that are scattered once over mirrors, for each of its
/// sensors that has any; of a staff for each of its fans and ends. `label` as Shot::audit(). Throws as
/// ShotImages.
void audit_paths(const Shot& shot, std::uint64_t label, const std::function<void(const PathAudit&)>& use);

}  // namespace tubefoot
