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
#include "engine/scattering/volume_scattering.hpp"
#include "engine/signal/smooth_surface.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/meshes/mesh_materials.hpp"
#include "scene/moving_objects.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/rasters/terrain_tiles.hpp"
#include "scene/scene_water.hpp"
#include "scene/surfaces/facet_fineness.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Results of loading one component.
struct ComponentReport {
  std::string name;
  std::size_t facets_in_file = 0;  ///< triangles in the source (polygons count as their triangles)
  std::size_t facets = 0;      ///< facets in the scene: the same number, except after cuts by a material map
  std::size_t cut_facets = 0;  ///< facets of the source that a material map cuts
  std::size_t hole_cells = 0;  ///< raster cells without facets because a corner has no data
  std::size_t kept_outside_halfedge =
      0;                           ///< facets that OpenMesh rejected; they are in the scene all the same
  std::vector<NamedFacets> names;  ///< in the order of the file
  glm::dvec3 lo_m{0}, hi_m{0};     ///< extent in the local frame
  FacetFineness fineness;          ///< of a curved object; otherwise 0
  Pose pose;  ///< of an object: its own axes at its origin; of a moving object, at the first ping
};

struct SceneReport {
  std::vector<ComponentReport> components;
  MeshReport mesh;
  std::vector<std::string> warnings;
};

class TerrainMap;

/// A terrain that is read by tiles.
struct TiledTerrain {
  std::shared_ptr<const TerrainTiles> tiles;  ///< null for a component in the scene's mesh
  std::uint16_t material = 0;
  std::shared_ptr<const TerrainMap> map;  ///< null if all of the terrain has this material
};

/// All data of a run, loaded and immutable.
struct Scene {
  SceneDescription description;
  WorldGrid grid;
  /// The moving objects are the last components, facets and vertices, at the time of the first ping.
  FacetMesh mesh;
  LocalFrame frame;                         ///< position of the local frame on Earth, if the scene states it
  std::vector<double> material_mu;          ///< Lambert's mu (linear), by material index
  std::vector<double> material_reflection;  ///< reflected fraction of energy, by material: 0 to 1
  std::vector<std::shared_ptr<const ElevationField>> relief;  ///< by material; null if facets are flat
  std::vector<std::shared_ptr<const ReflectivityField>> reflectivity;  ///< by material; null if uniform
  std::vector<std::shared_ptr<const ScatteringModel>> scattering;  ///< by material; null for Lambert's law
  std::vector<std::optional<SmoothSurface>> smooth;                ///< by material; empty if rough
  /// By material, the phase factor of a reflection, of modulus 1. It is the same at all angles and excludes
  /// the loss.
  std::vector<std::complex<double>> mirror_phase;
  std::shared_ptr<const SceneWater> water;
  VolumeScattering volume;  ///< heights in the local frame
  /// Water that the software of the sonars assumes. It is the same object as `water` if both have the same
  /// sound speeds.
  std::shared_ptr<const SceneWater> assumed_water;
  double sound_speed_m_s = 1500;               ///< of isovelocity water; otherwise at the depth in [water]
  std::vector<Trajectory> trajectories;        ///< in the order of the description
  std::vector<std::size_t> sensor_trajectory;  ///< index of the trajectory, by sensor
  std::vector<MovingObject> moving;            ///< in the order of their components
  double first_ping_s = 0;                     ///< time of the first ping of any sensor, with moving objects
  std::vector<TiledTerrain> tiled;             ///< by component; empty if the mesh holds the whole scene
  SceneReport report;

  /// Returns the smooth surface of a material, which reflects in phase; null if the material is rough.
  const SmoothSurface* smooth_surface(std::uint16_t material) const {
    return smooth[material] ? &*smooth[material] : nullptr;
  }
  /// Returns the height of the sea surface in grid units. The scene must have a sea surface.
  std::int32_t surface_height() const {
    return grid.snap({grid.origin_m().x, grid.origin_m().y, description.sea_surface->height_m}).z;
  }
};

/// Loads every file that the description names. In the description of the scene, the moving objects follow
/// the others. Throws InputError with the place that names the file.
Scene load_scene(const SceneDescription& description);

}  // namespace tubefoot
