// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "run/loaded_scene.hpp"
#include "run/tiles_in_view.hpp"

namespace tubefoot {

/// Returns a loaded scene with some tiles, and with the data that transmissions need of its facets. It has
/// no tree yet.
std::unique_ptr<LoadedScene> loaded_with(const LoadedScene& loaded_scene, const TileChoice& choice);

/// The facets above and below given positions, one position after another. For a tiled scene, loads the
/// tiles at the position. surface_in_line_with() then adds the relief.
class SceneBelow {
 public:
  explicit SceneBelow(const LoadedScene& loaded_scene);
  /// Returns the scene at a position. The result stays valid until the next call. The sea surface does not
  /// cut the tiles that this call loads.
  const LoadedScene& in_line_with(glm::dvec3 place_m);

 private:
  const LoadedScene& loaded_scene_;
  std::optional<TilesInView> tiles_;
  TileChoice choice_;
  std::unique_ptr<LoadedScene> part_;
};

}  // namespace tubefoot
