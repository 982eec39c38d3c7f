// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whole runs of an echosounder over a flat seabed. The echo through Gaussian beams is a single
// integral.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>

#include "fixtures/csv_rows.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double height = 12, width_deg = 10;

std::string scene(const std::string& sensor, double pitch_deg = 0, double heading_deg = 30) {
  return still_water() + lambert_material("sand", -20) + flat_terrain(100, 100) +
         fixed_at(3, -2, height, fmt::format("pitch_deg = {}\nheading_deg = {}\n", pitch_deg, heading_deg)) +
         fmt::format(R"([[sensors]]
name = "sounder"
kind = "echosounder"
beam_deg = {}
range_min_m = 11
range_max_m = 14
samples = 300
{})",
                     width_deg, sensor);
}

/// Returns the energy at ranges near to far. Transmit and receive pattern are each exp(-4 ln 2 (angle /
/// width)^2).
double closed_form(double near, double far, double ways) {
  const auto ring = [&](double r) {
    const double angle = std::acos(height / r) / (width_deg * degree);
    return 0.01 * height * height * std::pow(r, -6) *
           std::exp(-4 * ways * std::numbers::ln2 * angle * angle) * 2 * pi * r;
  };
  near = std::max(near, height);
  if (far <= near) return 0;
  // r = near + u^2: the angle grows with the square root of the range.
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
      [&](double u) { return 2 * u * ring(near + u * u); }, 0.0, std::sqrt(far - near), 8, 1e-10);
}

TEST(EchosounderRun, FlatSeabedThroughBothGaussians) {
  const Echoes echoes = echoes_of(scene("sector_deg = 40\n"));
  ASSERT_EQ(echoes.energy.size(), 300u);
  const double total = closed_form(11, 14, 2);
  for (std::size_t k = 0; k < 300; ++k) {
    // Within the inner circle of the square sector.
    if (height / echoes.last_m(k) < std::cos(20 * degree)) break;
    ASSERT_NEAR(echoes.at(0, 0, k), closed_form(echoes.first_m(k), echoes.last_m(k), 2), 2e-6 * total) << k;
  }
  EXPECT_EQ(echoes.beam_elevation_deg.at(0), -90);
}

TEST(EchosounderRun, AnExplicitPatternReplacesOneWay) {
  const Echoes echoes = echoes_of(
      scene("sector_deg = 40\ntransmit_pattern = \"gaussian\"\ntransmit_pattern_angle = \"off_axis\"\n"
            "transmit_beam_width_deg = 20\n"));
  // Twice the width gives a quarter of the exponent.
  const double total = closed_form(11, 14, 1.25);
  for (std::size_t k = 0; k < 160; ++k)
    ASSERT_NEAR(echoes.at(0, 0, k), closed_form(echoes.first_m(k), echoes.last_m(k), 1.25), 2e-6 * total)
        << k;
}

TEST(EchosounderRun, DetectsTheSeabedAndPlacesItOnTheAxis) {
  for (const double pitch : {0.0, 4.0}) {
    const TestFolder folder;
    const auto file = folder.write("scene.toml", scene("detection = \"first_return\"\n", pitch));
    const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string(), "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto rows = csv_rows(folder / "out" / "sounder.csv");
    ASSERT_EQ(rows.size(), 1u);
    const auto value = [&](const char* name) { return std::stod(rows[0].at(name)); };
    EXPECT_NEAR(value("true_altitude_m"), height, 1e-5);
    EXPECT_NEAR(value("range_m"), height, 0.01);  // the nearest seabed lies inside the beam in both cases
    // With the bow up, the axis tilts forwards, along heading 30.
    const double lean = value("range_m") * std::sin(pitch * degree);
    EXPECT_NEAR(value("bottom_east_m"), 3 + lean * std::sin(30 * degree), 1e-6);
    EXPECT_NEAR(value("bottom_north_m"), -2 + lean * std::cos(30 * degree), 1e-6);
    EXPECT_NEAR(value("bottom_up_m"), height - value("range_m") * std::cos(pitch * degree), 1e-6);
    for (const char* name : {"sounder.png", "sounder.exr"})
      EXPECT_GT(std::filesystem::file_size(folder / "out" / name), 500u);
  }
}

TEST(EchosounderRun, NoEchoLeavesItsCellsEmpty) {
  const TestFolder folder;
  const auto file =
      folder.write("scene.toml", replaced(replaced(scene(""), "range_min_m = 11", "range_min_m = 2"),
                                          "range_max_m = 14", "range_max_m = 5"));
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string(), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = csv_rows(folder / "out" / "sounder.csv");
  ASSERT_EQ(rows.size(), 1u);
  for (const char* name : {"range_m", "range_sigma_m", "energy_j", "quality", "bottom_up_m"})
    EXPECT_EQ(rows[0].at(name), "") << name;
  EXPECT_EQ(rows[0].at("sensor_up_m"), "12");
}

}  // namespace
}  // namespace tubefoot
