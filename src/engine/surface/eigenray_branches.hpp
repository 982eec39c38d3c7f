// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/surface/apparent_images.hpp"

namespace tubefoot {

/// Where several rays lead to the seabed, each family of them sees it elsewhere: rays that are launched alike
/// and have crossed their neighbours alike. A facet is cut along the caustics that cross it (and along the
/// ends of what rays are followed), which are found on its edges; each part is then seen over a family whole
/// or not at all. Sheets of two families that meet on a caustic share their vertices there, so that all
/// sheets are one surface over the launch directions, with neither gaps nor overlaps but for chords: the
/// solid angle that the sonar sends into is that which arrives. In one mesh they hide one another as facets
/// do: the first along a launch direction is where its ray first meets the seabed.
class EigenrayBranches {
 public:
  /// Adds to `surface_mesh`; all outlive it. `models` as in straighten().
  EigenrayBranches(const FineFacets& fine, const Images& images, const WorldGrid& grid,
                   std::span<const std::shared_ptr<const ScatteringModel>> models,
                   ApparentSurface& surface_mesh);
  /// All that is seen of a facet.
  void add(FacetId facet);
  /// Where the vertices lie that were added to the mesh.
  std::span<const glm::dvec3> truth() const { return truth_; }

 private:
  /// A place by all rays that lead there, and the vertices of their images.
  struct Place {
    glm::dvec3 at_m{0};
    std::vector<SeenPoint> rays;
    std::vector<VertexId> vertices;
  };
  /// Where rays come or go on an edge: seen from the end that has more, and from that with fewer.
  struct Border {
    VertexId richer = 0;
    double part = 0;  ///< of the edge, from that end
    Place more, fewer;
    const Place& towards(VertexId end) const { return end == richer ? more : fewer; }
  };
  /// A corner of a part of a facet.
  struct Corner {
    const Place* place;
    std::array<std::int64_t, 2> weights;
  };

  const Place& place_of(VertexId vertex);
  const Border* border_on(VertexId a, VertexId b);
  std::optional<Border> find_border(VertexId richer, VertexId poorer);
  VertexId add_vertex(const SeenPoint& seen, const glm::dvec3& lies_m);
  void add_part(FacetId facet, const std::array<Corner, 3>& corners);
  void add_seen(FacetId facet, const std::array<Corner, 3>& corners, const std::array<std::size_t, 3>& ray,
                const SeenPoint* centre);

  const FineFacets& fine_;
  const Images& images_;
  const WorldGrid& grid_;
  std::span<const std::shared_ptr<const ScatteringModel>> models_;
  ApparentSurface& surface_mesh_;
  std::unordered_map<VertexId, Place> places_;
  std::unordered_map<std::uint64_t, std::optional<Border>> borders_;
  std::vector<glm::dvec3> truth_;
};

/// The mean of 1 / sqrt(w^2 + least^2) over a triangle, w between its corners' (of one sign) as a plane: the
/// second divided difference of w asinh(w / least) - sqrt(w^2 + least^2), twice (Hermite and Genocchi).
/// `least`: no less than a millionth of the widest is used.
double mean_inverse_width(const std::array<double, 3>& width, double least);

}  // namespace tubefoot
