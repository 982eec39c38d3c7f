// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/site_below.hpp"

namespace tubefoot {

std::unique_ptr<Site> loaded_with(const Site& site, const TileChoice& choice) {
  auto part = std::make_unique<Site>(with_tiles(site.scene, choice));
  part->relief = site.relief;
  if (site.relief.cell_m > 0) part->ground = relief_ground(part->scene);
  return part;
}

SiteBelow::SiteBelow(const Site& site) : site_(site) {
  if (site.is_tiled()) tiles_.emplace(site);
}

const Site& SiteBelow::in_line_with(glm::dvec3 place_m) {
  if (!tiles_) return site_;
  TileChoice choice = tiles_->below(place_m);
  if (!part_ || choice != choice_) {
    choice_ = std::move(choice);
    part_ = loaded_with(site_, choice_);
    part_->tree = std::make_unique<SceneTree>(part_->scene.mesh, SceneTree::Sheets::ignored);
  }
  return *part_;
}

}  // namespace tubefoot
