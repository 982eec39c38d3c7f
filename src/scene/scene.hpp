// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/relief/elevation_field.hpp"
#include "engine/scattering/reflectivity_field.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "engine/signal/smooth_surface.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/meshes/mesh_materials.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/rasters/terrain_tiles.hpp"
#include "scene/scene_water.hpp"
#include "scene/surfaces/facet_fineness.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// What loading one component met.
struct ComponentReport {
  std::string name;
  std::size_t facets_in_file = 0;  ///< triangles the source holds (polygons counted as their triangles)
  std::size_t facets = 0;          ///< facets in the scene: equal, but for a material map's cuts
  std::size_t cut_facets = 0;      ///< facets of the source that a material map cuts
  std::size_t hole_cells = 0;      ///< raster cells left open because a corner has no data
  std::size_t kept_outside_halfedge = 0;  ///< facets that OpenMesh refused and that take part all the same
  std::vector<NamedFacets> names;         ///< in the order of the file
  glm::dvec3 lo_m{0}, hi_m{0};            ///< extent in the local frame
  FacetFineness fineness;                 ///< of a curved object; else 0
};

struct SceneReport {
  std::vector<ComponentReport> components;
  MeshReport mesh;
  std::vector<std::string> warnings;
};

class TerrainMap;

/// A terrain that is read by tiles.
struct TiledTerrain {
  std::shared_ptr<const TerrainTiles> tiles;  ///< null: a component that is in the scene's mesh
  std::uint16_t material = 0;
  std::shared_ptr<const TerrainMap> map;  ///< null: all of it is of this material
};

/// Everything a run needs, loaded and immutable.
struct Scene {
  SceneDescription description;
  WorldGrid grid;
  FacetMesh mesh;
  LocalFrame frame;                         ///< where the local frame lies on Earth, if the scene says so
  std::vector<double> material_mu;          ///< Lambert mu (linear), by material index
  std::vector<double> material_reflection;  ///< energy that it mirrors, by material: 0 to 1
  std::vector<std::shared_ptr<const ElevationField>> relief;           ///< by material; null: facets are flat
  std::vector<std::shared_ptr<const ReflectivityField>> reflectivity;  ///< by material; null: even
  std::vector<std::shared_ptr<const ScatteringModel>> scattering;      ///< by material; null: Lambert's
  std::vector<std::optional<SmoothSurface>> smooth;                    ///< by material; none: rough
  /// By material, what a reflection at it makes of a signal besides its loss: of modulus 1, at all angles.
  std::vector<std::complex<double>> mirror_phase;
  std::shared_ptr<const SceneWater> water;
  double sound_speed_m_s = 1500;               ///< of isovelocity water; else at the depth that [water] names
  std::vector<Trajectory> trajectories;        ///< as in the description
  std::vector<std::size_t> sensor_trajectory;  ///< per sensor: index of its trajectory
  std::vector<TiledTerrain> tiled;             ///< by component; empty: the mesh holds all of the scene
  SceneReport report;

  /// What a material reflects in phase; null: it is rough.
  const SmoothSurface* smooth_surface(std::uint16_t material) const {
    return smooth[material] ? &*smooth[material] : nullptr;
  }
  /// Of the sea surface, which there must be, in grid units.
  std::int32_t surface_height() const {
    return grid.snap({grid.origin_m().x, grid.origin_m().y, description.sea_surface->height_m}).z;
  }
};

/// Loads every file the description names. Throws InputError (with the place that named the file).
Scene load_scene(const SceneDescription& description);

}  // namespace tubefoot
