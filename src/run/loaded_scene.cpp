// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/loaded_scene.hpp"

#include <tbb/task_arena.h>

#include "engine/rays/ray_engine.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "run/facet_numbering.hpp"

namespace tubefoot {
namespace {

/// `make` may run in parallel. The isolated thread takes no outside task while it waits, because such a task
/// might request the same object and wait forever.
template <class Make>
void make_once(std::once_flag& made, const Make& make) {
  std::call_once(made, [&] { tbb::this_task_arena::isolate(make); });
}

}  // namespace

LoadedScene::LoadedScene(Scene loaded) : scene(std::move(loaded)) {}
LoadedScene::~LoadedScene() = default;

const RayScene& LoadedScene::rays() const {
  make_once(rays_made_, [this] { rays_ = std::make_unique<const RayScene>(scene.mesh, scene.grid); });
  return *rays_;
}

const FacetNumbering& LoadedScene::base_numbering() const {
  make_once(base_numbering_made_,
            [this] { base_numbering_ = std::make_unique<const FacetNumbering>(*this); });
  return *base_numbering_;
}

const FacetNumbering& LoadedScene::numbering() const {
  if (!refines_tiles()) return base_numbering();
  make_once(numbering_made_,
            [this] { numbering_ = std::make_unique<const FacetNumbering>(*this, base_numbering()); });
  return *numbering_;
}

FacetId LoadedScene::number_of(FacetId facet) const {
  if (!whole) return facet;
  make_once(numbered_, [this] { numbers_ = whole->numbering().of(tiles, relief.parent); });
  return numbers_[facet];
}

FacetId LoadedScene::base_number_of(FacetId facet) const {
  if (relief.parent.empty()) return number_of(facet);
  if (!whole) return relief.parent[facet];
  make_once(base_numbered_, [this] { base_numbers_ = whole->base_numbering().of(tiles); });
  return base_numbers_[relief.parent[facet]];
}

const std::vector<glm::dvec3>& LoadedScene::vertices_m() const {
  make_once(vertices_made_, [this] {
    vertices_m_.reserve(scene.mesh.vertices.size());
    for (const GridPoint& p : scene.mesh.vertices) vertices_m_.push_back(scene.grid.to_metres(p));
  });
  return vertices_m_;
}

}  // namespace tubefoot
