// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "engine/sight/history.hpp"
#include "run/shot_ground.hpp"
#include "viewer/view_data.hpp"

// What a view shows besides footprints.
namespace tubefoot {

/// Adds the parts of facets inside a shot's tubes that are not wholly seen, hidden part and all. Returns
/// false, having stopped, once there are more than `most` of them.
bool add_shadows(const Scene& scene, const ShotGround& ground, const History& history, std::size_t most,
                 ViewPolygons& shadows);

/// The box of footprints and shadows, or of the sensor's places, made larger by a quarter of its diagonal.
struct Surroundings {
  glm::dvec3 lo_m, hi_m;
};
Surroundings surroundings(const ViewData& view);

/// Takes the facets of a mesh that meet the surroundings; of more than `most`, those nearest to footprints
/// and shadows in plan. Returns how many were left out.
std::size_t take_mesh(const Scene& scene, const FacetMesh& mesh, const Surroundings& about, std::size_t most,
                      ViewData& view);

}  // namespace tubefoot
