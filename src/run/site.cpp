// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/site.hpp"

#include "engine/ground/ground.hpp"
#include "engine/rays/ray_engine.hpp"
#include "run/facet_numbering.hpp"

namespace tubefoot {

Site::Site(Scene loaded) : scene(std::move(loaded)) {}
Site::~Site() = default;

const RayScene& Site::rays() const {
  std::call_once(rays_made_, [this] { rays_ = std::make_unique<const RayScene>(scene.mesh, scene.grid); });
  return *rays_;
}

const FacetNumbering& Site::numbering() const {
  std::call_once(numbered_, [this] { numbering_ = std::make_unique<const FacetNumbering>(*this); });
  return *numbering_;
}

FacetId Site::number_of(FacetId facet) const {
  if (!whole) return facet;
  std::call_once(numbered_, [this] { numbers_ = whole->numbering().of(tiles); });
  return numbers_[facet];
}

FacetId Site::base_number_of(FacetId facet) const {
  return relief.parent.empty() ? number_of(facet) : relief.parent[facet];
}

const std::vector<glm::dvec3>& Site::vertices_m() const {
  std::call_once(vertices_made_, [this] {
    vertices_m_.reserve(scene.mesh.vertices.size());
    for (const GridPoint& p : scene.mesh.vertices) vertices_m_.push_back(scene.grid.to_metres(p));
  });
  return vertices_m_;
}

}  // namespace tubefoot
