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
#include "engine/water/apparent_map.hpp"
#include "geometry/mesh/edge_refinement.hpp"

// What one apex sees through refracting water, as a mesh of apparent facets that straight tubes see.
// docs/refraction.md
namespace tubefoot {

struct ApparentMapSettings {
  /// Edges are cut until the image of their middle is as close as this to the middle of their ends' images.
  double travel_path_error_m = 1e-3;
  /// And until what that and the change of spreading between their ends do to the density of energy is at
  /// most this, one way and the other.
  double tolerance_db = std::numeric_limits<double>::infinity();
  /// None shorter than this is cut: next to a caustic the gap does not shrink.
  double shortest_edge_m = 0.05;
  /// Edges in a shadow, or at its border, are cut down to this: facets at the border are left out whole.
  double shadow_edge_m = 4;
  /// Every ray that leads to a place shows it: one sheet of apparent facets for each family of rays
  /// (eigenray_branches.hpp). Else the first to arrive alone. map_apparent_together() wants false.
  bool later_arrivals = false;
};

/// A place that has not exactly one eigenray.
struct UnclearPlace {
  FacetId facet = 0;  ///< of the base
  glm::dvec3 at_m{0};
  int eigenrays = 0;        ///< 0: shadow
  glm::dvec3 direction{0};  ///< launch direction of the first to arrive; straight to the place in a shadow
};

/// One of several rays to a part of the seabed, and what it does at the part's corners.
struct RayOfPart {
  FacetId seen = 0;        ///< the apparent facet that it makes of the part
  FacetId part = 0;        ///< its number; rays of a part follow one another
  std::uint32_t rank = 0;  ///< of the ray among these, by launch angle
  bool crossed = false;    ///< Eigenray::crossed
  struct Corner {
    double sine = 0;  ///< of the grazing angle
    /// R^2 over the area of the ray tube (that to the part and that back from it, as a geometric mean), what
    /// absorption leaves one way over what the reference absorption does, and R, the apparent range.
    double gain = 0, range_m = 0;
  };
  std::array<Corner, 3> corners;
};

struct ApparentSurface {
  /// Apparent facets that have an eigenray to every corner and their centre, and the base facet of each.
  RefinedMesh refined;
  std::vector<glm::dvec3> truth;           ///< by vertex: where it lies
  std::vector<double> facet_factor;        ///< for EchoModel::facet_factor
  double reference_speed_m_s = 0;          ///< by which a travel time becomes a range
  double largest_travel_path_error_m = 0;  ///< of all edges that are left; of short ones a bound
  std::size_t facets_in_shadow = 0;        ///< left out: they lie, wholly or in part, where no ray leads
  /// Facets of the seabed with several eigenrays to a corner: the first to arrive stands for them, or each
  /// shows the facet.
  std::size_t facets_of_several = 0;
  /// Apparent facets that are turned over: rays cross before they reach them.
  std::size_t facets_folded = 0;
  std::vector<RayOfPart> several;  ///< of the parts that several rays show, by part and by apparent facet
  std::vector<std::uint16_t> part_material;  ///< by part
  /// Those that were left out: where their corners lie.
  std::vector<std::array<glm::dvec3, 3>> left_out_m;
  /// For each base facet: a place of it in a shadow, and one where rays cross, if it has such.
  std::vector<UnclearPlace> unclear;

  /// Where a point of an apparent facet lies: as it lies between the facet's corners.
  glm::dvec3 true_place(FacetId facet, glm::dvec3 seen_m, const WorldGrid& grid) const;
  /// By facet, for EchoModel::facet_map; the apex in the local frame.
  std::vector<FacetMap> facet_maps(glm::dvec3 apex_m, const WorldGrid& grid) const;
  /// True area of a facet over its apparent one.
  double area_ratio(FacetId facet, const WorldGrid& grid) const;
};

/// Straightens `facets` of `base` for one apex. `reference_absorption_db_per_m` is what the echo model will
/// apply to apparent ranges; `models`: by material, empty or null for Lambert's; `view_bounds`: where parts
/// are cut and kept, null: everywhere. Apparent points have to fit `grid`. The result does not depend on the
/// number of threads. Throws as refine(); std::invalid_argument unless the settings are above 0.
ApparentSurface map_apparent(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                             const ApparentMap& apparent_map, double reference_absorption_db_per_m,
                             const ApparentMapSettings& settings, const RefinementLimits& limits = {},
                             std::span<const std::shared_ptr<const ScatteringModel>> models = {},
                             const ViewBounds* view_bounds = nullptr);

/// What several ways see of a seabed whose facets are cut alike for all of them, where any needs it. The
/// vertices of all apparent meshes have the numbers of `mesh`.
struct CommonApparentSurfaces {
  RefinedMesh seabed;                        ///< where it lies; parents are facets of the base
  std::vector<ApparentSurface> seen;         ///< by way
  std::vector<std::vector<FacetId>> origin;  ///< by way and apparent facet: that of `seabed`
};

/// straighten() for several ways, each with its view bounds (none: null).
CommonApparentSurfaces map_apparent_together(const FacetMesh& base, std::span<const FacetId> facets,
                                             const WorldGrid& grid, std::span<const ApparentMap* const> ways,
                                             double reference_absorption_db_per_m,
                                             const ApparentMapSettings& settings,
                                             const RefinementLimits& limits,
                                             std::span<const ViewBounds* const> all_view_bounds);

}  // namespace tubefoot
