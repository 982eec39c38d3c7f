// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/echo/shadow_edges.hpp"

namespace tubefoot {

/// A convex polygon on a facet, relative to the apex, in metres.
using FresnelPolygon = std::vector<glm::dvec3>;

/// Half-space normal . p >= offset_m. `normal` is a unit vector, except for lines of equal parameter.
struct CutPlane {
  glm::dvec3 normal{0};
  double offset_m = 0;
  double side(glm::dvec3 p) const { return glm::dot(normal, p) - offset_m; }
};

/// Splits a convex polygon. Parts without area are empty. Corners within rounding of the plane belong to both
/// parts.
void split(const FresnelPolygon& polygon, const CutPlane& plane, FresnelPolygon& inside,
           FresnelPolygon& outside);

/// The regions on both sides of one edge's shadow border in which the edge changes energies.
class FresnelZone {
 public:
  /// `reach_m`: distance from the apex beyond which no place lies.
  FresnelZone(const ShadowEdge& edge, double wavelength_m, double reach_m);

  /// Planes whose half-spaces intersect in the region of hidden or of insonified places.
  std::span<const CutPlane> planes(bool hidden) const { return {planes_[hidden ? 1 : 0], 5}; }
  /// Corner directions of the region. They are the ends of the edge, and those at its outer border.
  std::vector<glm::dvec3> corners(bool hidden) const;
  bool holds(glm::dvec3 p, bool hidden) const;

  const ShadowEdge& edge() const { return *edge_; }
  /// Returns the Fresnel parameter of a place beyond the edge.
  double parameter(glm::dvec3 p) const;
  /// Returns h / nu of a place.
  double scale_m(const ShadowEdge::Place& place) const {
    return edge_->scale_m(wavelength_m_, place.q, place.t);
  }

 private:
  const ShadowEdge* edge_;
  double wavelength_m_;
  glm::dvec3 first_m_, last_m_;  ///< ends of the edge, which may lie outside of the tubes
  double slope_[2];              ///< h / q at the outer borders of both regions
  CutPlane planes_[2][5];
};

/// Divides polygons into cells in which the parameters of all relevant edges are almost constant.
class FresnelDivision {
 public:
  /// `zones` must outlive the object.
  FresnelDivision(std::span<const FresnelZone> zones, double step) : zones_(zones), step_(step) {}

  using Take = std::function<void(const FresnelPolygon& cell, double factor)>;
  /// Calls take(cell, mean of I^2 - 1) for the cells of a visible polygon. `candidates`: the zones that may
  /// contain a part of it.
  void lit(const FresnelPolygon& polygon, std::span<const std::uint32_t> candidates, const Take& take);
  /// Calls take(cell, mean of I^2) for the cells of a polygon that the component of zone `own` hides. Omits
  /// cells for which another edge of this component has a smaller parameter.
  void hidden(const FresnelPolygon& polygon, std::uint32_t own, std::span<const std::uint32_t> candidates,
              const Take& take);

 private:
  /// Edges that act on a polygon, and for a hidden polygon the edge of its shadow.
  struct Active {
    std::vector<std::uint32_t> lit;
    std::uint32_t own = none;
  };
  static constexpr std::uint32_t none = 0xffffffffu;

  void cut(const FresnelPolygon& polygon, std::span<const std::uint32_t> candidates, Active active);
  void divide(const FresnelPolygon& polygon, Active active, int depth);
  void finish(const FresnelPolygon& polygon, const Active& active);
  double weight(glm::dvec3 p, const Active& active) const;

  std::span<const FresnelZone> zones_;
  double step_;
  std::span<const std::uint32_t> candidates_;
  const Take* take_ = nullptr;
};

}  // namespace tubefoot
