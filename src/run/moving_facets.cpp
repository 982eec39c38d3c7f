// SPDX-License-Identifier: GPL-3.0-or-later

// Makes the facets and the tree of a scene with moving objects at the time of a transmission.

#include "run/moving_facets.hpp"

#include <mutex>
#include <vector>

#include "run/loaded_scene.hpp"
#include "scene/moving_objects.hpp"

namespace tubefoot {
namespace {

FacetMesh facets_at_rest(const Scene& scene) {
  FacetMesh mesh = scene.mesh;
  drop_moving(scene, mesh);
  return mesh;
}

}  // namespace

/// Copies of the mesh that no transmission uses.
struct MovingFacets::Copies {
  std::mutex mutex;
  std::vector<std::unique_ptr<FacetMesh>> free;

  std::unique_ptr<FacetMesh> taken() {
    const std::lock_guard lock(mutex);
    if (free.empty()) return nullptr;
    std::unique_ptr<FacetMesh> mesh = std::move(free.back());
    free.pop_back();
    return mesh;
  }
  void put_back(std::unique_ptr<FacetMesh> mesh) {
    const std::lock_guard lock(mutex);
    free.push_back(std::move(mesh));
  }
};

MovingFacets::MovingFacets(const Scene& scene, SceneTree::HeightFieldSearch height_fields)
    : scene_(scene),
      at_rest_(facets_at_rest(scene)),
      tree_at_rest_(std::make_shared<const SceneTree>(at_rest_, height_fields)),
      first_(first_moving_facet(scene, scene.mesh)),
      copies_(std::make_shared<Copies>()) {}

MovedFacets MovingFacets::at(double time_s) const {
  std::unique_ptr<FacetMesh> mesh = copies_->taken();
  if (!mesh) mesh = std::make_unique<FacetMesh>(scene_.mesh);
  place_moving(scene_, time_s, *mesh);
  return {std::shared_ptr<const FacetMesh>(
              mesh.release(),
              [copies = copies_](FacetMesh* used) { copies->put_back(std::unique_ptr<FacetMesh>(used)); }),
          tree_at_rest_, first_};
}

const FacetMesh& resting_facets(LoadedScene& loaded_scene) {
  if (loaded_scene.scene.moving.empty()) return loaded_scene.scene.mesh;
  loaded_scene.at_rest = std::make_unique<const FacetMesh>(facets_at_rest(loaded_scene.scene));
  return *loaded_scene.at_rest;
}

void build_tree(LoadedScene& loaded_scene, SceneTree::HeightFieldSearch height_fields) {
  const Scene& scene = loaded_scene.scene;
  if (scene.moving.empty()) {
    loaded_scene.tree = std::make_unique<SceneTree>(scene.mesh, height_fields);
    return;
  }
  loaded_scene.moving = std::make_unique<const MovingFacets>(scene, height_fields);
  loaded_scene.tree = std::make_unique<SceneTree>(scene.mesh, loaded_scene.moving->tree_at_rest(),
                                                  loaded_scene.moving->first());
}

}  // namespace tubefoot
