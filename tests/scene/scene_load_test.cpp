// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the loading of scenes: reports and warnings, areas on the grid, placement of objects,
// georeferences, and rejected scenes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "engine/water/absorption.hpp"
#include "engine/water/sound_speed.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/scene.hpp"
#include "scene/terrain_height.hpp"
#include "sensors/kinds/kind_didson.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

ObjectDescription object(const std::string& name, decltype(ObjectDescription::kind) kind) {
  ObjectDescription o;
  o.place = {"scene.toml", 20, 1};
  o.name = name;
  o.material = "steel";
  o.kind = std::move(kind);
  return o;
}

TerrainDescription terrain(decltype(TerrainDescription::kind) kind) {
  TerrainDescription t;
  t.place = {"scene.toml", 10, 1};
  t.material = "sand";
  t.kind = std::move(kind);
  return t;
}

// Flat sand at -10 m, 100 m x 100 m; a fixed carrier at the origin with one sensor.
SceneDescription pond() {
  SceneDescription d;
  d.file = "scene.toml";
  d.materials.resize(2);
  d.materials[0].name = "sand";
  d.materials[0].lambert_db = -30;
  d.materials[1].name = "steel";
  d.materials[1].lambert_db = -10;
  d.terrains.push_back(terrain(FlatTerrain{100, 100, {0, 0, -10}, 0}));
  d.trajectories.resize(1);
  d.trajectories[0].kind = FixedTrajectory{};
  d.sensors.resize(1);
  d.sensors[0].place = {"scene.toml", 40, 1};
  d.sensors[0].name = "camera";
  d.sensors[0].kind = DidsonDescription();
  return d;
}

// Vertices of a component in metres, in order of first use.
std::vector<glm::dvec3> vertices(const Scene& scene, std::uint16_t component) {
  std::vector<glm::dvec3> found;
  for (std::size_t f = 0; f < scene.mesh.facets.size(); ++f) {
    if (scene.mesh.component[f] != component) continue;
    for (const VertexId v : scene.mesh.facets[f]) {
      const glm::dvec3 p = scene.grid.to_metres(scene.mesh.vertices[v]);
      if (std::find(found.begin(), found.end(), p) == found.end()) found.push_back(p);
    }
  }
  return found;
}

TEST(LoadScene, ReportsWhatItLoaded) {
  SceneDescription d = pond();
  d.objects.push_back(object("crate", BoxPrimitive{{2, 4, 6}}));
  d.objects[0].position_m = {5, 6, -7};
  const Scene scene = load_scene(d);
  ASSERT_THAT(scene.report.components, SizeIs(2));
  const ComponentReport& crate = scene.report.components[1];
  EXPECT_EQ(crate.name, "crate");
  EXPECT_EQ(crate.facets_in_file, 12u);
  EXPECT_EQ(crate.facets, 12u);
  EXPECT_EQ(crate.lo_m, glm::dvec3(4, 4, -10));
  EXPECT_EQ(crate.hi_m, glm::dvec3(6, 8, -4));
  EXPECT_THAT(scene.mesh.facets, SizeIs(14));
  EXPECT_EQ(scene.mesh.material.front(), 0);
  EXPECT_EQ(scene.mesh.material.back(), 1);
  EXPECT_THAT(scene.material_mu, ElementsAre(testing::DoubleEq(1e-3), testing::DoubleEq(0.1)));
  EXPECT_THAT(scene.sensor_trajectory, ElementsAre(0));
  EXPECT_THAT(scene.report.warnings, IsEmpty());
  EXPECT_EQ(scene.grid.exponent(), 20);
}

// --- areas on the grid ---

/// The warnings of a scene with only this object over the pond.
std::vector<std::string> warnings_with(ObjectDescription tiny) {
  SceneDescription d = pond();
  tiny.position_m = {0.3, 0.3, -5.1};
  d.objects.push_back(std::move(tiny));
  return load_scene(d).report.warnings;
}

// 10 micrometres are 10.5 units of the grid, which rounding makes 10 or 11.
TEST(SnappedAreas, AreWarnedOfWhereAnObjectOfAnyKindChangesByAThousandth) {
  const TestFolder folder;
  const auto changes =
      Contains(AllOf(HasSubstr("'tiny': rounding to the grid with its unit of 9.54e-07 m changes the area"),
                     HasSubstr("'grid_exponent' in [run]"), HasSubstr("(at most 23 ")));
  EXPECT_THAT(warnings_with(object("tiny", BoxPrimitive{{1e-5, 1e-5, 1e-5}})), changes);
  EXPECT_THAT(warnings_with(object("tiny", SpherePrimitive{1e-6})), changes);
  EXPECT_THAT(warnings_with(object("tiny", CylinderPrimitive{1e-6, 2e-6})), changes);
  EXPECT_THAT(warnings_with(object("tiny", ConePrimitive{1e-6, 0, 2e-6})), changes);
  MeshFile mesh;
  mesh.file = folder.write("tiny.obj", "v 0 0 0\nv 1e-5 0 0\nv 0 1e-5 0\nf 1 2 3\n");
  EXPECT_THAT(warnings_with(object("tiny", mesh)), changes);
  mesh.file = folder.write("large.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(warnings_with(object("tiny", mesh)), IsEmpty());
  ObjectDescription scaled = object("tiny", mesh);
  scaled.scale = {1e-5, 1e-5, 1e-5};
  EXPECT_THAT(warnings_with(scaled), changes);
  ObjectDescription thin = object("tiny", BoxPrimitive{{1, 1e-5, 1e-5}});
  EXPECT_THAT(warnings_with(thin), changes);
  EXPECT_THAT(warnings_with(object("tiny", BoxPrimitive{{0.01, 0.01, 0.01}})), IsEmpty());
}

TEST(SnappedAreas, AreWarnedOfForTerrain) {
  SceneDescription d = pond();
  d.terrains[0] = terrain(FlatTerrain{1e-5, 1e-5, {0, 0, -10}, 0});
  d.terrains[0].name = "speck";
  EXPECT_THAT(load_scene(d).report.warnings,
              Contains(HasSubstr("'speck': rounding to the grid with its unit of")));
}

TEST(SnappedAreas, AreKeptByTheFinerGridThatTheWarningNames) {
  SceneDescription d = pond();
  d.terrains.clear();
  d.objects.push_back(object("tiny", BoxPrimitive{{1e-5, 1e-5, 1e-5}}));
  d.objects[0].position_m = {0, 0.1, -0.2};
  EXPECT_THAT(load_scene(d).report.warnings, Contains(HasSubstr("(at most 30 ")));
  d.run.grid_exponent = 30;
  EXPECT_THAT(load_scene(d).report.warnings, IsEmpty());
}

TEST(LoadScene, WaterFollowsTheFormulasUnlessItIsGiven) {
  SceneDescription d = pond();
  d.water.temperature_c = 4;
  d.water.depth_m = 100;
  EXPECT_EQ(load_scene(d).sound_speed_m_s, mackenzie_sound_speed_m_s(4, 35, 100));
  EXPECT_EQ(absorption_db_per_km(d.water, 300), francois_garrison_absorption_db_per_km(300, 4, 35, 100, 8));
  d.water.sound_speed_m_s = 1481;
  d.water.absorption_db_per_km = 77;
  EXPECT_EQ(load_scene(d).sound_speed_m_s, 1481);
  EXPECT_EQ(absorption_db_per_km(d.water, 300), 77);
}

// --- placement ---

MeshFile mesh_file(const std::filesystem::path& file) {
  MeshFile mesh;
  mesh.file = file;
  return mesh;
}

TEST(Placement, TurnsYUpThenScalesThenTurnsThenMoves) {
  const TestFolder folder;
  SceneDescription d = pond();
  // One triangle: its points lie along x, y (up) and z (towards the viewer, which is south) of the file.
  d.objects.push_back(
      object("mark", mesh_file(folder.write("mark.obj", "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"))));
  ObjectDescription& mark = d.objects[0];
  std::get<MeshFile>(mark.kind).up = "y";
  EXPECT_THAT(vertices(load_scene(d), 1),
              ElementsAre(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, -1, 0)));
  mark.scale = {2, 3, 4};
  EXPECT_THAT(vertices(load_scene(d), 1),
              ElementsAre(glm::dvec3(2, 0, 0), glm::dvec3(0, 0, 4), glm::dvec3(0, -3, 0)));
  mark.heading_deg = 90;  // clockwise: east turns to the south, south to the west
  mark.position_m = {10, 20, -5};
  EXPECT_THAT(vertices(load_scene(d), 1),
              ElementsAre(glm::dvec3(10, 18, -5), glm::dvec3(10, 20, -1), glm::dvec3(7, 20, -5)));
}

TEST(Placement, RollLowersStarboardAndPitchRaisesTheBow) {
  SceneDescription d = pond();
  d.objects.push_back(object("crate", BoxPrimitive{{2, 4, 8}}));
  d.objects[0].roll_deg = 90;
  Scene scene = load_scene(d);
  EXPECT_LE(glm::distance(scene.report.components[1].hi_m, glm::dvec3(4, 2, 1)), 1e-12);
  d.objects[0].roll_deg = 0;
  d.objects[0].pitch_deg = 90;
  scene = load_scene(d);
  EXPECT_LE(glm::distance(scene.report.components[1].hi_m, glm::dvec3(1, 4, 2)), 1e-12);
}

TEST(Placement, StandsOnTheTerrainBelowItsPosition) {
  SceneDescription d = pond();
  const TestFolder folder;
  // A slope that rises by 1 m per 2 m to the east, from -10 m at x = 0.
  const auto slope =
      folder.write("slope.asc",
                   "ncols 3\nnrows 3\nxllcorner -30\nyllcorner -30\ncellsize 20\nNODATA_value -9999\n"
                   "-20 -10 0\n-20 -10 0\n-20 -10 0\n");
  d.terrains = {terrain(RasterTerrain{slope, {}, 1, false})};
  d.objects.push_back(object("ball", SpherePrimitive{1.0}));
  d.objects[0].position_m = {6, 3.3, 999};
  d.objects[0].on_terrain_m = 0.25;
  const Scene scene = load_scene(d);
  EXPECT_NEAR(scene.report.components[1].lo_m.z, -10 + 3 + 0.25, 1e-12);
  EXPECT_NEAR(scene.report.components[1].hi_m.x, 7, 0.02);

  d.objects[0].position_m = {600, 0, 0};
  EXPECT_THAT([&] { load_scene(d); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:20:1"), HasSubstr("no terrain below"))));
}

TEST(Placement, TheHighestTerrainCountsAndEdgesAndCornersBelongToIt) {
  ComponentMesh low, high;
  low.points_m = {{0, 0, 0}, {4, 0, 0}, {0, 4, 4}};
  low.triangles = {{0, 1, 2}};
  high.points_m = {{0, 0, 9}, {1, 0, 9}, {0, 1, 9}};
  high.triangles = {{0, 1, 2}};
  const std::vector<ComponentMesh> both = {low, high};
  const std::vector<glm::dvec2> places{{0.25, 0.25}, {2, 1}, {0, 4}, {2, 2}, {2, 2.0001}};
  EXPECT_THAT(terrain_heights_m(both, places), ElementsAre(9.0, 1.0, 4.0, 2.0, std::nullopt));
  EXPECT_THAT(terrain_heights_m(both, std::span(places).last(1)), ElementsAre(std::nullopt));
  EXPECT_THAT(terrain_heights_m(both, {}), IsEmpty());
}

TEST(Placement, HeightsOfManyPlacesAreThoseOfEach) {
  constexpr unsigned seed = 21;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> at(-30, 30);
  ComponentMesh polygons;
  for (std::uint32_t k = 0; k < 200; ++k) {
    const glm::dvec3 corner(at(random), at(random), at(random));
    for (int c = 0; c < 3; ++c)
      polygons.points_m.push_back(corner + 0.3 * glm::dvec3(at(random), at(random), 1));
    polygons.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  std::vector<glm::dvec2> places;
  for (int k = 0; k < 300; ++k) places.emplace_back(1.4 * at(random), 0.2 * at(random));
  const auto together = terrain_heights_m({&polygons, 1}, places);
  for (std::size_t k = 0; k < places.size(); ++k)
    EXPECT_EQ(together[k], terrain_heights_m({&polygons, 1}, {&places[k], 1}).front())
        << "seed " << seed << ", " << k;
}

TEST(Placement, LatitudeAndLongitudeNeedAGeoreference) {
  SceneDescription d = pond();
  d.objects.push_back(object("buoy", SpherePrimitive{1.0}));
  d.objects[0].position_m = {0, 0, -4};
  d.objects[0].position_lat_lon_deg = {{60.0001, 20.0}};
  EXPECT_THAT([&] { load_scene(d); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:20:1"), HasSubstr("[georeference]"))));
  d.georeference.emplace();
  d.georeference->origin_lat_lon_deg = {{60, 20}};
  const ComponentReport buoy = load_scene(d).report.components[1];
  // A ten-thousandth of a degree of meridian at 60 degrees north is 11.1412 m.
  EXPECT_NEAR((buoy.lo_m.y + buoy.hi_m.y) / 2, 11.1412, 2e-3);
  EXPECT_NEAR((buoy.lo_m.z + buoy.hi_m.z) / 2, -4, 0.01);
}

TEST(LoadScene, TheChordErrorHoldsAfterScaling) {
  SceneDescription d = pond();
  d.objects.push_back(object("ball", SpherePrimitive{1.0}));
  d.objects[0].chord_error_m = 0.01;
  const std::size_t small = load_scene(d).report.components[1].facets;
  d.objects[0].scale = {10, 10, 10};
  const std::size_t scaled = load_scene(d).report.components[1].facets;
  d.objects[0] = object("ball", SpherePrimitive{10.0});
  d.objects[0].chord_error_m = 0.01;
  EXPECT_EQ(scaled, load_scene(d).report.components[1].facets);
  EXPECT_GT(scaled, 5 * small);
}

// --- files, grid, pings ---

TEST(LoadScene, KeepsEveryFacetOfABadMeshAndSaysSo) {
  const TestFolder folder;
  SceneDescription d = pond();
  d.objects.push_back(
      object("bad", mesh_file(folder.write("bad.obj",
                                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 2 0 0\n"
                                           "f 1 2 3\nf 2 1 4\nf 1 2 5\nf 1 2 3\nf 1 2 6\n"))));
  const Scene scene = load_scene(d);
  const ComponentReport& bad = scene.report.components[1];
  EXPECT_EQ(bad.facets_in_file, 5u);
  EXPECT_EQ(bad.facets, 5u);
  EXPECT_EQ(bad.kept_outside_halfedge, 3u);
  EXPECT_EQ(scene.report.mesh.degenerate_facets, 1u);
  EXPECT_EQ(scene.report.mesh.duplicate_facets, 1u);
  EXPECT_THAT(scene.report.warnings, Contains(HasSubstr("1 facets have no area")));
  EXPECT_THAT(scene.report.warnings, Contains(HasSubstr("1 facets coincide with an earlier facet")));
}

TEST(LoadScene, AnErrorInAFileNamesTheSceneToo) {
  const TestFolder folder;
  SceneDescription d = pond();
  d.objects.push_back(object("bad", mesh_file(folder.write("bad.obj", "v 0 0 nan\n"))));
  EXPECT_THAT([&] { load_scene(d); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:20:1: "), HasSubstr("bad.obj:1:7: "))));
  d = pond();
  d.terrains = {terrain(RasterTerrain{folder.write("empty.tif", ""), {}, 1, false})};
  EXPECT_THAT([&] { load_scene(d); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:10:1: "), HasSubstr("empty.tif: "))));
}

TEST(LoadScene, TheGridHoldsFacetsAndSensorsWithTheirLeverArms) {
  SceneDescription d = pond();
  d.trajectories[0].kind = LineTrajectory{{0, 0, 0}, {0, 910, 0}, 10, 0, 0};
  d.sensors[0].pings = 91;
  d.sensors[0].ping_interval_s = 1;
  d.sensors[0].lever_arm_m = {0, 100, 0};
  const Scene scene = load_scene(d);
  EXPECT_EQ(scene.grid.exponent(), 19);  // 1050 m; without the lever arm, 950 m would take 2^-20 m
  for (const glm::dvec3& p : {glm::dvec3(0, 1000, 0), glm::dvec3(-50, -50, -10)}) {
    const GridPoint snapped = scene.grid.snap(p);
    EXPECT_LE(std::abs(std::int64_t{snapped.y}), 1 << 29);
    EXPECT_LE(glm::distance(scene.grid.to_metres(snapped), p), scene.grid.unit_m());
  }
}

TEST(LoadScene, TranslationByGridVectorsMovesTheSceneAndNothingElse) {
  SceneDescription d = pond();
  d.objects.push_back(object("ball", SpherePrimitive{1.3}));
  d.objects[0].position_m = {0.25, 0.75, -9};
  const Scene here = load_scene(d);
  const double shift = 4096;  // an integer number of units at 2^-20 m, small enough for exact sums
  std::get<FlatTerrain>(d.terrains[0].kind).centre_m[0] += shift;
  std::get<FixedTrajectory>(d.trajectories[0].kind).position_m[0] += shift;
  d.objects[0].position_m[0] += shift;
  const Scene there = load_scene(d);
  EXPECT_EQ(here.mesh.facets, there.mesh.facets);
  EXPECT_EQ(there.grid.origin_m() - here.grid.origin_m(), glm::dvec3(shift, 0, 0));
  ASSERT_EQ(here.mesh.vertices.size(), there.mesh.vertices.size());
  for (std::size_t i = 0; i < here.mesh.vertices.size(); ++i)
    EXPECT_EQ(here.mesh.vertices[i], there.mesh.vertices[i]);
}

TEST(LoadScene, CoordinatesBeyondTheGridAreRefused) {
  SceneDescription d = pond();
  d.objects.push_back(object("moon", SpherePrimitive{1.0}));
  d.objects[0].position_m = {3e9, 0, 0};
  EXPECT_THAT([&] { load_scene(d); }, ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:20:1"),
                                                                      HasSubstr("'moon' reaches 3e+09 m"))));
  std::get<FixedTrajectory>(d.trajectories[0].kind).position_m = {0, -4e9, 0};
  EXPECT_THAT(
      [&] { load_scene(d); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:40:1"), HasSubstr("'camera' reaches 4e+09 m"))));
  std::get<FixedTrajectory>(d.trajectories[0].kind).position_m = {0, 0, 0};
  d.objects[0].position_m = {5000, 0, 0};
  d.run.place = {"scene.toml", 60, 1};
  d.run.grid_exponent = 20;
  EXPECT_THAT([&] { load_scene(d); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:60:1"), HasSubstr("2^-17 m would fit"))));
  d.run.grid_exponent = 12;
  EXPECT_EQ(load_scene(d).grid.exponent(), 12);
  d.run.grid_exponent.reset();
  d.objects[0].position_m = {5e6, 0, 0};
  EXPECT_THAT(load_scene(d).report.warnings, Contains(HasSubstr("unit of")));
}

TEST(LoadScene, PingsOutsideTheTrajectoryAreRefused) {
  SceneDescription d = pond();
  d.trajectories[0].name = "pass";
  d.trajectories[0].kind = LineTrajectory{{0, 0, 0}, {0, 20, 0}, 1, 0, 0};
  d.sensors[0].pings = 201;
  d.sensors[0].ping_interval_s = 0.1;  // the last ping is at 200 * 0.1 s, with or without rounding
  EXPECT_NO_THROW(load_scene(d));
  d.sensors[0].pings = 202;
  EXPECT_THAT(
      [&] { load_scene(d); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:40:1"), HasSubstr("ping 201 of sensor 'camera'"),
                                      HasSubstr("'pass'"), HasSubstr("0 s to 20 s"))));
  d.sensors[0].pings = 2;
  d.sensors[0].first_ping_s = -1;
  EXPECT_THAT([&] { load_scene(d); }, ThrowsMessage<InputError>(HasSubstr("ping 0")));
}

TEST(LoadScene, NamesThatReferToNothingAreRefused) {
  SceneDescription d = pond();
  d.terrains[0].material = "mud";
  d.terrains[0].material_place = {"scene.toml", 12, 3};
  EXPECT_THAT([&] { load_scene(d); }, ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:12:3"),
                                                                      HasSubstr("no material named 'mud'"))));
  d = pond();
  d.sensors[0].trajectory = "pas";
  EXPECT_THAT([&] { load_scene(d); }, ThrowsMessage<InputError>(HasSubstr("no trajectory named 'pas'")));
  d = pond();
  d.trajectories.resize(2);
  EXPECT_THAT([&] { load_scene(d); }, ThrowsMessage<InputError>(HasSubstr("has no 'trajectory'")));
}

TEST(LoadScene, TheWholeRealGridKeepsItsFacetsAndItsPlace) {
  const std::filesystem::path file = TUBEFOOT_SOURCE_DIR "/scenes/data/jd211.bag";
  SceneDescription d = pond();
  d.terrains = {terrain(RasterTerrain{file, {}, 1, false})};
  d.georeference.emplace();
  d.georeference->crs = "EPSG:32602";
  d.georeference->origin_crs = {{621500, 7245500}};
  const Scene scene = load_scene(d);
  const ComponentReport& report = scene.report.components[0];
  EXPECT_EQ(report.facets, scene.mesh.facets.size());
  EXPECT_GT(report.facets, 2'300'000u);
  EXPECT_GT(report.hole_cells, 1'000'000u);
  EXPECT_EQ(scene.report.mesh.degenerate_facets, 0u);
  EXPECT_EQ(scene.report.mesh.duplicate_facets, 0u);
  // Cell centres lie 1 m + 2 m k from the origin 620152.872885373 of the file, to the rounding of doubles
  // at 7e6 m.
  const double offset = report.lo_m.x + 621500 - 620152.872885372955352 - 1;
  EXPECT_NEAR(offset / 2, std::round(offset / 2), 1e-9);
  EXPECT_LE(scene.report.mesh.largest_snap_m, std::sqrt(0.75) * scene.grid.unit_m());
}

}  // namespace
}  // namespace tubefoot
