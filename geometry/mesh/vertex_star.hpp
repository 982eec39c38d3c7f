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

/// The least box of vectors seen, kept in floats and rounded outwards.
struct VectorBox {
  std::array<float, 3> lo{1, 1, 1}, hi{0, 0, 0};  ///< empty

  static VectorBox of(const glm::dvec3& v);
  bool is_empty() const { return lo[0] > hi[0]; }
  void add(const VectorBox& other);
  /// Of its vectors, each with some multiple of `along` between the two added.
  VectorBox shifted(const glm::dvec3& along, double least, double most) const;
  /// From the farthest of its vectors to `point`.
  double farthest_from(const glm::dvec3& point) const;
};

/// How a facet has come about: what is known of the points of the first mesh that have come to lie on it.
struct FacetPast {
  VectorBox moves;    ///< from where a point was to where it is, grid units
  VectorBox normals;  ///< of unit length, that the facets had which points were on
  float limit = 0;    ///< least of those facets' limits of moves

  double moved() const { return moves.farthest_from(glm::dvec3(0)); }
};

/// What becomes of the facets about a vertex when it goes onto one of its neighbours.
class VertexStar {
 public:
  static constexpr unsigned most_facets = 24;

  /// Facet i has the corners centre, ring[i] and ring[i + 1], counted round; all places are from the centre.
  unsigned facets = 0;
  std::array<glm::dvec3, most_facets> ring;
  std::array<const FacetPast*, most_facets> past;

  /// How much the surface is about to move, as a part of what it may, when the centre goes onto a corner of
  /// the ring: an estimate, to go by its order. After measure().
  double cost_of(unsigned target) const;
  void measure();

  /// The facets seen along a direction of unit length, or, without one, along the normal of all. False if
  /// they are not seen one beside the other, once round. After measure().
  bool look(std::optional<glm::dvec3> along);
  /// A surface that is seen in the same place along that direction: what points are moved from. Those
  /// together cover all of the star's facets.
  void add_piece(const std::array<glm::dvec3, 3>& corners, const FacetPast& past);
  /// The star's facets themselves.
  void add_own_pieces();

  struct Part {
    FacetPast past;
    std::vector<std::uint32_t> pieces;  ///< that points on it come from
  };
  /// Facet k of those that take the star's place is target, ring[target + k + 1] and ring[target + k + 2];
  /// there are facets - 2. False where the map of the pieces along the direction is not one to one, or moves
  /// or turns by too much. `most_turn`: the chord of the angle.
  bool becomes(unsigned target, double most_turn, std::vector<Part>& parts) const;

 private:
  struct Plane {
    glm::dvec2 slope;
    double height = 0;  ///< over the centre
    double at(const glm::dvec2& x) const { return height + glm::dot(slope, x); }
  };
  struct Piece {
    std::array<glm::dvec2, 3> corner;  ///< turning left
    glm::dvec2 lo, hi;
    double twice_area;
    Plane plane;
    FacetPast past;
  };

  glm::dvec2 seen(const glm::dvec3& at) const;

  std::array<glm::dvec3, most_facets> normal_;
  std::array<double, most_facets> moved_;
  glm::dvec3 up_{0}, east_{0}, north_{0};     ///< of unit length; looked along `up_`
  std::array<glm::dvec2, most_facets> flat_;  ///< the ring as it is seen
  std::array<double, most_facets> height_;
  std::vector<Piece> pieces_;
};

}  // namespace tubefoot
