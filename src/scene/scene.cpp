// SPDX-License-Identifier: GPL-3.0-or-later

// Loads a scene from its description: terrains, objects, materials, water and trajectories. The components
// are placed in the local frame and rounded to one integer grid that holds them all.

#include "scene/scene.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "files/memory_at_hand.hpp"
#include "scene/extent.hpp"
#include "scene/file/scene_file_ranges.hpp"
#include "scene/meshes/mesh_file.hpp"
#include "scene/meshes/mesh_materials.hpp"
#include "scene/meshes/primitives.hpp"
#include "scene/moving_objects.hpp"
#include "scene/odd_angles.hpp"
#include "scene/ping_times.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/rasters/raster.hpp"
#include "scene/rasters/terrain.hpp"
#include "scene/scene_placement.hpp"
#include "scene/scene_warnings.hpp"
#include "scene/snapped_areas.hpp"
#include "scene/surfaces/material_map.hpp"
#include "scene/surfaces/reflectivity.hpp"
#include "scene/surfaces/relief.hpp"
#include "scene/surfaces/scattering.hpp"
#include "scene/surfaces/sea_surface.hpp"
#include "scene/surfaces/smooth_materials.hpp"
#include "scene/terrain_height.hpp"
#include "scene/tracks.hpp"
#include "scene/volume_layers.hpp"
#include "scene/water_target_places.hpp"

namespace tubefoot {
namespace {

// Reports both places of an error in a file that the scene names.
template <typename Read>
auto named_at(const SourcePlace& place, Read read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(place, error.what());
  }
}

/// Returns `truth` if the described water has the same sound speeds. The heights of both sea surfaces are
/// equal by default.
std::shared_ptr<const SceneWater> assumed_water_of(const ProcessingDescription& processing,
                                                   const std::shared_ptr<const SceneWater>& truth) {
  if (!processing.water) return truth;
  WaterDescription description = *processing.water;
  if (!description.surface_height_m) description.surface_height_m = truth->surface_height_m();
  const auto assumed = std::make_shared<const SceneWater>(description);
  return assumed->has_same_speeds(*truth) ? truth : assumed;
}

template <typename Described>
std::size_t index_of(const std::vector<Described>& list, const std::string& name, const char* what,
                     const SourcePlace& place) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return i;
  }
  throw InputError(place, fmt::format("there is no {} named '{}'", what, name));
}

ComponentMesh terrain_mesh(const TerrainDescription& terrain, std::optional<LocalFrame>& frame) {
  if (terrain.facets) return *terrain.facets;
  if (const auto* flat = std::get_if<FlatTerrain>(&terrain.kind)) return flat_facets(*flat, terrain.place);
  if (const auto* fractal = std::get_if<FractalTerrain>(&terrain.kind))
    return fractal_facets(*fractal, terrain.place);
  return named_at(terrain.place, [&] { return read_raster(std::get<RasterTerrain>(terrain.kind), frame); });
}

bool is_curved(const ObjectDescription& object) {
  return !object.facets && !std::holds_alternative<MeshFile>(object.kind) &&
         !std::holds_alternative<BoxPrimitive>(object.kind);
}

NamedMesh object_mesh(const SceneDescription& scene, const ObjectDescription& object) {
  if (object.facets) return {*object.facets, {}, {}};
  // The chord error refers to the facets in the scene, after scaling.
  const double chord_error = facet_fineness(scene, object).chord_error_m /
                             *std::max_element(object.scale.begin(), object.scale.end());
  struct {
    const SourcePlace& place;
    double chord_error;
    NamedMesh operator()(const MeshFile& mesh) const {
      return named_at(place, [&] { return read_mesh_file(mesh.file, {mesh.up, mesh.unit_m}); });
    }
    NamedMesh operator()(const SpherePrimitive& sphere) const {
      return {sphere_facets(sphere, chord_error, place), {}, {}};
    }
    NamedMesh operator()(const CylinderPrimitive& cylinder) const {
      return {cylinder_facets(cylinder, chord_error, place), {}, {}};
    }
    NamedMesh operator()(const ConePrimitive& cone) const {
      return {cone_facets(cone, chord_error, place), {}, {}};
    }
    NamedMesh operator()(const BoxPrimitive& box) const { return {box_facets(box, place), {}, {}}; }
  } make{object.place, chord_error};
  return std::visit(make, object.kind);
}

// Returns the extent of the sensor's positions at its pings. PingTimes also checks that the trajectory
// covers the pings.
Extent sensor_positions(const SensorDescription& sensor, const TrajectoryDescription& described,
                        const Trajectory& trajectory) {
  Extent box;
  const auto vector = [](const std::array<double, 3>& v) { return glm::dvec3(v[0], v[1], v[2]); };
  const glm::dvec3 lever_arm = vector(sensor.lever_arm_m),
                   receiver_arm = vector(sensor.receiver_arm_m.value_or(sensor.lever_arm_m));
  PingTimes(sensor, trajectory, described.name).each([&](double time_s) {
    const Pose pose = trajectory.at(time_s);
    for (const glm::dvec3& arm : {lever_arm, receiver_arm}) box.add(pose.position_m + pose.attitude * arm);
  });
  return box;
}

struct LoadedComponent {
  ComponentMesh mesh;
  std::uint16_t material = 0;
  bool is_file = false;
  std::vector<std::uint16_t> facet_materials = {};  // from a material map or from the names in a mesh file
};

// Extent of one component or sensor in the grid, for the message if it does not fit.
struct Part {
  std::string name;
  SourcePlace place;
  Extent box;
};

bool has_mirrors(const SceneDescription& description) {
  const auto& materials = description.materials;
  return description.sea_surface ||
         std::any_of(materials.begin(), materials.end(), [](const auto& m) { return m.specular_loss_db; });
}

/// Returns the extent that the grid must hold.
Extent grid_box(const SceneDescription& description, const std::vector<Part>& parts) {
  Extent box;
  for (const Part& part : parts) {
    box.add(part.box.lo_m);
    box.add(part.box.hi_m);
  }
  if (parts.empty()) box.add(glm::dvec3(0));
  if (description.sea_surface) box.add({box.lo_m.x, box.lo_m.y, description.sea_surface->height_m});
  // The distance of an image apex is the length of the unfolded path, which crosses the scene once per
  // mirror.
  if (has_mirrors(description)) {
    const double beyond = description.paths.order * glm::distance(box.lo_m, box.hi_m);
    box.lo_m -= beyond;
    box.hi_m += beyond;
  }
  return box;
}

/// Returns the exponent of the finest grid that [run] may request.
int finest_exponent(const Extent& box) {
  for (int exponent = finest_grid_exponent; exponent > 0; --exponent) try {
      return WorldGrid::with_exponent(exponent, box.lo_m, box.hi_m).exponent();
    } catch (const GridRangeError&) {  // try the next exponent
    }
  return 0;
}

WorldGrid grid_for(const SceneDescription& description, const std::vector<Part>& parts) {
  const Extent box = grid_box(description, parts);
  const std::optional<int>& exponent = description.run.grid_exponent;
  try {
    return exponent ? WorldGrid::with_exponent(*exponent, box.lo_m, box.hi_m)
                    : WorldGrid::fitting(box.lo_m, box.hi_m);
  } catch (const GridRangeError& error) {
    if (parts.empty()) throw InputError(description.run.place, error.what());
    // The cause is most likely the part with the largest coordinates.
    const auto reach = [](const Part& part) {
      const glm::dvec3 r = glm::max(glm::abs(part.box.lo_m), glm::abs(part.box.hi_m));
      return std::max({r.x, r.y, r.z});
    };
    const Part& furthest = *std::max_element(
        parts.begin(), parts.end(), [&reach](const Part& a, const Part& b) { return reach(a) < reach(b); });
    throw InputError(exponent ? description.run.place : furthest.place,
                     fmt::format("{}; '{}' reaches {:.6g} m from the frame's origin: check its position, its "
                                 "scale and [georeference]",
                                 error.what(), furthest.name, reach(furthest)));
  }
}

class Loader {
 public:
  explicit Loader(const SceneDescription& description) : description_(description) {
    if (description.georeference) frame_ = LocalFrame::from(*description.georeference);
  }

  Scene load() {
    constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();
    if (description_.materials.size() > kMost ||
        description_.terrains.size() + description_.objects.size() > kMost) {
      throw InputError(
          {description_.file.string(), 0, 0},
          fmt::format("the scene has more than {} materials or more than {} terrains and objects", kMost,
                      kMost));
    }
    report_.warnings = description_.warnings;
    for (std::string& odd : odd_angles(description_)) report_.warnings.push_back(std::move(odd));
    load_components();
    std::vector<std::size_t> sensor_trajectory;
    for (const SensorDescription& sensor : description_.sensors) {
      const std::size_t t = trajectory_of(sensor);
      sensor_trajectory.push_back(t);
      parts_.push_back({sensor.name, sensor.place,
                        sensor_positions(sensor, description_.trajectories[t], trajectories_[t])});
    }

    for (TargetExtent& target : water_target_extents(description_, frame_.value_or(LocalFrame())))
      parts_.push_back({std::move(target.name), target.place, target.extent});
    std::vector<std::shared_ptr<const ElevationField>> relief(description_.materials.size());
    if (description_.refinement.mode != "off")
      relief = load_relief(description_.materials, frame_.value_or(LocalFrame()), report_.warnings);
    make_room_for(relief);
    Scene scene{.description = description_,
                .grid = grid_for(description_, parts_),
                .mesh = {},
                .frame = {},
                .material_mu = {},
                .material_reflection = {},
                .relief = {},
                .reflectivity = {},
                .scattering = load_scattering(description_, report_.warnings),
                .smooth = load_smooth_surfaces(description_, report_.warnings),
                .mirror_phase = {},
                .water = {},
                .volume = {},
                .assumed_water = {},
                .trajectories = std::move(trajectories_),
                .sensor_trajectory = std::move(sensor_trajectory),
                .moving = {},
                .first_ping_s = first_ping_s_,
                .tiled = tiled_,
                .report = {}};
    for (const MaterialDescription& m : description_.materials) {
      scene.material_mu.push_back(std::pow(10.0, m.lambert_db / 10));
      scene.reflectivity.push_back(load_reflectivity(m, frame_.value_or(LocalFrame()), report_.warnings));
      scene.material_reflection.push_back(m.specular_loss_db ? std::pow(10.0, -*m.specular_loss_db / 10) : 0);
    }
    // The phase of a reflection at a fluid depends on the angle, which mirrors do not consider. The fluid
    // counts as rigid.
    for (const std::optional<SmoothSurface>& surface : scene.smooth)
      scene.mirror_phase.push_back(surface && !surface->fluid && surface->reflection != 0.0
                                       ? surface->reflection / std::abs(surface->reflection)
                                       : 1.0);
    scene.water = std::make_shared<const SceneWater>(description_.water);
    scene.volume = load_volume_scattering(
        description_.water, surface_height_m(),
        description_.sea_surface.has_value() || description_.water.surface_height_m.has_value());
    scene.assumed_water = assumed_water_of(description_.processing, scene.water);
    scene.sound_speed_m_s = scene.water->profile().at(description_.water.depth_m);
    scene.frame = frame_.value_or(LocalFrame());
    scene.relief = std::move(relief);
    build_mesh(scene);
    scene.report = std::move(report_);
    add_warnings(scene, surface_height_m());
    return scene;
  }

 private:
  void load_components() {
    std::vector<ComponentMesh> terrains;  // objects may stand on these terrains
    for (const TerrainDescription& t : description_.terrains) {
      if (!named_at(t.place, [&] { return is_read_by_tiles(t); })) {
        terrains.push_back(terrain_mesh(t, frame_));
        continue;
      }
      tiled_.resize(description_.terrains.size() + description_.objects.size());
      tiled_[terrains.size()].tiles = named_at(t.place, [&] {
        return std::make_shared<const TerrainTiles>(std::get<RasterTerrain>(t.kind), frame_);
      });
      terrains.emplace_back();
    }
    std::vector<ComponentMesh> objects;
    std::vector<std::vector<NamedFacets>> names;
    std::vector<Pose> poses;
    for (const ObjectDescription& object : description_.objects) {
      NamedMesh mesh = object_mesh(description_, object);
      names.push_back(apply_mesh_materials(mesh, object, description_.materials));
      objects.push_back(std::move(mesh));
      if (!object.trajectory.empty()) {
        poses.push_back(scaled_for_carrier(objects.back(), object));
        continue;
      }
      if (is_sea_surface(description_, poses.size())) {
        poses.emplace_back();
        continue;
      }
      poses.push_back(place_object(
          objects.back(), object, frame_.value_or(LocalFrame()),
          [&](double east_m, double north_m) {
            const glm::dvec2 place(east_m, north_m);
            return heights_m(object.place, terrains, {&place, 1}).front();
          },
          [&] { return to_text(extent_of_terrains(terrains)); }));
    }
    for (const TrajectoryDescription& t : description_.trajectories)
      trajectories_.push_back(make_trajectory(
          t, {frame_.value_or(LocalFrame()), surface_height_m(),
              [&](std::span<const glm::dvec2> places) { return heights_m(t.place, terrains, places); },
              &report_.warnings}));
    for (std::size_t i = 0; i < terrains.size(); ++i) {
      const TerrainDescription& t = description_.terrains[i];
      if (is_tiled(i) && t.material_map)
        tiled_[i].map = named_at(t.place, [&] {
          const TerrainTiles& tiles = *tiled_[i].tiles;
          return std::make_shared<const TerrainMap>(t, description_.materials, frame_.value_or(LocalFrame()),
                                                    tiles.lo_m(), tiles.hi_m());
        });
      const std::size_t facets = terrains[i].triangles.size();
      const std::size_t cut =
          apply_material_map(terrains[i], t, description_.materials, frame_.value_or(LocalFrame()));
      add_component(std::move(terrains[i]), t.name, t.material, t.material_place, t.place, false);
      report_.components.back().facets_in_file = facets;
      report_.components.back().cut_facets = cut;
      if (is_tiled(i)) report_tiles(tiled_[i], components_.back().material);
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const ObjectDescription& o = description_.objects[i];
      add_component(std::move(objects[i]), o.name, o.material, o.material_place, o.place,
                    std::holds_alternative<MeshFile>(o.kind));
      report_.components.back().names = std::move(names[i]);
      report_.components.back().pose = poses[i];
      if (!o.trajectory.empty()) add_motion(o, poses[i]);
      if (is_sea_surface(description_, i)) add_waves();
      if (is_curved(o)) report_.components.back().fineness = facet_fineness(description_, o);
    }
  }

  void add_component(ComponentMesh mesh, const std::string& name, const std::string& material,
                     const SourcePlace& material_place, const SourcePlace& place, bool is_file) {
    Extent extent;
    for (const glm::dvec3& p : mesh.points_m) extent.add(p);
    parts_.push_back({name, place, extent});
    ComponentReport& report = report_.components.emplace_back();
    report.name = name;
    report.facets_in_file = mesh.triangles.size();
    report.hole_cells = mesh.hole_cells;
    report.lo_m = extent.lo_m;
    report.hi_m = extent.hi_m;
    report_.warnings.insert(report_.warnings.end(), mesh.warnings.begin(), mesh.warnings.end());
    const std::size_t index = index_of(description_.materials, material, "material", material_place);
    components_.push_back({std::move(mesh), static_cast<std::uint16_t>(index), is_file});
  }

  /// Adds the motion of the object that was added last: its extent at all pings, and its pose at the first
  /// ping. Its points are in its own axes.
  void add_motion(const ObjectDescription& object, const Pose& on_carrier) {
    const std::size_t t =
        index_of(description_.trajectories, object.trajectory, "trajectory", object.trajectory_place);
    const Trajectory& trajectory = trajectories_[t];
    MovingObject& moving = moving_.emplace_back();
    moving.component = static_cast<std::uint16_t>(components_.size() - 1);
    moving.trajectory = t;
    moving.on_carrier = on_carrier;
    const std::vector<glm::dvec3>& points_m = components_.back().mesh.points_m;
    double radius_m = 0;
    for (const glm::dvec3& p : points_m) radius_m = std::max(radius_m, glm::length(p));
    Extent swept;
    first_ping_s_ = std::numeric_limits<double>::infinity();
    for (const SensorDescription& sensor : description_.sensors) {
      const std::size_t s = trajectory_of(sensor);
      const PingTimes times(sensor, trajectories_[s], description_.trajectories[s].name);
      first_ping_s_ = std::min(first_ping_s_, times.first_s());
      const double interval_s = sensor.shortest_interval_s();
      std::size_t ping = 0;
      times.each([&](double time_s) {
        if (!trajectory.holds(time_s))
          throw InputError(
              object.trajectory_place,
              fmt::format("ping {} of sensor '{}' is at {:.9g} s, outside of trajectory '{}' of object "
                          "'{}', which lasts from {:.9g} s to {:.9g} s: change the trajectory or the pings",
                          ping, sensor.name, time_s, object.trajectory, object.name, trajectory.begin_s(),
                          trajectory.end_s()));
        ++ping;
        // Later transmissions of a ping are sent before the next ping.
        for (const double at_s : {time_s, std::min(time_s + interval_s, trajectory.end_s())})
          for (const double side : {-1.0, 1.0})
            swept.add(pose_of(moving, trajectory, trajectory.holds(at_s) ? at_s : time_s).position_m +
                      side * radius_m);
      });
    }
    parts_.back().box = swept;
    moving.lowest_m = swept.lo_m.z;
    ComponentReport& report = report_.components.back();
    report.pose = pose_of(moving, trajectory, first_ping_s_);
    Extent extent;
    for (const glm::dvec3& p : points_m) extent.add(report.pose.position_m + report.pose.attitude * p);
    report.lo_m = extent.lo_m;
    report.hi_m = extent.hi_m;
  }

  /// Adds the waves of the sea surface, which is the component that was added last.
  void add_waves() {
    const SeaSurfaceDescription& sea = *description_.sea_surface;
    const SeaSurfaceWaves waves = sea_surface_waves(description_, report_.warnings);
    MovingObject& moving = moving_.emplace_back();
    moving.component = static_cast<std::uint16_t>(components_.size() - 1);
    moving.waves = waves.heights;
    moving.lowest_m = sea.height_m - waves.bound_m;
    Extent& box = parts_.back().box;
    box.lo_m.z -= waves.bound_m;
    box.hi_m.z += waves.bound_m;
    first_ping_s_ = std::numeric_limits<double>::infinity();
    for (const SensorDescription& sensor : description_.sensors) {
      const std::size_t s = trajectory_of(sensor);
      first_ping_s_ = std::min(
          first_ping_s_, PingTimes(sensor, trajectories_[s], description_.trajectories[s].name).first_s());
    }
    ComponentReport& report = report_.components.back();
    const std::vector<double> heights_m = waves.heights->heights_m(first_ping_s_);
    const auto [lowest, highest] = std::ranges::minmax(heights_m);
    report.lo_m.z = sea.height_m + lowest;
    report.hi_m.z = sea.height_m + highest;
    constexpr double troughs = 4;  // of a Gaussian sea, about one place in 30000 is lower
    for (std::size_t i = 0; i < description_.terrains.size(); ++i)
      if (const ComponentReport& terrain = report_.components[i];
          terrain.hi_m.z <= sea.height_m &&
          terrain.hi_m.z > sea.height_m - troughs * waves.standard_deviation_m)
        report_.warnings.push_back(fmt::format(
            "terrain '{}' reaches to {:.3g} m below the mean sea surface, above the troughs of the waves: it "
            "hides the sea surface there",
            terrain.name, sea.height_m - terrain.hi_m.z));
  }

  Extent extent_of_terrains(std::span<const ComponentMesh> terrains) const {
    Extent extent;
    for (const ComponentMesh& terrain : terrains)
      for (const glm::dvec3& p : terrain.points_m) extent.add(p);
    for (const TiledTerrain& terrain : tiled_)
      if (terrain.tiles) {
        extent.add(terrain.tiles->lo_m());
        extent.add(terrain.tiles->hi_m());
      }
    return extent;
  }

  /// Returns the heights of all terrains at some positions. `who` is the place of the request.
  std::vector<std::optional<double>> heights_m(const SourcePlace& who,
                                               std::span<const ComponentMesh> terrains,
                                               std::span<const glm::dvec2> places) const {
    std::vector<std::optional<double>> heights = terrain_heights_m(terrains, places);
    for (const TiledTerrain& terrain : tiled_) {
      if (!terrain.tiles) continue;
      std::map<std::vector<std::uint32_t>, std::vector<std::size_t>> by_tiles;
      for (std::size_t k = 0; k < places.size(); ++k)
        by_tiles[terrain.tiles->at(places[k].x, places[k].y)].push_back(k);
      for (const auto& [tiles, here] : by_tiles) {
        const ComponentMesh patch = named_at(who, [&, &tiles = tiles] { return terrain.tiles->read(tiles); });
        std::vector<glm::dvec2> some;
        for (const std::size_t k : here) some.push_back(places[k]);
        const auto of_patch = terrain_heights_m({&patch, 1}, some);
        for (std::size_t k = 0; k < here.size(); ++k)
          heights[here[k]] = std::max(heights[here[k]], of_patch[k]);  // std::nullopt is less than any height
      }
    }
    return heights;
  }

  /// Reports the tiles of the component that was added last.
  void report_tiles(TiledTerrain& terrain, std::uint16_t material) {
    terrain.material = material;
    const TerrainTiles& tiles = *terrain.tiles;
    ComponentReport& report = report_.components.back();
    report.facets_in_file = tiles.facets();
    report.hole_cells = tiles.hole_cells();
    report.lo_m = tiles.lo_m();
    report.hi_m = tiles.hi_m();
    parts_.back().box = {report.lo_m, report.hi_m};
    report_.warnings.insert(report_.warnings.end(), tiles.warnings().begin(), tiles.warnings().end());
  }

  /// Height from which depths count.
  double surface_height_m() const { return sea_surface_height_m(description_); }

  bool is_tiled(std::size_t component) const { return !tiled_.empty() && tiled_[component].tiles; }

  /// Enlarges the extents, because displaced facets must fit the grid as well.
  void make_room_for(const std::vector<std::shared_ptr<const ElevationField>>& relief) {
    double largest_m = 0;
    for (const auto& field : relief)
      if (field) largest_m = std::max(largest_m, field->largest_m());
    for (std::size_t i = 0; i < components_.size(); ++i) {
      if (components_[i].mesh.points_m.empty() && !is_tiled(i)) continue;
      parts_[i].box.lo_m -= largest_m;
      parts_[i].box.hi_m += largest_m;
    }
  }

  std::size_t trajectory_of(const SensorDescription& sensor) const {
    if (!sensor.trajectory.empty()) {
      return index_of(description_.trajectories, sensor.trajectory, "trajectory", sensor.trajectory_place);
    }
    if (description_.trajectories.size() != 1) {
      throw InputError(
          sensor.place,
          fmt::format("sensor '{}' has no 'trajectory', but the scene has {} trajectories: name one of them",
                      sensor.name, description_.trajectories.size()));
    }
    return 0;
  }

  void build_mesh(Scene& scene) {
    double facets = 0;
    for (const LoadedComponent& c : components_) facets += static_cast<double>(c.mesh.triangles.size());
    // Measured peak for coincident spheres, without the input buffers, which are already allocated.
    constexpr double peak_bytes = 100, bytes_as_read = 24;
    require_memory((peak_bytes - bytes_as_read) * facets, {description_.file.string(), 0, 0},
                   fmt::format("the scene's {:.3g} facets", facets),
                   "give fewer or coarser terrains and objects");
    MeshBuilder builder(scene.grid);
    std::vector<double> given_m2;
    MeshReport of_moving;
    for (std::size_t i = 0; i < components_.size(); ++i) {
      LoadedComponent& c = components_[i];
      given_m2.push_back(area_m2(c.mesh.points_m, c.mesh.triangles));
      if (i >= components_.size() - moving_.size()) {
        const MovingObject& known = moving_[i - (components_.size() - moving_.size())];
        if (known.waves) {
          scene.moving.push_back(moving_sea_surface(c.mesh, known.waves, known.component, c.material));
          scene.moving.back().lowest_m = known.lowest_m;
          c.mesh = {};
          continue;
        }
        MovingObject object = moving_object(c.mesh, scene.grid, known.component, c.material, of_moving);
        object.trajectory = known.trajectory;
        object.on_carrier = known.on_carrier;
        object.lowest_m = known.lowest_m;
        scene.moving.push_back(std::move(object));
      } else {
        builder.add(c.mesh.points_m, c.mesh.triangles, c.material, static_cast<std::uint16_t>(i));
      }
      c.facet_materials = std::move(c.mesh.materials);
      c.mesh = {};  // frees the memory, because millions of facets need not exist twice
    }
    scene.mesh = builder.finish(report_.mesh);
    report_.mesh.degenerate_facets += of_moving.degenerate_facets;
    report_.mesh.duplicate_facets += of_moving.duplicate_facets;
    report_.mesh.largest_snap_m = std::max(report_.mesh.largest_snap_m, of_moving.largest_snap_m);
    add_moving(scene, scene.first_ping_s, scene.mesh);
    FacetId first = 0;
    for (std::size_t i = 0; i < components_.size(); ++i) {
      FacetId last = first;
      while (last < scene.mesh.facets.size() && scene.mesh.component[last] == i) ++last;
      std::ranges::copy(components_[i].facet_materials, scene.mesh.material.begin() + first);
      ComponentReport& report = report_.components[i];
      report.facets = is_tiled(i) ? report.facets_in_file : last - first;
      if (components_[i].is_file)
        report.kept_outside_halfedge = facets_outside_halfedge(scene.mesh, first, last);
      if (is_sea_surface(description_, i - description_.terrains.size())) break;  // waves enlarge its area
      const SnappedArea area{report.name, given_m2[i], area_m2(scene.mesh, scene.grid, first, last)};
      if (area.is_changed())
        report_.warnings.push_back(
            warning_of(area, scene.grid, finest_exponent(grid_box(description_, parts_))));
      first = last;
    }
  }

  const SceneDescription& description_;
  std::optional<LocalFrame> frame_;  // if empty, the first raster determines it
  std::vector<Part> parts_;
  std::vector<LoadedComponent> components_;
  std::vector<TiledTerrain> tiled_;
  std::vector<Trajectory> trajectories_;
  std::vector<MovingObject> moving_;  // without their shapes
  double first_ping_s_ = 0;
  SceneReport report_;
};

}  // namespace

Scene load_scene(const SceneDescription& description) {
  const auto rests = [](const ObjectDescription& object) { return object.trajectory.empty(); };
  const bool has_waves = description.sea_surface && description.sea_surface->has_facets();
  if (!has_waves && std::ranges::is_partitioned(description.objects, rests))
    return Loader(description).load();
  SceneDescription in_order = description;
  std::ranges::stable_partition(in_order.objects, rests);
  if (has_waves) in_order = with_sea_surface(std::move(in_order));
  return Loader(in_order).load();
}

}  // namespace tubefoot
