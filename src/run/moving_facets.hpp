// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "geometry/search/scene_tree.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// The facets of a scene at one time. They keep their numbers.
class MovedFacets {
 public:
  MovedFacets(std::shared_ptr<const FacetMesh> mesh, std::shared_ptr<const SceneTree> at_rest,
              FacetId first_moving)
      : mesh_(std::move(mesh)),
        tree_(std::make_shared<SceneTree>(*mesh_, std::move(at_rest), first_moving)),
        first_(first_moving) {}

  const std::shared_ptr<const FacetMesh>& mesh() const { return mesh_; }
  const std::shared_ptr<const SceneTree>& tree() const { return tree_; }
  FacetId first_moving() const { return first_; }

 private:
  std::shared_ptr<const FacetMesh> mesh_;
  std::shared_ptr<const SceneTree> tree_;
  FacetId first_;
};

/// Places the moving objects of a scene at the times of transmissions. The tree of the facets at rest is
/// built once. A mesh is copied only if all earlier copies are in use; otherwise only its moving vertices
/// change. The scene must outlive this object. Thread-safe.
class MovingFacets {
 public:
  MovingFacets(const Scene& scene, SceneTree::HeightFieldSearch height_fields);

  std::shared_ptr<const SceneTree> tree_at_rest() const { return tree_at_rest_; }
  FacetId first() const { return first_; }
  /// Throws the errors of place_moving().
  MovedFacets at(double time_s) const;

 private:
  struct Copies;

  const Scene& scene_;
  FacetMesh at_rest_;
  std::shared_ptr<const SceneTree> tree_at_rest_;
  FacetId first_;
  std::shared_ptr<Copies> copies_;
};

struct LoadedScene;

/// Returns the facets at rest of a loaded scene. With moving objects, it keeps a copy of them.
const FacetMesh& resting_facets(LoadedScene& loaded_scene);

/// Builds the tree of a loaded scene. For a scene with moving objects, also prepares their facets.
void build_tree(LoadedScene& loaded_scene,
                SceneTree::HeightFieldSearch height_fields = SceneTree::HeightFieldSearch::proven);

}  // namespace tubefoot
