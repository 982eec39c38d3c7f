// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/scattering/facet_map.hpp"

namespace tubefoot {

/// What a chain of mirrors leaves of the energy that is sent along it, by the direction (unit vector) in
/// which its image apex sends.
struct MirrorLoss {
  /// Product of the factors that do not depend on direction.
  double factor = 1;
  /// One for each reflection at a rough surface: the surface's normal as the image apex sees it.
  std::vector<glm::dvec3> rough_normals;
  /// Coherent reflection at a rough surface, Rayleigh parameter 2 k sigma sin(grazing): intensity times
  /// exp(-(2 k sigma sin(grazing))^2) (Eckart 1953; Jensen et al., Computational Ocean Acoustics). Here
  /// (2 k sigma)^2.
  double roughness = 0;
  /// (c / c_apex)^2 - 1 at that surface: in refracting water grazing angles are others there than at the
  /// apex, cos / c the same (Snell's law; normals are vertical).
  double bend = 0;

  bool none() const { return factor == 1 && rough_normals.empty(); }
  double at(glm::dvec3 direction) const {
    if (rough_normals.empty()) return factor;
    double exponent = 0;
    for (const glm::dvec3& normal : rough_normals) {
      const double sine = glm::dot(direction, normal);
      exponent += std::max(0.0, sine * sine - bend * (1 - sine * sine));
    }
    return factor * std::exp(-roughness * exponent);
  }
};

/// One way of sound between a sonar and the seabed: a straight line from an apex, or from its image in
/// mirrors, to where a facet is seen from there. Places are reported by the transmit leg: of a receive leg,
/// apex_m and facet_map are not read (Sight::rx_m).
struct Leg {
  glm::dvec3 apex_m{0};   ///< of the apex or the image, local frame
  MirrorLoss loss{};      ///< of its mirrors
  glm::dmat3 to_true{1};  ///< a direction of the image as the true apex has it
  /// By facet: where it lies that is seen elsewhere (apparent facets in refracting water); empty: where it is
  /// seen.
  std::span<const FacetMap> facet_map{};

  /// Where a facet lies that is seen.
  FacetMap map_of(FacetId facet) const {
    return facet_map.empty() ? FacetMap{glm::dvec3(0), apex_m} : facet_map[facet];
  }
  /// Where a place on a facet lies that is seen `from_apex_m`; local frame.
  glm::dvec3 true_place(FacetId facet, glm::dvec3 from_apex_m) const {
    return facet_map.empty() ? apex_m + from_apex_m : facet_map[facet].at(from_apex_m);
  }
  LyingPlane lying(FacetId facet, const FacetPlane& plane, const PlaneFrame& frame) const {
    return facet_map.empty() ? LyingPlane(plane, frame, apex_m) : LyingPlane(plane, frame, facet_map[facet]);
  }
};

/// From the sonar to the seabed and back: two legs, or one that is gone both ways.
struct Path {
  Leg tx{};
  std::optional<Leg> rx{};  ///< none: with the mirrors of the transmit leg
  /// By facet: what it returns over what the straight law makes of it (apparent facets in refracting water,
  /// engine/water/apparent map.hpp); empty: 1.
  std::span<const double> facet_factor{};

  const Leg& back() const { return rx ? *rx : tx; }
  bool over_mirrors() const { return !tx.loss.none() || !back().loss.none(); }
};

}  // namespace tubefoot
