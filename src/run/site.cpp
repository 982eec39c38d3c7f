// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/site.hpp"

#include <tbb/task_arena.h>

#include "engine/ground/ground.hpp"
#include "engine/rays/ray_engine.hpp"
#include "run/facet_numbering.hpp"

namespace tubefoot {
namespace {

/// What is made may itself run in parallel: a thread that waits for it takes no task from outside, which
/// might ask for the same and wait for ever.
template <class Make>
void make_once(std::once_flag& made, const Make& make) {
  std::call_once(made, [&] { tbb::this_task_arena::isolate(make); });
}

}  // namespace

Site::Site(Scene loaded) : scene(std::move(loaded)) {}
Site::~Site() = default;

const RayScene& Site::rays() const {
  make_once(rays_made_, [this] { rays_ = std::make_unique<const RayScene>(scene.mesh, scene.grid); });
  return *rays_;
}

const FacetNumbering& Site::numbering() const {
  make_once(numbering_made_, [this] { numbering_ = std::make_unique<const FacetNumbering>(*this); });
  return *numbering_;
}

FacetId Site::number_of(FacetId facet) const {
  if (!whole) return facet;
  make_once(numbered_, [this] { numbers_ = whole->numbering().of(tiles); });
  return numbers_[facet];
}

FacetId Site::base_number_of(FacetId facet) const {
  return relief.parent.empty() ? number_of(facet) : relief.parent[facet];
}

const std::vector<glm::dvec3>& Site::vertices_m() const {
  make_once(vertices_made_, [this] {
    vertices_m_.reserve(scene.mesh.vertices.size());
    for (const GridPoint& p : scene.mesh.vertices) vertices_m_.push_back(scene.grid.to_metres(p));
  });
  return vertices_m_;
}

}  // namespace tubefoot
