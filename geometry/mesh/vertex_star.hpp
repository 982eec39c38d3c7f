// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace tubefoot {

/// Smallest box that contains all added vectors, stored in floats and rounded outwards.
struct VectorBox {
  std::array<float, 3> lo{1, 1, 1}, hi{0, 0, 0};  ///< empty

  static VectorBox of(const glm::dvec3& v);
  bool is_empty() const { return lo[0] > hi[0]; }
  void add(const VectorBox& other);
  /// Returns the box of the vectors after a multiple of `along` between `least` and `most` is added to each.
  VectorBox shifted(const glm::dvec3& along, double least, double most) const;
  /// Returns the distance from `point` to the farthest point of the box.
  double farthest_from(const glm::dvec3& point) const;
};

/// Bounds for the points of the original mesh that are mapped onto a facet.
struct FacetPast {
  VectorBox moves;    ///< from the original position of a point to its present one, grid units
  VectorBox normals;  ///< unit normals of the points' original facets
  float limit = 0;    ///< smallest displacement limit of these facets

  double moved() const { return moves.farthest_from(glm::dvec3(0)); }
};

/// The facets around a vertex, and the facets that replace them if the vertex is moved onto one of its
/// neighbours.
class VertexStar {
 public:
  static constexpr unsigned most_facets = 24;

  /// Facet i has the corners centre, ring[i] and ring[i + 1], counted cyclically. All positions are relative
  /// to the centre.
  unsigned facets = 0;
  std::array<glm::dvec3, most_facets> ring;
  std::array<const FacetPast*, most_facets> past;

  /// Estimates the displacement, as a share of its limit, if the centre is moved onto a corner of the ring.
  /// The estimate serves to order the collapses. Requires measure().
  double cost_of(unsigned target) const;
  void measure();

  /// Projects the facets along a direction of unit length, or along their mean normal if there is none.
  /// Returns false if the projected facets do not surround the centre exactly once without overlap. Requires
  /// measure().
  bool look(std::optional<glm::dvec3> along);
  /// Adds a triangle of the surface from which displacements are measured, projected along the same
  /// direction. All added triangles together cover the facets of the star.
  void add_piece(const std::array<glm::dvec3, 3>& corners, const FacetPast& past);
  /// Adds the facets of the star themselves.
  void add_own_pieces();

  struct Part {
    FacetPast past;
    std::vector<std::uint32_t> pieces;  ///< numbers of the pieces whose points are mapped onto the part
  };
  /// Computes the facets that replace the star if the centre is moved onto corner `target`. Facet k consists
  /// of target, ring[target + k + 1] and ring[target + k + 2]; their number is facets - 2. Returns false if
  /// the map of the pieces along the direction is not one to one. Also returns false if a displacement or a
  /// rotation is too large. `most_turn` is the chord of the largest permitted angle.
  bool becomes(unsigned target, double most_turn, std::vector<Part>& parts) const;

 private:
  struct Plane {
    glm::dvec2 slope;
    double height = 0;  ///< above the centre
    double at(const glm::dvec2& x) const { return height + glm::dot(slope, x); }
  };
  struct Piece {
    std::array<glm::dvec2, 3> corner;  ///< counter-clockwise
    glm::dvec2 lo, hi;
    double twice_area;
    Plane plane;
    FacetPast past;
  };

  glm::dvec2 seen(const glm::dvec3& at) const;

  std::array<glm::dvec3, most_facets> normal_;
  std::array<double, most_facets> moved_;
  glm::dvec3 up_{0}, east_{0}, north_{0};     ///< of unit length; `up_` is the direction of projection
  std::array<glm::dvec2, most_facets> flat_;  ///< the projected ring
  std::array<double, most_facets> height_;
  std::vector<Piece> pieces_;
};

}  // namespace tubefoot
