// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/relief/elevation_field.hpp"
#include "engine/surface/relief_error.hpp"
#include "engine/surface/sector.hpp"
#include "engine/surface/view_bounds.hpp"
#include "geometry/mesh/edge_refinement.hpp"
#include "geometry/search/scene_tree.hpp"

// Refines the seabed with its macro-texture and displaces the refined facets, everywhere or only where a
// transmission may see them. Facets are refined until the omitted relief changes the energy of a range
// sample by less than a tolerance. See docs/notes/textures.md, section "Refinement".
namespace tubefoot {

enum class Displacement { vertical, normal };

struct SurfaceSettings {
  double cell_m = 0.01;  ///< edges of refined facets that are no longer than this are not cut
  Displacement displacement = Displacement::vertical;
  /// Permitted relative RMS change of a range sample's energy by coarser facets; 0: cells everywhere.
  double tolerance = 0.01;
  /// By material, or empty. Facets of mirrors consist of cells wherever they are seen, so that their images
  /// do not depend on the apex.
  std::vector<bool> mirrors{};
};

/// Requirements of a transmission on the surface.
struct Look {
  const TubeSet* tubes = nullptr;
  double first_m = 0;                       ///< slant range of the first sample
  double sample_m = 0.01;                   ///< length of a sample
  const ViewBounds* view_bounds = nullptr;  ///< view bounds in stratified water; null: straight rays
  double beam_rad = 0;                      ///< width of the beams; 0: width of the narrowest tube
};

class SurfaceMesh {
 public:
  /// `base` must outlive the surface. `relief` contains one field per material, null for flat facets. The
  /// grid must contain the base mesh displaced by the largest relief.
  SurfaceMesh(const FacetMesh& base, const WorldGrid& grid,
              std::span<const std::shared_ptr<const ElevationField>> relief, const SurfaceSettings& settings);

  /// Returns all facets; facets with relief consist of cells. Throws RefinementTooLarge.
  RefinedMesh everywhere(const RefinementLimits& limits) const;
  /// Does the same for some facets, with the same parts.
  RefinedMesh everywhere(std::span<const FacetId> facets, const RefinementLimits& limits) const;
  /// Returns all facets that these transmissions may see, as fine as required, and coarse outside of the
  /// view. Throws RefinementTooLarge.
  RefinedMesh seen_by(std::span<const Look> looks, const RefinementLimits& limits) const;
  /// Returns only the mirrors within a distance of a position, with the same parts as in seen_by(). Throws
  /// RefinementTooLarge.
  RefinedMesh mirrors_within(glm::dvec3 place_m, double distance_m, const RefinementLimits& limits) const;
  /// Returns the facets above and below a position, which consist of cells there.
  RefinedMesh in_line_with(glm::dvec3 place_m) const;

  /// Returns the number of facets of everywhere() for all textured facets, without creating them.
  std::size_t uniform_count() const;

  const OmittedRelief& omitted() const { return omitted_; }
  const SurfaceSettings& settings() const { return settings_; }
  const FacetMesh& base() const { return base_; }

 private:
  class Cells;
  struct Seen;
  struct InLine;

  bool textured(std::uint16_t material) const { return relief_[material] != nullptr; }
  bool mirrors(std::uint16_t material) const {
    return material < settings_.mirrors.size() && settings_.mirrors[material];
  }
  bool mirrors_along(const BasePoint& a, const BasePoint& b) const;
  /// Returns the materials that meet at the base edge that contains both points. Without such an edge, or
  /// with one material, it is the material of the facet.
  std::span<const std::uint16_t> materials_along(const BasePoint& a, const BasePoint& b) const;
  glm::dvec3 place(const BasePoint& point) const;
  std::span<const std::uint16_t> materials_at(const BasePoint& point) const;
  bool textured_at(const BasePoint& point) const;
  bool textured_along(const BasePoint& a, const BasePoint& b) const;
  double sine_grazing(const BasePoint& a, const BasePoint& b, glm::dvec3 from_apex, double radius_m) const;
  void find_borders();
  void find_normals();
  RefinedMesh refined(std::span<const FacetId> facets, const EdgeRule& rule,
                      const RefinementLimits& limits) const;

  const FacetMesh& base_;
  WorldGrid grid_;
  std::vector<std::shared_ptr<const ElevationField>> relief_;
  SurfaceSettings settings_;
  OmittedRelief omitted_;
  SceneTree tree_;
  /// Materials that meet at base edges (key of both vertices) and at vertices with more than one material,
  /// sorted.
  std::unordered_map<std::uint64_t, std::vector<std::uint16_t>> edge_materials_;
  std::unordered_map<VertexId, std::vector<std::uint16_t>> vertex_materials_;
  /// For each base vertex, the mean normal and the largest angle to the normal of an adjacent facet.
  struct VertexNormal {
    glm::dvec3 normal{0};
    double spread_rad = 0;
  };
  std::vector<VertexNormal> normals_;
};

}  // namespace tubefoot
