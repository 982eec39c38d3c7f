// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/certified/apparent_enclosure.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/visibility/visibility.hpp"

// Directions in which it is not certain which facet is seen, because images are not exactly where apparent
// facets are; and what they could return. Upper bounds all.
namespace tubefoot {

/// Up to `energy_j` more or less than the visible pieces' own, from ranges between these.
struct Ambiguity {
  double nearest_m = 0, farthest_m = 0, energy_j = 0;
  FacetId facet = 0;  ///< with places: whose they are
  /// And on its apparent facet, those in ambiguity.
  std::span<const glm::dvec3> part_m{};
};
using AmbiguitySink = std::function<void(const Ambiguity& ambiguity)>;

/// Directions about an axis.
struct Cone {
  glm::dvec3 axis{0};
  double spread_rad = 0;
};

/// A visible piece as ambiguities need it.
struct AmbiguousPiece {
  FacetId facet = 0;
  std::vector<glm::dvec3> corners_m;
};
AmbiguousPiece seen_piece(const NamedPiece& piece, const CertifiedPolygon& polygon);

/// What a direction decides, or a place: pieces of one apex are what is seen in a direction, met exactly by
/// the walls of tubes, and at every edge between base facets another of them may be seen in it. Of pieces
/// that are reported by places, facets' own edges are certain as long as neighbours lie on either side of
/// them; which tube sees a place next to a wall is not.
enum class AmbiguitiesOf { directions, places };

class UncertainEdges {
 public:
  /// All outlive this.
  UncertainEdges(const FacetMesh& apparent, std::span<const FacetId> parent,
                 const ApparentEnclosures& enclosures, AmbiguitiesOf of = AmbiguitiesOf::directions);

  /// Of the pieces of one tube; `nearby`: all facets that may be in it.
  void add_ambiguities(const NameContext& context, const TubeVisibility& seen,
                       std::span<const AmbiguousPiece> pieces, std::span<const FacetId> nearby,
                       const AmbiguitySink& sink) const;

  using Wall = std::pair<glm::dvec3, glm::dvec3>;
  /// Of places, on whichever facets: next to walls, each between two directions and off by that at most.
  void add_walls(std::span<const Wall> walls, double off_rad, std::span<const FacetId> nearby,
                 const AmbiguitySink& sink) const;

 private:
  struct EdgeOf {
    FacetId facet[2];
    int count = 0;
    double widest_rad = 0;  ///< of all its facets, how far images may be off
  };
  /// The proven facets of a tube, in the order of that coordinate of their axes in which they differ most.
  struct Nearby {
    std::vector<FacetId> facets;
    std::vector<double> place;
    int coordinate = 0;
    double widest_rad = 0;  ///< spread of any, and how far it may be off
  };
  Nearby nearby_of(std::span<const FacetId> facets) const;
  /// Of `nearby`, those that may be seen within a cone.
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
  std::vector<Cone> cones_;  // by facet, of those that are proven
};

}  // namespace tubefoot
