// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/certified/apparent_enclosure.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/visibility/visibility.hpp"

// Bounds the energy from directions in which the visible facet is uncertain, because images differ slightly
// from apparent facets. All results are upper bounds. See docs/notes/certified-energies.md, sections "Through
// refracting water" and "Of two ends".
namespace tubefoot {

/// Energy of up to `energy_j` that may be added to or missing from the visible pieces, from ranges between
/// these.
struct Ambiguity {
  double nearest_m = 0, farthest_m = 0, energy_j = 0;
  FacetId facet = 0;  ///< with AmbiguitiesOf::places: facet of the points
  /// Ambiguous part of the apparent facet, also with AmbiguitiesOf::places.
  std::span<const glm::dvec3> part_m{};
};
using AmbiguitySink = std::function<void(const Ambiguity& ambiguity)>;

/// Directions about an axis.
struct Cone {
  glm::dvec3 axis{0};
  double spread_rad = 0;
};

/// Corners of a visible piece.
struct AmbiguousPiece {
  FacetId facet = 0;
  std::vector<glm::dvec3> corners_m;
};
AmbiguousPiece seen_piece(const NamedPiece& piece, const CertifiedPolygon& polygon);

/// Determines whether pieces refer to directions or to points. Pieces of one apex refer to directions, which
/// walls of tubes meet exactly. At every edge between base facets, another facet may be visible in a
/// direction. For pieces that refer to points, facets' own edges are certain if the neighbours lie on
/// opposite sides of them. However, it is uncertain which tube sees a point next to a wall.
enum class AmbiguitiesOf { directions, places };

class UncertainEdges {
 public:
  /// All arguments must outlive this object.
  UncertainEdges(const FacetMesh& apparent, std::span<const FacetId> parent,
                 const ApparentEnclosures& enclosures, AmbiguitiesOf of = AmbiguitiesOf::directions);

  /// Adds the ambiguities of the pieces of one tube. `nearby` contains all facets that may be in the tube.
  void add_ambiguities(const NameContext& context, const TubeVisibility& seen,
                       std::span<const AmbiguousPiece> pieces, std::span<const FacetId> nearby,
                       const AmbiguitySink& sink) const;

  using Wall = std::pair<glm::dvec3, glm::dvec3>;
  /// Adds ambiguities of points on any facet next to walls. Each wall lies between two directions and has an
  /// error of at most `off_rad`.
  void add_walls(std::span<const Wall> walls, double off_rad, std::span<const FacetId> nearby,
                 const AmbiguitySink& sink) const;

 private:
  struct EdgeOf {
    FacetId facet[2];
    int count = 0;
    double widest_rad = 0;  ///< largest error of images over all its facets
  };
  /// Proven facets of a tube, sorted by the coordinate of their axes that varies most.
  struct Nearby {
    std::vector<FacetId> facets;
    std::vector<double> place;
    int coordinate = 0;
    double widest_rad = 0;  ///< largest sum of spread and error of a facet
  };
  Nearby nearby_of(std::span<const FacetId> facets) const;
  /// Calls `take` for the facets of `nearby` that may be seen within a cone.
  template <class Take>
  void each_within(const Nearby& nearby, const Cone& cone, const Take& take) const;
  bool is_smooth(VertexId a, VertexId b) const;
  bool is_smooth_between(FacetId f, FacetId g) const;
  double half_width(VertexId a, VertexId b) const;
  void strip(const glm::dvec3& from, const glm::dvec3& to, double half_width_rad, const Nearby& nearby,
             const AmbiguitySink& sink, const EdgeOf* edge = nullptr) const;
  void clash(const AmbiguousPiece& piece, FacetId other, const AmbiguitySink& sink) const;

  const FacetMesh& mesh_;
  std::span<const FacetId> parent_;
  const ApparentEnclosures& enclosures_;
  AmbiguitiesOf of_;
  std::unordered_map<std::uint64_t, EdgeOf> edges_;
  std::vector<Cone> cones_;  // by facet, for proven facets
};

}  // namespace tubefoot
