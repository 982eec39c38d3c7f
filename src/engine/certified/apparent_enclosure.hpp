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

/// What is proven of an apparent facet and the curved image of the true facet that it stands for. Places are
/// relative to the apex, metres.
struct FacetEnclosure {
  enum class State {
    proven,
    /// Seen edge-on, or so flat that its image may fold: only what it returns at most is known.
    conservative,
    /// It is not known that one ray leads to each of its points. Nothing is known but where rays to it may
    /// come from and how soon.
    unproven
  };
  State state = State::unproven;
  std::array<glm::dvec3, 3> seen{};  ///< corners of the apparent facet; of an unproven one, of the true facet
  glm::dvec3 normal{0};              ///< unit, of the apparent facet's plane, away from the apex
  double plane_m = 0;                ///< distance of that plane
  double travel_path_error_m = 0;    ///< no image is farther from its place on the apparent facet
  double shift_m = 0;                ///< no range along a ray differs by more, of rays that meet both
  double nearest_m = 0, farthest_m = 0;  ///< ranges of the image
  /// What the facet returns along a ray over what the straight law makes of the apparent facet.
  Interval factor;
  /// The straight law, of a material that has one; none: Lambert's.
  std::optional<ScatteringModel> model;
  /// No place that a ray meets is farther from where the facet's map (FacetMap) has it.
  double place_off_m = 0;
  double most_per_sr = 0;  ///< upper bound of what it returns [J] per steradian of launch
  double most = 0;         ///< and in all
};

struct ApparentEnclosures {
  std::vector<FacetEnclosure> facets;    ///< as the apparent surface's
  std::vector<FacetEnclosure> unproven;  ///< facets that may be seen, among them those that were left out
};

/// An apparent surface, and the facets that it is mapped of.
struct MappedSeabed {
  const ApparentSurface& surface_mesh;
  const SceneTree& tree;              ///< of the apparent facets
  const FacetMesh& base;              ///< flat facets, where they lie
  std::span<const FacetId> parent{};  ///< by apparent facet: the one that it is part of
  const WorldGrid& grid;

  const FacetMesh& mesh() const { return surface_mesh.refined.mesh; }
};

/// Encloses the facets of an apparent surface. `model`: that of apparent ranges.
ApparentEnclosures enclose(const MappedSeabed& seabed, const RayEnclosure& rays, const EchoModel& model);

}  // namespace tubefoot
