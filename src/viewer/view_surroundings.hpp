// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "engine/visibility/history.hpp"
#include "run/transmission_ends.hpp"
#include "viewer/view_data.hpp"

// Elements of a view in addition to footprints.
namespace tubefoot {

/// Adds the facets inside the tubes of an end of a transmission that this end sees only in part, including
/// the hidden parts. Stops and returns false as soon as there are more than `most`. `history`: footprints
/// that the end sees.
bool add_shadows(const Scene& scene, const TransmissionEnd& end, const History& history, std::size_t most,
                 ViewPolygons& shadows);

/// Bounding box of footprints and shadows, or of the positions of the sensor, enlarged by a quarter of its
/// diagonal.
struct ViewSurroundings {
  glm::dvec3 lo_m, hi_m;
};
ViewSurroundings surroundings(const ViewData& view);

/// Adds the facets of a mesh that overlap the surroundings. If there are more than `most`, it takes those
/// nearest to footprints and shadows in plan. Returns the number of omitted facets.
std::size_t take_mesh(const Scene& scene, const FacetMesh& mesh, const ViewSurroundings& about,
                      std::size_t most, ViewData& view);

}  // namespace tubefoot
