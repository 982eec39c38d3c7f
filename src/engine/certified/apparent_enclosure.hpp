// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/scattering/echo_model.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "engine/water/ray_enclosure.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Proven bounds of an apparent facet and of the curved image of the true facet that it represents.
/// Positions are relative to the apex, in metres.
struct FacetEnclosure {
  enum class State {
    proven,
    /// The facet is seen edge-on, or so flat that its image may fold. Only upper bounds of its return are
    /// known.
    conservative,
    /// It is not proven that exactly one ray leads to each point of the facet. The bounds are only those of
    /// the directions and ranges of possible rays.
    unproven
  };
  State state = State::unproven;
  /// Corners of the apparent facet, or of the true facet if the state is unproven.
  std::array<glm::dvec3, 3> seen{};
  glm::dvec3 normal{0};  ///< unit normal of the apparent facet's plane, away from the apex
  double plane_m = 0;    ///< distance of this plane from the apex
  /// Largest distance of a point's image from its position on the apparent facet.
  double travel_path_error_m = 0;
  double shift_m = 0;                    ///< largest difference of the ranges at which a ray meets both
  double nearest_m = 0, farthest_m = 0;  ///< bounds of the image's ranges
  /// Ratio between the facet's return along a ray and the straight-ray return of the apparent facet.
  Interval factor;
  /// Scattering model of the apparent facet for straight rays; none: Lambert's law.
  std::optional<ScatteringModel> model;
  /// Largest distance between the point that a ray meets and the point that the facet's map (FacetMap)
  /// gives.
  double place_off_m = 0;
  double most_per_sr = 0;  ///< upper bound of the return [J/m^2] per steradian of launch directions
  double most = 0;         ///< upper bound of the whole return
};

struct ApparentEnclosures {
  std::vector<FacetEnclosure> facets;    ///< in the order of the apparent surface
  std::vector<FacetEnclosure> unproven;  ///< facets that may be seen, including omitted ones
};

/// An apparent surface, and the facets from which it was mapped.
struct MappedSeabed {
  const ApparentSurface& surface_mesh;
  const SceneTree& tree;              ///< tree of the apparent facets
  const FacetMesh& base;              ///< flat facets at their true positions
  std::span<const FacetId> parent{};  ///< base facet of each apparent facet
  const WorldGrid& grid;

  const FacetMesh& mesh() const { return surface_mesh.refined.mesh; }
};

/// Encloses the facets of an apparent surface. The ranges of `model` are apparent ranges.
ApparentEnclosures enclose(const MappedSeabed& seabed, const RayEnclosure& rays, const EchoModel& model);

}  // namespace tubefoot
