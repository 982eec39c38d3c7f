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

/// Builds the apparent facets of seabed parts to which several rays lead, one branch of facets for each
/// family of rays. The rays of a family have similar launch angles and have crossed their neighbours equally
/// often.
///
/// The facets are cut along caustics and along the limits of the followed rays, which are located on the
/// edges. A branch then contains each part completely or not at all. Two branches that meet on a caustic
/// share their vertices there. All branches form one surface over the launch directions, without gaps or
/// overlaps except those of chords. The transmitted solid angle therefore equals the arriving one.
///
/// All branches are in one mesh and hide each other as facets do. The first facet along a launch direction
/// contains the point at which the ray first meets the seabed.
class EigenrayBranches {
 public:
  /// Adds facets to `surface_mesh`. All arguments must outlive this object. `models` as in map_apparent().
  EigenrayBranches(const FineFacets& fine, const Images& images, const WorldGrid& grid,
                   std::span<const std::shared_ptr<const ScatteringModel>> models,
                   ApparentSurface& surface_mesh);
  /// Adds all images of a facet.
  void add(FacetId facet);
  /// True positions of the vertices that were added to the mesh.
  std::span<const glm::dvec3> truth() const { return truth_; }

 private:
  /// A point with all rays that lead to it, and the vertices of its images.
  struct Place {
    glm::dvec3 at_m{0};
    std::vector<SeenPoint> rays;
    std::vector<VertexId> vertices;
  };
  /// Point of an edge at which rays appear or vanish, as seen from the end with more rays and from the end
  /// with fewer.
  struct Border {
    VertexId richer = 0;
    double part = 0;  ///< fraction of the edge from the end with more rays
    Place more, fewer;
    const Place& towards(VertexId end) const { return end == richer ? more : fewer; }
  };
  /// Corner of a part of a facet.
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

/// Returns the mean of 1 / sqrt(w^2 + least^2) over a triangle. The width w is linear between the corners,
/// which have widths of one sign. The mean is twice the second divided difference of w asinh(w / least) -
/// sqrt(w^2 + least^2), by the formula of Hermite and Genocchi. `least` is raised to a millionth of the
/// largest width if it is smaller.
double mean_inverse_width(const std::array<double, 3>& width, double least);

}  // namespace tubefoot
