// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/site.hpp"

#include "engine/ground/ground.hpp"
#include "engine/rays/ray_engine.hpp"

namespace tubefoot {

Site::Site(Scene loaded) : scene(std::move(loaded)) {}
Site::~Site() = default;

const RayScene& Site::rays() const {
  std::call_once(rays_made_, [this] { rays_ = std::make_unique<const RayScene>(scene.mesh, scene.grid); });
  return *rays_;
}

}  // namespace tubefoot
