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

/// Share of the emitted energy that remains after a chain of mirrors, as a function of the direction (unit
/// vector) at the image apex.
struct MirrorLoss {
  /// Product of the factors that do not depend on direction.
  double factor = 1;
  /// One normal per reflection at a rough surface, as seen from the image apex.
  std::vector<glm::dvec3> rough_normals;
  /// (2 k sigma)^2 of a rough surface, with coherent reflection. For the Rayleigh parameter 2 k sigma
  /// sin(grazing) the intensity has the factor exp(-(2 k sigma sin(grazing))^2) (Eckart 1953; Jensen et al.,
  /// Computational Ocean Acoustics).
  double roughness = 0;
  /// (c / c_apex)^2 - 1 at that surface. In stratified water the grazing angle there differs from that at the
  /// apex, and cos / c is the same (Snell's law; normals are vertical).
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

/// One leg between a sonar and the seabed. The leg is a straight line from an apex, or from its image in
/// mirrors, to the apparent position of a facet. The transmit leg defines positions; apex_m and facet_map of
/// a receive leg are not read (CommonVisibility::rx_m).
struct Leg {
  glm::dvec3 apex_m{0};   ///< position of the apex or of the image, local frame
  MirrorLoss loss{};      ///< loss at its mirrors
  glm::dmat3 to_true{1};  ///< converts a direction at the image to that at the true apex
  /// Per facet: the map to its true position (apparent facets in stratified water). Empty if apparent and
  /// true positions are equal.
  std::span<const FacetMap> facet_map{};

  /// Returns the map from the apparent to the true position of a facet.
  FacetMap map_of(FacetId facet) const {
    return facet_map.empty() ? FacetMap{glm::dvec3(0), apex_m} : facet_map[facet];
  }
  /// Returns the true position of a point of a facet whose apparent position is `from_apex_m`; local frame.
  glm::dvec3 true_place(FacetId facet, glm::dvec3 from_apex_m) const {
    return facet_map.empty() ? apex_m + from_apex_m : facet_map[facet].at(from_apex_m);
  }
  LyingPlane lying(FacetId facet, const FacetPlane& plane, const PlaneFrame& frame) const {
    return facet_map.empty() ? LyingPlane(plane, frame, apex_m) : LyingPlane(plane, frame, facet_map[facet]);
  }
};

/// A path from the sonar to the seabed and back: two legs, or one leg in both directions.
struct Path {
  Leg tx{};
  std::optional<Leg> rx{};  ///< none: the receive leg has the mirrors of the transmit leg
  /// Per facet: ratio of the returned energy to that of the straight path (apparent facets in stratified
  /// water, engine/water/apparent_map.hpp); empty: 1.
  std::span<const double> facet_factor{};

  const Leg& back() const { return rx ? *rx : tx; }
  bool over_mirrors() const { return !tx.loss.none() || !back().loss.none(); }
};

}  // namespace tubefoot
