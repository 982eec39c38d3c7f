// SPDX-License-Identifier: GPL-3.0-or-later
// Tests objects that move on trajectories. An object at a ping equals the same object at rest at the pose of
// this ping. Only the position relative to the sonar counts.
#include "scene/moving_objects.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "fixtures/covered.hpp"
#include "fixtures/every_feature.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "run/signals.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/signal_recording.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Position = std::array<double, 3>;

/// A unit of 2^-14 m: the positions of these tests are points of the grid.
const std::string fixed_grid = "[run]\ngrid_exponent = 14\n";

std::string trajectory(const std::string& name, const std::string& keys) {
  return fmt::format("[[trajectories]]\nname = \"{}\"\n{}", name, keys);
}

std::string fixed(const std::string& name, Position p, double heading_deg = 0) {
  return trajectory(name, fmt::format("kind = \"fixed\"\nposition_m = [{}, {}, {}]\nheading_deg = {}\n", p[0],
                                      p[1], p[2], heading_deg));
}

/// Waypoints at intervals of 0.5 s, and their trajectory.
std::string waypoints(const TestFolder& folder, const std::string& name,
                      const std::vector<Position>& positions, const std::vector<double>& headings_deg = {}) {
  std::string file = "time_s,east_m,north_m,up_m,heading_deg\n";
  for (std::size_t k = 0; k < positions.size(); ++k)
    file += fmt::format("{},{},{},{},{}\n", 0.5 * static_cast<double>(k), positions[k][0], positions[k][1],
                        positions[k][2], headings_deg.empty() ? 0 : headings_deg[k]);
  folder.write(name + ".csv", file);
  return trajectory(name, fmt::format("kind = \"waypoints\"\nfile = \"{}.csv\"\n", name));
}

std::string object(const std::string& name, const std::string& shape, const std::string& on_trajectory,
                   Position p = {0, 0, 0}, double heading_deg = 0) {
  return fmt::format("[[objects]]\nname = \"{}\"\n{}position_m = [{}, {}, {}]\nheading_deg = {}\n{}", name,
                     shape, p[0], p[1], p[2], heading_deg,
                     on_trajectory.empty() ? "" : fmt::format("trajectory = \"{}\"\n", on_trajectory));
}
const std::string round_shape = "shape = \"sphere\"\nradius_m = 0.5\nchord_error_m = 0.02\n",
                  slab = "shape = \"box\"\nsize_m = [1.5, 0.5, 0.75]\n";

std::string sonar(const std::string& on_trajectory, std::size_t pings, const std::string& more = "") {
  return fmt::format(
      "[[sensors]]\nname = \"sonar\"\ntrajectory = \"{}\"\npings = {}\nping_interval_s = 0.5\n{}",
      on_trajectory, pings,
      more.empty() ? "kind = \"imaging\"\nbeams = 8\nhorizontal_deg = 40\nvertical_deg = 40\nsamples = 60\n"
                     "range_max_m = 12\n"
                   : more);
}

/// Runs a scene without pictures, which take longer than the echoes.
Echoes energies_in(const TestFolder& folder, const std::string& scene,
                   std::vector<std::string> arguments = {}) {
  arguments.insert(arguments.end(), {"--pictures", "none"});
  return echoes_in(folder, scene, arguments);
}

/// The sectors cut the object.
const std::string narrow_camera =
    "kind = \"imaging\"\nbeams = 4\nhorizontal_deg = 60\nvertical_deg = 14\nsamples = 60\nrange_max_m = 12\n";

const std::vector<Position> path{{-1, 6, 0.5}, {-0.25, 6.5, 0.25}, {0.75, 5, -0.5}, {1.5, 7.25, 0}};

/// The path of a sonar from which an object at path[0] looks as one on `path` does from the origin.
std::vector<Position> opposite_path() {
  std::vector<Position> opposite;
  for (const Position& p : path)
    opposite.push_back({path[0][0] - p[0], path[0][1] - p[1], path[0][2] - p[2]});
  return opposite;
}

// Law J1.
TEST(MovingObject, MovesLikeTheSonarInTheOppositeDirection) {
  const TestFolder folder;
  const std::string material = lambert_material("rock", -10) + fixed_grid;
  const Echoes moving =
                   energies_in(folder, material + waypoints(folder, "swim", path) + fixed("mast", {0, 0, 0}) +
                                           object("fish", round_shape, "swim") + sonar("mast", 4)),
               moved = energies_in(folder, material + waypoints(folder, "boat", opposite_path()) +
                                               object("fish", round_shape, "", path[0]) + sonar("boat", 4));
  ASSERT_GT(moving.total(), 0);
  EXPECT_EQ(moving.energy, moved.energy);
  EXPECT_NE(moving.beam_total(0, 2), moving.beam_total(1, 2));
}

// Law J1, for the exact shares of facets that several pings see.
TEST(MovingObject, IsCoveredLikeAnObjectAtRestByASonarThatMoves) {
  const TestFolder folder;
  const std::string scene = lambert_material("rock", -10) + fixed_grid;
  for (const bool separate : {false, true}) {
    const std::string of_sonar = narrow_camera + (separate ? "receiver_arm_m = [0.5, 0, 0.25]\n" : "");
    const Covered moving =
                      covered(folder, scene + waypoints(folder, "swim", path) + fixed("mast", {0, 0, 0}) +
                                          object("fish", round_shape, "swim") + sonar("mast", 4, of_sonar)),
                  moved = covered(folder, scene + waypoints(folder, "boat", opposite_path()) +
                                              object("fish", round_shape, "", path[0]) +
                                              sonar("boat", 4, of_sonar));
    EXPECT_EQ(moving.table, moved.table);
    EXPECT_GT(moving.shadow_m2, 0.1);
    EXPECT_NE(moving.table,
              covered(folder, scene + fixed("mast", {0, 0, 0}) + object("fish", round_shape, "", path[0]) +
                                  sonar("mast", 4, of_sonar))
                  .table);
  }
}

// Between the points of the grid, the object as a whole is rounded, and not each vertex.
TEST(MovingObject, KeepsItsShapeAtAnyPosition) {
  const TestFolder folder;
  const Scene scene = load_scene(read_scene_file(
      folder.write("scene.toml", lambert_material("rock", -10) + fixed_grid + fixed("mast", {0, 0, 0}) +
                                     waypoints(folder, "swim", {{-1.01, 6.003, 0.5}, {0.777, 5.1, -0.3}}) +
                                     object("fish", round_shape, "swim") + sonar("mast", 1))));
  const auto shape_at = [&](double time_s) {
    FacetMesh mesh = scene.mesh;
    place_moving(scene, time_s, mesh);
    const GridPoint first = mesh.vertices[0];
    std::vector<GridPoint> shape;
    for (const GridPoint& p : mesh.vertices) shape.push_back({p.x - first.x, p.y - first.y, p.z - first.z});
    return shape;
  };
  for (int k = 1; k <= 50; ++k) EXPECT_EQ(shape_at(0.01 * k), shape_at(0));
}

TEST(MovingObject, OnAFixedTrajectoryIsAnObjectAtRest) {
  const TestFolder folder;
  const std::string scene = lambert_material("rock", -10) + fixed_grid + flat_terrain(20, 30) +
                            fixed("mast", {0, 0, 3}) + fixed("stand", {0.5, 4, 0.75}, 20) +
                            sonar("mast", 1, "kind = \"didson\"\ntilt_deg = 20\nvertical_deg = 30\n");
  const Echoes moving = energies_in(folder, scene + object("thing", slab, "stand", {0, 0, 0}, 10)),
               at_rest = energies_in(folder, scene + object("thing", slab, "", {0.5, 4, 0.75}, 30));
  ASSERT_GT(at_rest.total(), 0);
  EXPECT_EQ(moving.energy, at_rest.energy);
}

/// A slab on a path over a seabed, or at rest at the pose of one ping.
struct SlabOverSeabed : testing::Test {
  TestFolder folder;
  std::vector<Position> places{{-1, 4, 0.5}, {-0.25, 4.5, 0.25}, {0.75, 3.5, 0.5}};
  std::vector<double> headings_deg{0, 40, 110};

  std::string terrain = rough_terrain(16, 16, 0.5), materials = lambert_material("rock", -10),
              of_objects = "";

  std::string scene(std::optional<std::size_t> ping, const std::string& more, const std::string& of_sonar) {
    return materials + fixed_grid + terrain + more + fixed("mast", {0, 0, 2}) +
           waypoints(folder, "swim", places, headings_deg) +
           object("stone", round_shape + of_objects, "", {1.5, 4.5, 0.25}) +
           (ping ? object("thing", slab + of_objects, "", places[*ping], headings_deg[*ping])
                 : object("thing", slab + of_objects, "swim")) +
           sonar("mast", 3, of_sonar);
  }
  std::string of_relief;
  void add_relief(const std::string& mode) {
    materials = lambert_material("rock", -10) + lambert_material("sand", -20) +
                "[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\nresolution_m = 0.04\nseed = 7\n"
                "wavelength_m = 1.25\ndirection_deg = 20\nrms_height_m = 0.02\n";
    of_objects = "material = \"rock\"\n";
    terrain = rough_terrain(16, 16, 0.5, "material = \"sand\"\n");
    of_relief =
        "[relief]\nmode = \"" + mode + "\"\ncell_m = 0.25\n" + (mode == "online" ? "tolerance = 0.5\n" : "");
  }
  void expect_poses(const std::string& more, const std::string& of_sonar,
                    const std::vector<std::string>& arguments = {}) {
    SCOPED_TRACE(more + of_sonar);
    const Echoes moving = energies_in(folder, scene({}, more, of_sonar), arguments);
    const std::size_t cells = moving.energy.size() / 3;
    for (std::size_t ping = 0; ping < 3; ++ping) {
      const Echoes at_rest = energies_in(folder, scene(ping, more, of_sonar), arguments);
      ASSERT_EQ(at_rest.energy.size(), moving.energy.size());
      double largest = 0, other = 0;
      for (std::size_t k = ping * cells; k < (ping + 1) * cells; ++k)
        largest = std::max(largest, at_rest.energy[k]);
      ASSERT_GT(largest, 0);
      for (std::size_t k = 0; k < cells; ++k) {
        EXPECT_NEAR(moving.energy[ping * cells + k], at_rest.energy[ping * cells + k], 1e-12 * largest);
        other = std::max(other, std::abs(moving.energy[(ping + 1) % 3 * cells + k] -
                                         at_rest.energy[(ping + 1) % 3 * cells + k]));
      }
      EXPECT_GT(other, 1e-3 * largest) << "the object does not move";
    }
  }
};
const std::string watching_camera =
    "kind = \"imaging\"\nbeams = 6\nhorizontal_deg = 40\nvertical_deg = 40\n"
    "tilt_deg = 20\nsamples = 40\nrange_min_m = 1\nrange_max_m = 8\n";

TEST_F(SlabOverSeabed, HasThePoseOfEachPing) {
  expect_poses("", watching_camera);
  expect_poses("", watching_camera, {"--engine", "ray", "--rays-per-beam", "4000"});
  expect_poses("", watching_camera + "receiver_arm_m = [0.5, 0, 0]\n");
  expect_poses("",
               "kind = \"interferometric\"\nalong_track_deg = 8\nfrequency_khz = 100\nbaseline_m = 0.05\n"
               "yaw_deg = -90\nsamples = 40\nrange_min_m = 1\nrange_max_m = 8\n");
}

// Beam b belongs to cycle b mod 2. The second cycle is sent half way to the next waypoint.
TEST_F(SlabOverSeabed, HasThePoseOfEachCycleOfAFrame) {
  headings_deg = {40, 40, 40, 40};
  places.push_back({1.5, 4.5, 0.5});
  const std::string of_sonar =
      "kind = \"didson\"\nbeams = 8\nhorizontal_deg = 32\nvertical_deg = 40\ntilt_deg = 20\nsamples = 40\n"
      "window_start_m = 1\nwindow_length_m = 7\ncycles = 2\ncycle_interval_s = 0.25\n";
  const Echoes moving = energies_in(folder, scene({}, "", of_sonar)),
               first = energies_in(folder, scene(0, "", of_sonar));
  for (std::size_t k = 0; k < 3; ++k) places[0][k] = (places[0][k] + places[1][k]) / 2;
  const Echoes second = energies_in(folder, scene(0, "", of_sonar));
  for (std::size_t beam = 0; beam < 8; ++beam)
    EXPECT_EQ(moving.beam_total(0, beam), (beam % 2 == 0 ? first : second).beam_total(0, beam)) << beam;
  EXPECT_NE(first.beam_total(0, 4), second.beam_total(0, 4));
}

TEST_F(SlabOverSeabed, IsCutAtTheSeaSurfaceAndMirroredThere) {
  expect_poses("[sea_surface]\nheight_m = 2.5\n", watching_camera);
  expect_poses("[sea_surface]\nheight_m = 2.5\n[paths]\norder = 2\n", watching_camera);
  for (Position& p : places) p[2] += 1.75;  // through the surface
  expect_poses("[sea_surface]\nheight_m = 2.5\n", watching_camera);
  expect_poses("[sea_surface]\nheight_m = 2.5\n", watching_camera,
               {"--engine", "ray", "--rays-per-beam", "4000"});
}

TEST_F(SlabOverSeabed, ScattersTwice) {
  expect_poses("[paths]\norder = 2\nscatterings = 2\npatch_m = 1\n", watching_camera);
}

TEST_F(SlabOverSeabed, IsTheSameOverTiles) {
  folder.write("bed.asc", seabed_of_steps());
  const auto over = [&](const std::string& load) {
    terrain = "[[terrain]]\nname = \"bed\"\nkind = \"raster\"\nfile = \"bed.asc\"\nload = \"" + load +
              "\"\n" + (of_objects.empty() ? "" : "material = \"sand\"\n");
    return energies_in(folder, scene({}, of_relief, watching_camera));
  };
  for (const std::string mode : {"off", "offline", "online"}) {
    SCOPED_TRACE(mode);
    if (mode != "off") add_relief(mode);
    const Echoes whole = over("whole");
    ASSERT_GT(whole.total(), 0);
    EXPECT_EQ(over("tiles").energy, whole.energy);
  }
}

TEST_F(SlabOverSeabed, LiesOverRelief) {
  for (const char* mode : {"offline", "online"}) {
    add_relief(mode);
    expect_poses(of_relief, watching_camera);
  }
  expect_poses(of_relief + "[sea_surface]\nheight_m = 2.5\n[paths]\norder = 2\n", watching_camera);
}

TEST_F(SlabOverSeabed, IsSeenThroughStratifiedWater) {
  const std::string water =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
      "profile_bottom_m = 40\nsurface_height_m = 2.5\n";
  expect_poses(water, watching_camera);
  expect_poses(water, watching_camera + "receiver_arm_m = [0.5, 0, 0]\n");
  expect_poses(water + "[sea_surface]\nheight_m = 2.5\n[paths]\norder = 2\n", watching_camera);
  add_relief("online");
  expect_poses(water + of_relief, watching_camera);
}

TEST_F(SlabOverSeabed, KeepsItsBytesInAnySelectionAndNumberOfThreads) {
  const std::string text = scene({}, "", watching_camera);
  const Echoes whole = energies_in(folder, text, {"--threads", "2"});
  const std::size_t cells = whole.energy.size() / 3;
  for (std::size_t ping = 0; ping < 3; ++ping) {
    const Echoes part =
        energies_in(folder, text, {"--sensor", "sonar", "--pings", std::to_string(ping), "--threads", "1"});
    const auto first = whole.energy.begin() + static_cast<std::ptrdiff_t>(ping * cells);
    EXPECT_EQ(part.energy, std::vector<double>(first, first + static_cast<std::ptrdiff_t>(cells)));
  }
}

TEST_F(SlabOverSeabed, HasTheFootprintsOfAnObjectAtRest) {
  const auto footprints = [&](std::optional<std::size_t> at, std::size_t ping) {
    const std::string file = folder.write("scene.toml", scene(at, "", watching_camera)).string(),
                      out = (folder / "f.csv").string();
    const Outcome outcome =
        run_program({"footprints", file, "--sensor", "sonar", "--pings", std::to_string(ping), "-o", out});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return bytes_of(out);
  };
  for (std::size_t ping = 0; ping < 3; ++ping) EXPECT_EQ(footprints({}, ping), footprints(ping, ping));
}

// Range gates have other corners, because they refer to the weights of a facet.
TEST_F(SlabOverSeabed, IsCoveredLikeAnObjectAtRest) {
  const auto expect_shares = [&](const std::string& more, const std::string& of_sonar) {
    SCOPED_TRACE(more + of_sonar);
    for (std::size_t ping = 0; ping < 3; ++ping) {
      const std::vector<std::string> of_ping{"--pings", std::to_string(ping)};
      const Covered moving = covered(folder, scene({}, more, of_sonar), of_ping),
                    at_rest = covered(folder, scene(ping, more, of_sonar), of_ping);
      EXPECT_GT(at_rest.shadow_m2, 0.1);
      const auto share_in = [](const std::map<std::string, double>& shares, const std::string& facet) {
        return shares.contains(facet) ? shares.at(facet) : 0.0;
      };
      for (const auto& [facet, share] : at_rest.seen) {
        EXPECT_NEAR(share_in(moving.seen, facet), share, 1e-4) << facet;
        EXPECT_NEAR(share_in(moving.shadow, facet), at_rest.shadow.at(facet), 1e-4) << facet;
      }
      for (const auto& [facet, share] : moving.seen) EXPECT_NEAR(share, share_in(at_rest.seen, facet), 1e-4);
    }
  };
  const std::string surface = "[sea_surface]\nheight_m = 2.5\n", mirrored = surface + "[paths]\norder = 2\n",
                    water =
                        "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
                        "profile_bottom_m = 40\nsurface_height_m = 2.5\n";
  expect_shares("", watching_camera);
  expect_shares("", watching_camera + "receiver_arm_m = [0.5, 0, 0]\n");
  expect_shares(mirrored, watching_camera);
  expect_shares(water, watching_camera);
  for (const char* mode : {"offline", "online"}) {
    add_relief(mode);
    expect_shares(of_relief, watching_camera);
  }
  expect_shares(of_relief + mirrored, watching_camera);
}

TEST_F(SlabOverSeabed, IsCoveredOverTiles) {
  folder.write("bed.asc", seabed_of_steps());
  const auto over = [&](const std::string& load, std::optional<std::size_t> at) {
    terrain = "[[terrain]]\nname = \"bed\"\nkind = \"raster\"\nfile = \"bed.asc\"\nload = \"" + load + "\"\n";
    return covered(folder, scene(at, "", watching_camera)).table;
  };
  EXPECT_EQ(over("tiles", {}), over("whole", {}));
  EXPECT_EQ(over("tiles", 1), over("whole", 1));
  // The object enters the view at the last ping.
  places = {{-9, -4, 0.5}, {-9, -4.5, 0.5}, {0.75, 3.5, 0.5}};
  EXPECT_EQ(over("tiles", {}), over("whole", {}));
}

// A part above the water is never seen.
TEST_F(SlabOverSeabed, IsCoveredBelowTheSeaSurface) {
  for (Position& p : places) p[2] += 1.75;
  const std::string surface = "[sea_surface]\nheight_m = 2.25\n",
                    water =
                        "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
                        "profile_bottom_m = 40\nsurface_height_m = 2.25\n";
  for (const std::string& more : {surface, surface + water})
    for (const std::string& arm : {std::string(), std::string("receiver_arm_m = [0.5, 0, 0]\n")})
      for (std::size_t ping = 0; ping < 3; ++ping) {
        const std::vector<std::string> of_ping{"--pings", std::to_string(ping)};
        const Covered moving = covered(folder, scene({}, more, watching_camera + arm), of_ping),
                      at_rest = covered(folder, scene(ping, more, watching_camera + arm), of_ping);
        EXPECT_NEAR(moving.seen_m2, at_rest.seen_m2, 1e-3 * at_rest.seen_m2);
        EXPECT_NEAR(moving.shadow_m2, at_rest.shadow_m2, 1e-3 * at_rest.shadow_m2);
      }
}

TEST_F(SlabOverSeabed, HasTheLabelsOfAnObjectAtRest) {
  for (std::size_t ping = 0; ping < 3; ++ping) {
    const std::vector<std::string> words{"--labels"};
    const auto shares = [&](std::optional<std::size_t> at) {
      energies_in(folder, scene(at, "", watching_camera), words);
      const std::vector<double> all =
          NetcdfReader(folder / "results" / "echoes.nc").values("/", "object_share");
      const auto size = static_cast<std::ptrdiff_t>(all.size() / 3), first = size * std::ptrdiff_t(ping);
      return std::vector<double>(all.begin() + first, all.begin() + first + size);
    };
    EXPECT_EQ(shares({}), shares(ping));
  }
}

// The sphere is behind the plate at the middle ping only; both move.
TEST(MovingObject, HidesAnotherMovingObject) {
  const TestFolder folder;
  const std::string scene = lambert_material("rock", -10) + fixed_grid + fixed("mast", {0, 0, 0}) +
                            waypoints(folder, "swim", {{-0.5, 8, 0}, {0, 8, 0}, {0.5, 8, 0}}) +
                            waypoints(folder, "sail", {{3, 4, 0}, {0, 4, 0}, {-3, 4, 0}}) +
                            object("plate", "shape = \"box\"\nsize_m = [2, 0.25, 2]\n", "sail") +
                            object("fish", round_shape, "swim") + sonar("mast", 3);
  const Echoes echoes = energies_in(folder, scene);
  for (std::size_t ping = 0; ping < 3; ++ping) {
    double of_fish = 0;
    for (std::size_t beam = 0; beam < 8; ++beam)
      for (std::size_t k = echoes.sample_at(7.3); k < echoes.samples; ++k)
        of_fish += echoes.at(ping, beam, k);
    EXPECT_EQ(of_fish > 0, ping != 1) << "ping " << ping;
  }
}

// A hull moves with its sonar, so that the echoes of the hull do not change.
TEST(MovingObject, IsTheHullOfItsSonar) {
  const TestFolder folder;
  const std::string scene = lambert_material("steel", -10) + fixed_grid + waypoints(folder, "boat", path) +
                            object("keel", slab, "boat", {0, 3, 0.5}) +
                            object("rudder", round_shape, "boat", {0.25, -2, 0}) + sonar("boat", 4);
  const Echoes echoes = energies_in(folder, scene);
  const std::size_t cells = echoes.energy.size() / 4;
  ASSERT_GT(echoes.total(), 0);
  for (std::size_t k = cells; k < echoes.energy.size(); ++k)
    EXPECT_EQ(echoes.energy[k], echoes.energy[k % cells]);
}

// The centroid of the signal of a smooth sphere follows its distance.
TEST(MovingObject, DelaysItsSignalByTheTwoWayTravelTime) {
  const TestFolder folder;
  constexpr double step_m = 0.75, sound_speed = 1500;
  const std::string scene =
      still_water() + "[[materials]]\nname = \"steel\"\nsmooth = true\nreflection = 0.75\n" + fixed_grid +
      fixed("mast", {0, 0, 0}) +
      waypoints(folder, "swim", {{0, 5, 0}, {0, 5 + step_m, 0}, {0, 5 + 2 * step_m, 0}}) +
      object("fish", "shape = \"sphere\"\nradius_m = 0.25\nchord_error_m = 0.002\n", "swim") +
      sonar("mast", 3,
            "kind = \"array\"\nfrequency_khz = 30\nbandwidth_khz = 6\npulse_length_us = 500\npulse_taper = "
            "0.4\nrange_min_m = 3\nrange_max_m = 9\nhorizontal_deg = 20\nvertical_deg = 20\nreceivers = 1\n");
  const auto survey = open_survey(read_scene_file(folder.write("scene.toml", scene)));
  SimulationStats stats;
  const ElementSignals signals =
      element_signals_of(simulate(*survey, request_of(survey->scene.description.run), stats).at(0));
  const auto delay_s = [&](std::size_t ping) {
    double energy = 0, moment = 0;
    for (std::size_t k = 0; k < signals.samples(); ++k) {
      const double power = std::norm(signals.pressure[ping * signals.samples() + k]);
      energy += power;
      moment += power * signals.sampling.time_s(k);
    }
    return moment / energy;
  };
  for (std::size_t ping = 1; ping < 3; ++ping)
    EXPECT_NEAR(delay_s(ping) - delay_s(ping - 1), 2 * step_m / sound_speed, 2e-6) << "ping " << ping;
}

/// Runs `check` on a scene and returns its messages.
Outcome checked(const TestFolder& folder, const std::string& scene) {
  return run_program({"check", folder.write("scene.toml", scene).string()});
}

TEST(MovingObject, ThatPassesTheSonarIsReportedWithItsPing) {
  const TestFolder folder;
  const std::string scene = lambert_material("rock", -10) + fixed_grid + fixed("mast", {0, 0, 0}) +
                            waypoints(folder, "swim", {{0, 6, 0}, {0, 3, 0}, {0, 0.0625, 0}, {0, -3, 0}}) +
                            object("whale", slab, "swim");
  const Outcome inside = checked(folder, scene + sonar("mast", 4));
  EXPECT_EQ(inside.exit_code, 0) << inside.err;
  EXPECT_THAT(inside.err + inside.out, HasSubstr("is inside object 'whale' at ping 2 (t = 1.000 s)"));
  const Outcome before = checked(folder, scene + sonar("mast", 2));
  EXPECT_THAT(before.err + before.out, Not(HasSubstr("is inside")));

  const Outcome element = checked(
      folder, scene + sonar("mast", 4,
                            "kind = \"array\"\nfrequency_khz = 30\nbandwidth_khz = 6\npulse_length_us = 500\n"
                            "range_max_m = 8\nhorizontal_deg = 20\nvertical_deg = 20\nreceivers = 1\n"));
  EXPECT_EQ(element.exit_code, 2);
  EXPECT_THAT(element.err, HasSubstr("is inside the closed object 'whale' at ping 2 (t = 1.000 s"));

  waypoints(folder, "swim", {{0, 6, 0}, {0, 3, 0}, {0, 0.25, 0}, {0, -3, 0}});
  const Outcome touching = checked(folder, scene + sonar("mast", 4));
  EXPECT_EQ(touching.exit_code, 2);
  EXPECT_THAT(touching.err, HasSubstr("lies exactly on an edge of 'whale' at ping 2 (t = 1.000 s"));
}

// Between the pings, the transmissions of a scanning sonar meet the object at their own times.
TEST(MovingObject, ThatPassesBetweenPingsIsReportedAtItsTransmission) {
  const TestFolder folder;
  const std::string scene =
      lambert_material("rock", -10) + fixed_grid + fixed("mast", {0, 0, 0}) +
      waypoints(folder, "swim", {{0, 4, 0}, {0, -4, 0}}) + object("whale", slab, "swim") +
      sonar("mast", 1, "kind = \"didson\"\nbeams = 12\ncycles = 3\ncycle_interval_s = 0.234375\n");
  const Outcome outcome = checked(folder, scene);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("lies exactly on an edge of 'whale' at ping 0"));
}

TEST(MovingObject, NeedsATrajectoryThatLasts) {
  const TestFolder folder;
  const std::string scene = lambert_material("rock", -10) + fixed("mast", {0, 0, 0}) +
                            waypoints(folder, "swim", {{0, 6, 0}, {0, 3, 0}});
  const Outcome outcome = checked(folder, scene + object("fish", round_shape, "swim") + sonar("mast", 4));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("ping 2 of sensor 'sonar' is at 1 s, outside of trajectory 'swim' of object "
                              "'fish', which lasts from 0 s to 0.5 s"),
                    HasSubstr("scene.toml:")));
  const auto error_of = [&](const std::string& keys) {
    return checked(folder, scene + object("fish", round_shape + keys, "swim") + sonar("mast", 1)).err;
  };
  EXPECT_THAT(error_of("on_terrain_m = 0\n"), HasSubstr("'on_terrain_m' excludes 'trajectory'"));
  EXPECT_THAT(error_of("position_lat_lon_deg = [0, 0]\n"),
              HasSubstr("'position_lat_lon_deg' excludes 'trajectory'"));
  EXPECT_THAT(checked(folder, scene + object("fish", round_shape, "swin") + sonar("mast", 1)).err,
              HasSubstr("did you mean \"swim\"?"));
}

}  // namespace
}  // namespace tubefoot
