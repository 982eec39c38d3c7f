// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that shadows and first returns lie where height and geometry put them (physics.md 7.2), to the
// range bin. Shadows have exactly zero energy.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

constexpr double beam_rad = 0.3 * std::numbers::pi / 180;

/// One narrow beam, 5 m above the seabed, that looks north. Range bins of 1 cm have borders at odd half
/// centimetres.
std::string camera_scene(const std::string& rest) {
  return R"(
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 0
[[materials]]
name = "sand"
lambert_db = -27
[trajectory]
kind = "fixed"
position_m = [0, 0, 5]
[[sensors]]
name = "beam"
kind = "didson"
beams = 1
horizontal_deg = 0.3
vertical_deg = 160
samples = 1200
window_start_m = 8.005
window_length_m = 12
)" + rest;
}

const std::string seabed = "[[terrain]]\nkind = \"flat\"\nwidth_m = 50\nlength_m = 100\n";
/// One metre high, 1 cm thick, with its far side 10 m north.
const std::string shadow_wall =
    "[[objects]]\nname = \"wall\"\nshape = \"box\"\nsize_m = [20, 0.01, 1]\nposition_m = [0, 9.995, 0.5]\n";
const std::string sphere =
    "[[objects]]\nname = \"sphere\"\nshape = \"sphere\"\nradius_m = 1\nchord_error_m = 0.0005\n"
    "position_m = [0, 10, 1]\n";

constexpr double wall_shadow_end_m = 13.462912018, sphere_first_m = 9.770329614,
                 sphere_shadow_end_m = 17.631740393;

/// Energy of a bare seabed between two slant ranges (physics.md 7.5).
double bare_seabed(double near_m, double far_m) {
  return std::pow(10, -2.7) * 25 * beam_rad / 4 * (std::pow(near_m, -4) - std::pow(far_m, -4));
}

void expect_dark(const Echoes& echoes, std::size_t first, std::size_t last) {
  for (std::size_t k = first; k <= last; ++k) EXPECT_EQ(echoes.at(0, 0, k), 0) << "sample " << k;
}

TEST(Shadow, OfAThinWallEndsWhereHeightAndRangeSay) {
  const Echoes echoes = echoes_of(camera_scene(seabed + shadow_wall));
  const std::size_t end = echoes.sample_at(wall_shadow_end_m);
  // The last visible point is the foot of the wall: 9.99 m north on the seabed.
  expect_dark(echoes, echoes.sample_at(std::hypot(9.99, 5)) + 1, end - 1);
  const double lit = bare_seabed(wall_shadow_end_m, echoes.last_m(end));
  EXPECT_NEAR(echoes.at(0, 0, end) / lit, 1, 0.01);
  // In front of the wall and behind its shadow lies the bare seabed.
  for (const double range_m : {9.0, 10.6, 13.6, 19.9}) {
    const std::size_t k = echoes.sample_at(range_m);
    EXPECT_NEAR(echoes.at(0, 0, k) / bare_seabed(echoes.first_m(k), echoes.last_m(k)), 1, 1e-5) << range_m;
  }
}

TEST(Shadow, WallItselfIsSeenBeforeItsShadow) {
  const Echoes echoes = echoes_of(camera_scene(seabed + shadow_wall));
  for (std::size_t k = echoes.sample_at(10.78); k < echoes.sample_at(11.16); ++k)
    EXPECT_GT(echoes.at(0, 0, k), 3 * bare_seabed(echoes.first_m(k), echoes.last_m(k))) << "sample " << k;
}

TEST(Shadow, SphereReturnsFirstFromItsNearestPoint) {
  const Echoes echoes = echoes_of(camera_scene(sphere));
  const std::size_t first = echoes.sample_at(sphere_first_m);
  expect_dark(echoes, 0, first - 1);
  EXPECT_GT(echoes.at(0, 0, first), 0);
  // Points beyond the limb are hidden. Facets with this chord error are 6.3 cm long, so that the outermost
  // visible facet ends at most half of that further.
  expect_dark(echoes, echoes.sample_at(std::sqrt(115.0) + 0.032) + 1, echoes.samples - 1);
}

TEST(Shadow, OfASphereOnTheSeabedEndsAtItsTangent) {
  const Echoes echoes = echoes_of(camera_scene(seabed + sphere));
  const std::size_t end = echoes.sample_at(sphere_shadow_end_m);
  expect_dark(echoes, echoes.sample_at(std::hypot(9.758731568, 5)) + 1, end - 1);
  const std::size_t lit = end + 1;
  EXPECT_NEAR(echoes.at(0, 0, lit) / bare_seabed(echoes.first_m(lit), echoes.last_m(lit)), 1, 1e-5);
}

// A sidescan shadow lies beyond its object, away from the track, on both sides.
TEST(Shadow, LiesBehindTheObjectOnBothSidesOfASidescan) {
  for (const int side : {0, 1}) {
    SCOPED_TRACE(side);
    const std::string scene = fmt::format(R"(
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 100
length_m = 20
[[objects]]
name = "wall"
shape = "box"
size_m = [0.01, 10, 1]
position_m = [{}, 0, 0.5]
[trajectory]
kind = "fixed"
position_m = [0, 0, 5]
[[sensors]]
name = "sidescan"
kind = "sidescan"
along_track_deg = 0.3
samples = 1200
range_min_m = 8.005
range_max_m = 20.005
)",
                                          side == 0 ? -9.995 : 9.995);
    const Echoes echoes = echoes_of(scene);
    const auto beam = static_cast<std::size_t>(side), other = static_cast<std::size_t>(1 - side);
    const std::size_t end = echoes.sample_at(wall_shadow_end_m);
    for (std::size_t k = echoes.sample_at(11.2); k < end; ++k) EXPECT_EQ(echoes.at(0, beam, k), 0) << k;
    EXPECT_GT(echoes.at(0, beam, end), 0);
    EXPECT_GT(echoes.at(0, beam, echoes.sample_at(11)), 3 * echoes.at(0, other, echoes.sample_at(11)));
    for (std::size_t k = 0; k < echoes.samples; ++k) EXPECT_GT(echoes.at(0, other, k), 0) << k;
  }
}

}  // namespace
}  // namespace tubefoot
