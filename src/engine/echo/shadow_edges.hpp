// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/visibility/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// A part of an edge of a facet that casts the border of a shadow, as one apex sees it. Lengths in metres
/// relative to the apex.
struct ShadowEdge {
  std::uint16_t component = 0;  ///< component to which the facet belongs
  FacetId facet = 0;            ///< the facet that casts the shadow
  /// Component and facet of a surface that the border crosses.
  std::uint16_t background_component = 0;
  FacetId background = 0;
  glm::dvec3 first_m{0}, last_m{0};  ///< ends of the part
  /// Lengths by which the edge continues beyond these ends, outside of the tubes; 0 if the shadow border
  /// ends.
  double before_m = 0, beyond_m = 0;
  /// Orthonormal frame. `normal` is that of the plane through apex and edge, towards the hidden side.
  /// `across` lies in this plane, perpendicular to the edge and away from the apex.
  glm::dvec3 normal{0}, across{0}, along{0};
  double distance_m = 0;  ///< distance of the apex from the line of the edge

  /// Coordinates of a place in the frame of the edge.
  struct Place {
    double h;  ///< distance behind the plane through apex and edge, positive on the hidden side
    double q;  ///< coordinate along `across`; the edge is at distance_m
    double t;  ///< coordinate along `along`
  };
  Place place(glm::dvec3 p) const { return {glm::dot(normal, p), glm::dot(across, p), glm::dot(along, p)}; }
  /// Returns h / nu with the Fresnel parameter nu (run/fresnel_transition.hpp) of a place beyond the edge:
  /// sqrt(lambda d2 (d1 + d2) / (2 d1)). The distances are those along the ray to the projection of the place
  /// on the plane through apex and edge.
  double scale_m(double wavelength_m, double q, double t) const;
};

/// Returns the edges that cast shadow borders on the footprints of a history, by component. Parts of one
/// edge that cast borders in several tubes or on several facets of one component form one entry if they
/// touch. The history must have the names of corners. Computes in double.
std::vector<ShadowEdge> shadow_edges(const FacetMesh& mesh, const History& history);

}  // namespace tubefoot
