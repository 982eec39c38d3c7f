// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of small displacements: fractions of a sample, transmit sectors, and an object that moves.
#include <fmt/format.h>

#include "suite/scene_text.hpp"

namespace tubefoot {

SuiteScene half_sample_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A slanted plate, whose range grows from beam to beam";
  SceneText text;
  text.sonar_m = {0, 0, 2};
  text.fan = {.beams = 20,
              .horizontal_deg = 20,
              .vertical_deg = 6,
              .tilt_deg = 0,
              .samples = 256,
              .from_m = 4,
              .to_m = 9};
  const double azimuth = draw.among(0, -1, 1, 0.25), turn = draw.among(50, 45, 52, 0.5);
  scene.solids.push_back(upright_plate("plate", "target",
                                       place_at(text.sonar_m, draw.among(6, 5.75, 6.25, 0.0625), azimuth, 0),
                                       azimuth + (draw.among(1, -1, 1, 2) > 0 ? turn : -turn), 3, 2));
  scene.deciders = {{"samples_moved", 0.25}};
  finish(scene, text);
  return scene;
}

SuiteScene transmit_sectors_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Stones below a multibeam with three transmit sectors";
  scene.solids.push_back(level_plate("bed", "bed", {0, 0, 0}, 32, 32));
  Solid stones{"stones", "target", {}, {}};
  const auto between = [&](double least, double most) { return least + (most - least) * draw.number(); };
  for (int k = 0; k < 160; ++k) {
    const glm::dvec3 size{between(0.06, 0.3), between(0.06, 0.3), between(0.05, 0.3)};
    add(stones,
        box("stone", "target", {between(-2.4, 2.4), between(-0.4, 1.6), size.z / 2}, size, between(0, 90)));
  }
  scene.solids.push_back(stones);
  SceneText text;
  const double height = draw.among(5, 4.75, 5.25, 0.0625), speed = draw.among(2, 1.75, 2.25, 0.125);
  text.trajectory = fmt::format(
      "kind = \"line\"\nstart_m = [0, 0, {0}]\nend_m = [0, 4, {0}]\nspeed_m_s = {1}\n", height, speed);
  const double tilt = draw.among(1.5, 1, 2, 0.25), delay = draw.among(40000, 30000, 50000, 2500),
               loss = draw.among(200, 150, 250, 10);
  text.sensor = fmt::format(
      "[[sensors]]\nname = \"sonar\"\nkind = \"multibeam\"\nfrequency_khz = 300\nbeams = 48\nswath_deg = 47\n"
      "beam_across_deg = 1\nalong_track_deg = 1.5\nsamples = 96\nrange_min_m = 4\nrange_max_m = 7\n"
      "pings = 3\nping_interval_s = 0.25\nsector_edges_deg = [-24, -8, 8, 24]\n"
      "sector_tilts_deg = [{0}, 0, {1}]\nsector_delays_us = [0, {2}, {3}]\n"
      "sector_absorptions_db_per_km = [{4}, {5}, {6}]\n",
      tilt, -tilt, delay, 2 * delay, loss - 100, loss + 100, loss);
  scene.deciders = {{"coarse_l1", 0.08}, {"sectors_db", 0.5}};
  finish(scene, text);
  return scene;
}

SuiteScene moving_object_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A box that moves over the bed, in five pings of a sonar at rest";
  SceneText text = over_seabed(draw, scene);
  Solid moving = box("box", "target", {0, 0, 0}, {0.75, 1, 0.5}, draw.among(20, 0, 45, 2.5));
  moving.more = "trajectory = \"path\"\n";
  scene.solids.push_back(moving);
  // The carrier heads east, and every step is a multiple of 2^-5 m, so that no vertex is rounded.
  const double west = draw.among(-1, -1.5, -0.5, 0.125), north = draw.among(-0.5, -1, 0, 0.125),
               up = draw.among(0.5, 0.5, 0.75, 0.0625);
  text.object_path =
      fmt::format("kind = \"line\"\nstart_m = [{0}, {1}, {2}]\nend_m = [{3}, {1}, {2}]\nspeed_m_s = {4}\n",
                  west, north, up, west + 4, draw.among(0.5, 0.5, 0.75, 0.125));
  text.fan.more = "trajectory = \"sonar\"\npings = 5\nping_interval_s = 0.5\n";
  scene.deciders = {{"pings_off", 0}, {"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

}  // namespace tubefoot
