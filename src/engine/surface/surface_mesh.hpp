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

// The seabed with its macro-texture: facets refined and displaced, all of them or where a transmission looks.
// docs/textures.md, "Refinement"
namespace tubefoot {

enum class Displacement { vertical, normal };

struct SurfaceSettings {
  double cell_m = 0.01;  ///< no edge of a refined facet is cut that is no longer than this
  Displacement displacement = Displacement::vertical;
  /// RMS change of a range sample's energy, relative, that coarser facets may make; 0: cells everywhere.
  double tolerance = 0.01;
  /// By material, or empty: facets that are mirrors are in cells wherever they are seen, so that their images
  /// do not depend on who looks.
  std::vector<bool> mirrors{};
};

/// What a transmission asks of the surface.
struct Look {
  const TubeSet* tubes = nullptr;
  double first_m = 0;                       ///< slant range where its samples begin
  double sample_m = 0.01;                   ///< length of one
  const ViewBounds* view_bounds = nullptr;  ///< where it looks through refracting water; null: straight
  double beam_rad = 0;                      ///< width of its beams; 0: of the narrowest tube
};

class SurfaceMesh {
 public:
  /// `base` outlives the surface. Relief by material, null where facets are flat. The grid has to hold the
  /// base displaced by the largest relief.
  SurfaceMesh(const FacetMesh& base, const WorldGrid& grid,
              std::span<const std::shared_ptr<const ElevationField>> relief, const SurfaceSettings& settings);

  /// All facets; those with relief in cells. Throws RefinementTooLarge.
  RefinedMesh everywhere(const RefinementLimits& limits) const;
  /// The same of some of them: the same parts.
  RefinedMesh everywhere(std::span<const FacetId> facets, const RefinementLimits& limits) const;
  /// All facets that these transmissions may see, as fine as they need; coarse beside them. Throws
  /// RefinementTooLarge.
  RefinedMesh seen_by(std::span<const Look> looks, const RefinementLimits& limits) const;
  /// The mirrors within a distance of a place and nothing else: the same parts as in seen_by(). Throws
  /// RefinementTooLarge.
  RefinedMesh mirrors_within(glm::dvec3 place_m, double distance_m, const RefinementLimits& limits) const;
  /// The facets above and below a place, in cells there.
  RefinedMesh in_line_with(glm::dvec3 place_m) const;

  /// Facets that cells of all textured facets would be, counted without being made.
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
  /// The base edge that both points lie on is between other materials too: these, or the facet's own.
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
  /// Materials that meet at base edges (both vertices) and vertices of more than one; sorted.
  std::unordered_map<std::uint64_t, std::vector<std::uint16_t>> edge_materials_;
  std::unordered_map<VertexId, std::vector<std::uint16_t>> vertex_materials_;
  /// By base vertex: mean normal, and the largest angle to a facet that meets there.
  struct VertexNormal {
    glm::dvec3 normal{0};
    double spread_rad = 0;
  };
  std::vector<VertexNormal> normals_;
};

}  // namespace tubefoot
