// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "engine/visibility/history.hpp"
#include "run/transmission_ends.hpp"
#include "viewer/view_data.hpp"

// What a view shows besides footprints.
namespace tubefoot {

/// Adds the parts of facets inside the tubes of a transmission's end that this does not see wholly, hidden
/// part and all. Returns false, having stopped, once there are more than `most` of them. `history`: what it
/// sees.
bool add_shadows(const Scene& scene, const TransmissionEnd& end, const History& history, std::size_t most,
                 ViewPolygons& shadows);

/// The box of footprints and shadows, or of the sensor's places, made larger by a quarter of its diagonal.
struct ViewSurroundings {
  glm::dvec3 lo_m, hi_m;
};
ViewSurroundings surroundings(const ViewData& view);

/// Takes the facets of a mesh that meet the surroundings; of more than `most`, those nearest to footprints
/// and shadows in plan. Returns how many were left out.
std::size_t take_mesh(const Scene& scene, const FacetMesh& mesh, const ViewSurroundings& about,
                      std::size_t most, ViewData& view);

}  // namespace tubefoot
