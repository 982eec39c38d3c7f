// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes scene files, next to a few small files that they may name. Scenes of moderate size are also
// loaded.
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>

#include "files/companions.hpp"
#include "files/shown.hpp"
#include "fuzz.hpp"
#include "run/survey.hpp"
#include "scene/description/scene_description.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot::fuzz {
namespace {

/// Files of all kinds that keys of a scene name (validation/fuzzing.md).
void write_companions() {
  scratch_file("bed.asc",
               "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 2\nNODATA_value -9\n"
               "-5 -5 -5\n-5 -4.5 -5\n-5 -5 -9\n");
  scratch_file("classes.asc",
               "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9\n1 2\n2 -9\n");
  scratch_file("rock.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  scratch_file(
      "track.csv",
      "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n0,0,0,0,0,0,0\n9,1,20,0,10,1,-1\n");
  scratch_file("pattern.csv", "angle_deg,level_db\n0,0\n10,-3\n60,-40\n");
  scratch_file("speed.csv", "depth_m,sound_speed_m_s\n0,1500\n10,1490\n50,1485\n");
  scratch_file("cast.csv", "depth_m,temperature_c,salinity_psu\n0,12,34\n10,10,34.5\n50,8,35\n");
  scratch_file("law.csv", "10,-30\n45,-25\n90,-10\n");
  scratch_file(
      "map.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"material":"sand"},)"
      R"("geometry":{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,0]]]}}]})");
}

double cells(double width, double length, double cell) {
  return cell > 0 ? (width / cell + 1) * (length / cell + 1) : 2;
}

constexpr double most_cells = 3000;

bool is_modest(const TerrainDescription& terrain) {
  double width = 20, length = 20, all = 0;
  if (const auto* flat = std::get_if<FlatTerrain>(&terrain.kind)) {
    width = flat->width_m, length = flat->length_m;
    all = cells(width, length, flat->cell_m);
  } else if (const auto* fractal = std::get_if<FractalTerrain>(&terrain.kind)) {
    width = fractal->width_m, length = fractal->length_m;
    all = cells(width, length, fractal->cell_m);
  }
  if (terrain.material_map)
    if (const auto* patches = std::get_if<PatchMaterialMap>(&terrain.material_map->kind))
      all += cells(width, length, patches->patch_size_m);
  return all <= most_cells;
}

bool is_modest(const ObjectDescription& object) {
  const double scale = *std::ranges::max_element(object.scale);
  double radius = 0;
  if (const auto* sphere = std::get_if<SpherePrimitive>(&object.kind)) radius = sphere->radius_m;
  if (const auto* cylinder = std::get_if<CylinderPrimitive>(&object.kind)) radius = cylinder->radius_m;
  if (const auto* cone = std::get_if<ConePrimitive>(&object.kind))
    radius = std::max(cone->radius_m, cone->top_radius_m);
  return !object.chord_error_m || radius * scale <= 200 * *object.chord_error_m;
}

bool is_modest(const SensorDescription& sensor) {
  const SensorFigures figures = figures_of(sensor);
  return sensor.pings <= 100 && figures.beams * figures.samples <= 1'000'000 && figures.beams <= 512;
}

bool is_modest(const MaterialDescription& material) {
  for (const ReliefDescription& relief : material.relief)
    if (cells(relief.tile_m, relief.tile_m, relief.resolution_m) > most_cells) return false;
  return true;
}

/// Returns whether the scene loads quickly, even with sanitizers.
bool is_modest(const SceneDescription& scene) {
  const auto all = [](const auto& list) {
    return list.size() <= 8 && std::ranges::all_of(list, [](const auto& one) { return is_modest(one); });
  };
  const WaterDescription& water = scene.water;
  return all(scene.terrains) && all(scene.objects) && all(scene.sensors) && all(scene.materials) &&
         water.profile_bottom_m.value_or(0) <= 1e4 * water.profile_step_m.value_or(1) &&
         (scene.refinement.mode != "offline" || scene.materials.front().relief.empty()) &&
         (!scene.refinement.cell_m || *scene.refinement.cell_m >= 0.5);
}

void open(const SceneDescription& description) {
  const auto survey = open_survey(description);
  if (survey->sensors.size() != description.sensors.size()) finding("a sensor was lost");
  for (const SensorPings& sensor : survey->sensors)
    for (const Pose& pose : sensor.poses)
      if (!std::isfinite(pose.position_m.x + pose.position_m.y + pose.position_m.z) ||
          !(std::abs(glm::length(pose.attitude) - 1) < 1e-6))
        finding("a pose that is none");
  for (const std::string& warning : survey->scene.report.warnings) check_message(shown(warning));
}

}  // namespace
}  // namespace tubefoot::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  tubefoot::fuzz::write_companions();
  return 0;
}

/// The text of a scene file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  const auto file = fuzz::scratch_file("scene.toml", fuzz::Bytes(data, size).rest());
  fuzz::may_refuse([&] {
    const SceneDescription description = read_scene_file(file);
    if (fuzz::is_modest(description)) fuzz::open(description);
  });
  return 0;
}
