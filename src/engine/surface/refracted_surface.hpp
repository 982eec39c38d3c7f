// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/scattering/facet_map.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "engine/surface/view_bounds.hpp"
#include "geometry/mesh/edge_refinement.hpp"

// Maps the seabed to a mesh of apparent facets, which straight tubes from one apex see as refracted tubes
// see the true seabed. Edges are cut until the travel-path error and the error of the energy density are
// within the settings. See docs/notes/refraction.md.
namespace tubefoot {

class ApparentMap;

struct ApparentMapSettings {
  /// Edges are cut until the image of their middle lies within this distance of the middle of their ends'
  /// images.
  double travel_path_error_m = 1e-3;
  /// Edges are also cut until the error in energy density is at most this, in either direction. The error
  /// comes from the travel-path error and from the change of spreading between the ends.
  double tolerance_db = std::numeric_limits<double>::infinity();
  /// No edge that is shorter than this is cut. Next to a caustic the travel-path error does not decrease.
  double shortest_edge_m = 0.05;
  /// Edges in a shadow or at its border are cut to this length. Facets at the border are omitted completely.
  double shadow_edge_m = 4;
  /// If true, every ray to a point gives an image, with one branch of apparent facets for each family of
  /// rays (eigenray_branches.hpp). If false, only the first ray to arrive gives one. map_apparent_together()
  /// requires false.
  bool later_arrivals = false;
};

/// A point that does not have exactly one eigenray.
struct UnclearPlace {
  FacetId facet = 0;  ///< facet of the base mesh
  glm::dvec3 at_m{0};
  int eigenrays = 0;  ///< 0: shadow
  /// Launch direction of the first ray to arrive; in a shadow, the straight direction to the point.
  glm::dvec3 direction{0};
};

/// One of several rays to a part of the seabed, and its values at the corners of the part.
struct RayOfPart {
  FacetId seen = 0;        ///< apparent facet of the part for this ray
  FacetId part = 0;        ///< number of the part; rays of a part are consecutive
  std::uint32_t rank = 0;  ///< rank of the ray among the rays of the part, by launch angle
  bool crossed = false;    ///< value of Eigenray::crossed
  struct Corner {
    double sine = 0;  ///< of the grazing angle
    /// `gain`: R^2 over the geometric mean of the ray-tube areas in both directions, times the one-way
    /// absorption relative to the reference absorption. `range_m`: apparent range R.
    double gain = 0, range_m = 0;
  };
  std::array<Corner, 3> corners;
};

/// Points of a facet whose rays determine the facet's factor.
enum class FactorRule : std::uint8_t {
  corners,
  corners_and_centre,
  branch  ///< a part to which several rays lead (eigenray_branches.hpp)
};

struct ApparentSurface {
  /// Apparent facets whose corners and centre have an eigenray, and the base facet of each.
  RefinedMesh refined;
  std::vector<glm::dvec3> truth;           ///< true position of each vertex
  std::vector<double> facet_factor;        ///< for EchoModel::facet_factor
  std::vector<FactorRule> factor_rule;     ///< by facet
  double reference_speed_m_s = 0;          ///< sound speed that converts travel times into ranges
  double largest_travel_path_error_m = 0;  ///< over all remaining edges; for short edges a bound
  std::size_t facets_in_shadow = 0;        ///< omitted facets, which lie wholly or partly where no ray leads
  /// Seabed facets with several eigenrays to a corner. Either the first ray to arrive gives their image, or
  /// each ray does.
  std::size_t facets_of_several = 0;
  /// Apparent facets with reversed orientation. Rays cross before they reach these facets.
  std::size_t facets_folded = 0;
  std::vector<RayOfPart> several;  ///< rays of the parts with several rays, by part and by apparent facet
  std::vector<std::uint16_t> part_material;  ///< by part
  /// True corners of the omitted facets.
  std::vector<std::array<glm::dvec3, 3>> left_out_m;
  /// For each base facet, one point in a shadow and one with several rays, if the facet has such points.
  std::vector<UnclearPlace> unclear;

  /// Returns the true position of a point of an apparent facet. It has the same barycentric coordinates in
  /// the true facet.
  glm::dvec3 true_place(FacetId facet, glm::dvec3 seen_m, const WorldGrid& grid) const;
  /// Returns one map per facet, for EchoModel::facet_map. The apex is in the local frame.
  std::vector<FacetMap> facet_maps(glm::dvec3 apex_m, const WorldGrid& grid) const;
  /// Returns the ratio of the true area of a facet to its apparent area.
  double area_ratio(FacetId facet, const WorldGrid& grid) const;
};

/// Maps `facets` of `base` to apparent positions for one apex. `reference_absorption_db_per_m` is the
/// absorption that the echo model applies to apparent ranges. `models` contains one scattering model per
/// material; empty or null is Lambert's law. `view_bounds` determines which parts are cut and kept; null:
/// all. Apparent points must lie within `grid`. The result does not depend on the number of threads. Throws
/// the errors of refine(), and std::invalid_argument unless the settings are above 0.
ApparentSurface map_apparent(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                             const ApparentMap& apparent_map, double reference_absorption_db_per_m,
                             const ApparentMapSettings& settings, const RefinementLimits& limits = {},
                             std::span<const std::shared_ptr<const ScatteringModel>> models = {},
                             const ViewBounds* view_bounds = nullptr);

/// Apparent surfaces of one seabed for several paths. All paths have the same cuts, and an edge is cut if
/// any path requires it. The vertices of all apparent meshes have the same numbers as those of the seabed
/// mesh.
struct CommonApparentSurfaces {
  RefinedMesh seabed;                        ///< true positions; parents are facets of the base
  std::vector<ApparentSurface> seen;         ///< by path
  std::vector<std::vector<FacetId>> origin;  ///< facet of `seabed` for each path and apparent facet
};

/// Does the same as map_apparent() for several paths, each with its view bounds (null: no bounds).
CommonApparentSurfaces map_apparent_together(const FacetMesh& base, std::span<const FacetId> facets,
                                             const WorldGrid& grid, std::span<const ApparentMap* const> ways,
                                             double reference_absorption_db_per_m,
                                             const ApparentMapSettings& settings,
                                             const RefinementLimits& limits,
                                             std::span<const ViewBounds* const> all_view_bounds);

}  // namespace tubefoot
