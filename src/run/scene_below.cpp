// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/scene_below.hpp"

namespace tubefoot {

std::unique_ptr<LoadedScene> loaded_with(const LoadedScene& loaded_scene, const TileChoice& choice) {
  auto part = std::make_unique<LoadedScene>(with_tiles(loaded_scene.scene, choice));
  part->relief = loaded_scene.relief;
  if (loaded_scene.relief.cell_m > 0) part->surface_mesh = relief_surface(part->scene, resting_facets(*part));
  return part;
}

SceneBelow::SceneBelow(const LoadedScene& loaded_scene) : loaded_scene_(loaded_scene) {
  if (loaded_scene.is_tiled()) tiles_.emplace(loaded_scene);
}

const LoadedScene& SceneBelow::in_line_with(glm::dvec3 place_m) {
  if (!tiles_) return loaded_scene_;
  TileChoice choice = tiles_->below(place_m);
  if (!part_ || choice != choice_) {
    choice_ = std::move(choice);
    part_ = loaded_with(loaded_scene_, choice_);
    build_tree(*part_, SceneTree::HeightFieldSearch::ignored);
  }
  return *part_;
}

}  // namespace tubefoot
