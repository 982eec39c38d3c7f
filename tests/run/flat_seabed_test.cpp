// SPDX-License-Identifier: GPL-3.0-or-later
// Compares whole runs with the closed form of a flat Lambert seabed (physics.md 7.5), for different facets
// of the seabed. All arithmetics and thread counts give the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <numbers>

#include "fixtures/scene_texts.hpp"
#include "fixtures/test_mesh.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

constexpr double seabed_height_m = 10, fan_rad = 1.5 * std::numbers::pi / 180;
const double seabed_mu = std::pow(10, -2.7);

/// One beam of 1.5 degrees, 10 m above the seabed, sees the seabed from nearly straight below to 40 m.
/// `seabed`: a [[terrain]] or [[objects]] entry of material "seabed".
std::string flat_scene(double absorption_db_per_km, const std::string& seabed, double heading_deg = 37) {
  return still_water(absorption_db_per_km) + lambert_material("bed", -27) + seabed +
         fixed_at(0, 0, 10, fmt::format("heading_deg = {}\n", heading_deg)) + downward_fan(1, 1.5, 640);
}

const std::string two_facets = flat_terrain(128, 128);
const std::string mesh_seabed = "[[objects]]\nname = \"bed\"\nshape = \"mesh\"\nfile = \"bed.obj\"\n";

/// physics.md 7.5 for the slant ranges near_m to far_m.
double seabed_closed_form(double absorption_db_per_km, double near_m, double far_m) {
  const double scale = seabed_mu * seabed_height_m * seabed_height_m * fan_rad;
  if (absorption_db_per_km == 0) return scale / 4 * (std::pow(near_m, -4) - std::pow(far_m, -4));
  const double beta = 2 * absorption_db_per_km / 1000 * std::numbers::ln10 / 10;
  const auto tail = [&](double range_m) {  // integral of R^-5 exp(-beta R) from range_m to infinity
    return std::pow(range_m, -4) * boost::math::expint(5u, beta * range_m);
  };
  return scale * (tail(near_m) - tail(far_m));
}

/// Largest relative error over the range bins that the beam fills on the seabed. The fan ends 85 degrees
/// below the horizontal, at 10.04 m of slant range.
double largest_error(const Echoes& echoes, double absorption_db_per_km) {
  double worst = 0;
  std::size_t compared = 0;
  for (std::size_t k = 0; k < echoes.samples; ++k) {
    if (echoes.first_m(k) < 10.05) continue;
    const double exact = seabed_closed_form(absorption_db_per_km, echoes.first_m(k), echoes.last_m(k));
    worst = std::max(worst, std::abs(echoes.at(0, 0, k) / exact - 1));
    ++compared;
  }
  EXPECT_GT(compared, 590u);
  return worst;
}

// Compares closed_form() itself with the figures that the physics sheet prints.
TEST(FlatSeabed, ClosedFormGivesThePublishedFigures) {
  EXPECT_NEAR(seabed_closed_form(0, 20, 20.05), 8.111093200e-11, 1e-20);
  EXPECT_NEAR(seabed_closed_form(61.5, 20, 20.05), 4.600156e-11, 1e-17);
  EXPECT_NEAR(seabed_closed_form(423.68, 20, 20.05), 1.630223e-12, 1e-18);
}

TEST(FlatSeabed, WithoutAbsorptionEverySampleIsTheClosedForm) {
  for (const double heading_deg : {0.0, 37.0, 213.5}) {
    SCOPED_TRACE(heading_deg);
    const double error = largest_error(echoes_of(flat_scene(0, two_facets, heading_deg)), 0);
    EXPECT_LT(error, 1e-6);
    RecordProperty(fmt::format("largest_error_at_{:g}_degrees", heading_deg), fmt::format("{:.2e}", error));
  }
}

TEST(FlatSeabed, WithAbsorptionEverySampleIsTheClosedForm) {
  for (const double absorption : {61.5, 423.68, 2500.0}) {
    SCOPED_TRACE(absorption);
    const double error = largest_error(echoes_of(flat_scene(absorption, two_facets)), absorption);
    EXPECT_LT(error, 1e-6);
    RecordProperty(fmt::format("largest_error_at_{:g}_dB_km", absorption), fmt::format("{:.2e}", error));
  }
}

// With the strongest absorption that a scene file permits, echoes fall below the least double, which is no
// error.
TEST(FlatSeabed, FadesToNothingInTheStrongestAbsorption) {
  const Echoes echoes = echoes_of(flat_scene(100000, two_facets));
  const std::size_t near = echoes.sample_at(10.06);
  EXPECT_NEAR(echoes.at(0, 0, near) / seabed_closed_form(100000, echoes.first_m(near), echoes.last_m(near)),
              1, 1e-6);
  for (std::size_t k = near; k + 1 < echoes.samples; ++k)
    EXPECT_GE(echoes.at(0, 0, k), echoes.at(0, 0, k + 1));
  EXPECT_EQ(echoes.at(0, 0, echoes.samples - 1), 0);
}

TEST(FlatSeabed, WaterColumnIsEmpty) {
  const Echoes echoes = echoes_of(flat_scene(61.5, two_facets));
  for (std::size_t k = 0; k < echoes.samples; ++k)
    if (echoes.last_m(k) <= seabed_height_m) {
      EXPECT_EQ(echoes.at(0, 0, k), 0) << k;
    }
  EXPECT_GT(echoes.at(0, 0, echoes.sample_at(10.06)), 0);
}

TEST(FlatSeabed, CutIntoCellsIsTheSameSeabed) {
  const Echoes whole = echoes_of(flat_scene(61.5, two_facets));
  const Echoes cells = echoes_of(flat_scene(61.5, two_facets + "cell_m = 1.7\n"));
  EXPECT_LT(largest_error(cells, 61.5), 1e-6);
  EXPECT_LT(largest_relative_difference(whole, cells), 1e-11);
}

TEST(FlatSeabed, FromAMeshFileInAnyOrderIsTheSameSeabed) {
  const Echoes whole = echoes_of(flat_scene(61.5, two_facets));
  const TestMesh mesh = relief(128, 16, [](double, double) { return 0.0; });
  for (const std::uint32_t seed : {1u, 2u}) {
    SCOPED_TRACE(seed);
    const TestFolder folder;
    folder.write("bed.obj", obj_text(shuffled(mesh, seed)));
    EXPECT_LT(largest_relative_difference(whole, echoes_in(folder, flat_scene(61.5, mesh_seabed))), 1e-11);
  }
}

// One of two adjacent facets is split at a point of their common edge. A half-edge mesh cannot represent
// this.
TEST(FlatSeabed, WithTJunctionsIsTheSameSeabed) {
  const Echoes whole = echoes_of(flat_scene(61.5, two_facets));
  TestMesh mesh = relief(128, 16, [](double, double) { return 0.0; });
  const std::size_t facets = mesh.facets.size();
  for (std::size_t k = 0; k < facets; k += 2) {
    const auto [a, b, c] = mesh.facets[k];  // c - a is the diagonal
    const auto &start = mesh.vertices[a], end = mesh.vertices[c];
    mesh.vertices.push_back({(3 * start[0] + end[0]) / 4, (3 * start[1] + end[1]) / 4, 0});
    mesh.facets[k] = {a, b, mesh.vertices.size() - 1};
    mesh.facets.push_back({mesh.vertices.size() - 1, b, c});
  }
  const TestFolder folder;
  folder.write("bed.obj", obj_text(mesh));
  EXPECT_LT(largest_relative_difference(whole, echoes_in(folder, flat_scene(61.5, mesh_seabed))), 1e-11);
}

TEST(FlatSeabed, ExactArithmeticsAgreeToTheLastBit) {
  const std::string scene = flat_scene(61.5, two_facets + "cell_m = 6.5\n");
  const Echoes fixed = echoes_of(scene, {"--arithmetic", "fixed"});
  EXPECT_EQ(fixed.energy, echoes_of(scene, {"--arithmetic", "filtered"}).energy);
  EXPECT_EQ(fixed.energy, echoes_of(scene, {"--arithmetic", "rational"}).energy);
}

TEST(FlatSeabed, ThreadsAgreeToTheLastBit) {
  const std::string scene = flat_scene(61.5, two_facets + "cell_m = 1.7\n");
  const Echoes alone = echoes_of(scene, {"--threads", "1"});
  for (const char* threads : {"2", "7"})
    EXPECT_EQ(alone.energy, echoes_of(scene, {"--threads", threads}).energy);
}

}  // namespace
}  // namespace tubefoot
