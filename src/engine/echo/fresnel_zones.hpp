// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/echo/shadow_edges.hpp"

namespace tubefoot {

/// A convex polygon on a facet, relative to the apex, in metres.
using FresnelPolygon = std::vector<glm::dvec3>;

/// Returns the mean of the corners.
glm::dvec3 centre_of(const FresnelPolygon& polygon);

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
  /// `reach_m`: distance from the apex of the edge beyond which no place lies. `apex_m`: this apex, relative
  /// to the origin of places. `leg`: 0 for the apex of the transmit leg, 1 for that of the receive leg.
  FresnelZone(const ShadowEdge& edge, double wavelength_m, double reach_m, glm::dvec3 apex_m = glm::dvec3(0),
              int leg = 0);

  /// Planes whose half-spaces intersect in the region of hidden or of insonified places.
  std::span<const CutPlane> planes(bool hidden) const { return {planes_[hidden ? 1 : 0], 5}; }
  /// Corner directions of the region from the apex: the ends of the edge, and those at its outer border.
  std::vector<glm::dvec3> corners(bool hidden) const;
  bool holds(glm::dvec3 p, bool hidden) const;
  /// Returns false only if the edge does not change energies on a polygon outside of its shadow. There, all
  /// places lie in front of the edge, or nu is beyond the limit of truncated_knife_edge_intensity().
  bool may_act_on(std::span<const glm::dvec3> polygon) const;

  const ShadowEdge& edge() const { return *edge_; }
  /// Edges of one group belong to one leg and one component.
  std::pair<int, std::uint16_t> group() const { return {leg_, edge_->component}; }
  glm::dvec3 apex_m() const { return apex_m_; }
  ShadowEdge::Place place(glm::dvec3 p) const { return edge_->place(p - apex_m_); }
  /// Returns the Fresnel parameter of a place beyond the edge.
  double parameter(glm::dvec3 p) const;
  /// Returns h / nu of a place.
  double scale_m(const ShadowEdge::Place& place) const {
    return edge_->scale_m(wavelength_m_, place.q, place.t);
  }

 private:
  const ShadowEdge* edge_;
  double wavelength_m_;
  glm::dvec3 apex_m_;
  int leg_;
  glm::dvec3 first_m_, last_m_;  ///< ends of the edge, which may lie outside of the tubes
  double slope_[2];              ///< h / q at the outer borders of both regions
  CutPlane planes_[2][5];
};

/// Divides polygons into cells in which the parameters of all relevant edges are almost constant.
class FresnelDivision {
 public:
  /// `zones` must outlive the object. `legs`: number of legs on which each zone acts. It is 2 if both legs
  /// have one apex.
  FresnelDivision(std::span<const FresnelZone> zones, double step, int legs)
      : zones_(zones), step_(step), legs_(legs) {}

  using Take = std::function<void(const FresnelPolygon& cell, double factor)>;
  /// Calls take(cell, mean of the weight minus 1) for the cells of a visible polygon. `candidates`: the zones
  /// that may contain a part of it, by group.
  void lit(const FresnelPolygon& polygon, std::span<const std::uint32_t> candidates, const Take& take);
  /// Calls take(cell, mean of the weight) for the cells of a polygon that zones `own` of different legs hide.
  /// Omits cells for which another zone of the same group has a smaller parameter.
  void hidden(const FresnelPolygon& polygon, std::span<const std::uint32_t> own,
              std::span<const std::uint32_t> candidates, const Take& take);

 private:
  /// Zones that act on a polygon: outside of their shadows, and in their shadows.
  struct Active {
    std::vector<std::uint32_t> lit;
    std::span<const std::uint32_t> own;
  };

  /// How the parameter of a zone varies over a polygon.
  struct Variation {
    std::uint32_t zone;
    double low, high;  ///< parameters at the corners
    double curved;     ///< bound of the change of nu by the curvature of lines of equal nu
    double width;      ///< what decides whether to divide the polygon
    CutPlane plane;    ///< where to divide it
  };
  /// Returns nothing if the edge does not act on the polygon.
  std::optional<Variation> vary(const FresnelPolygon& polygon, glm::dvec3 middle, std::uint32_t number,
                                bool hidden) const;

  void cut(const FresnelPolygon& polygon, std::span<const std::uint32_t> candidates, Active active);
  void divide(const FresnelPolygon& polygon, Active active, int depth);
  void finish(const FresnelPolygon& polygon, const Active& active);
  double weight(glm::dvec3 p, const Active& active) const;

  std::span<const FresnelZone> zones_;
  double step_;
  int legs_;
  std::span<const std::uint32_t> candidates_;
  const Take* take_ = nullptr;
  std::vector<Variation> variations_;  // a buffer of divide()
};

}  // namespace tubefoot
