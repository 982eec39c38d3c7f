// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "run/loaded_scene.hpp"
#include "run/tiles_in_view.hpp"

namespace tubefoot {

/// A site with some tiles, and what transmissions ask of its facets; no tree yet.
std::unique_ptr<LoadedScene> loaded_with(const LoadedScene& loaded_scene, const TileChoice& choice);

/// The facets above and below one place after the other: of a tiled site with the tiles that lie there.
/// surface_in_line_with() then has the relief.
class SceneBelow {
 public:
  explicit SceneBelow(const LoadedScene& loaded_scene);
  /// Until the next call. Not cut at the sea surface where tiles were loaded for it.
  const LoadedScene& in_line_with(glm::dvec3 place_m);

 private:
  const LoadedScene& loaded_scene_;
  std::optional<TilesInView> tiles_;
  TileChoice choice_;
  std::unique_ptr<LoadedScene> part_;
};

}  // namespace tubefoot
