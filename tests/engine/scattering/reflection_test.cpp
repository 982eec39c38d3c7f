// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/reflection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double reflected_energy(const FluidSediment& seabed, double grazing_rad) {
  return std::norm(reflection_coefficient(seabed, grazing_rad));
}

TEST(Sediment, InputsByGrainSizeAreThePublishedTable) {
  const struct {
    double phi, density, speed, loss;
  } rows[] = {{-1, 2.492, 1.3370, .01705},  {-0.5, 2.401, 1.3067, .01667}, {0, 2.314, 1.2778, .01630},
              {0.5, 2.231, 1.2503, .01638}, {1, 2.151, 1.2241, .01645},    {1.5, 1.845, 1.1782, .01624},
              {2, 1.615, 1.1396, .01610},   {2.5, 1.451, 1.1073, .01602},  {3, 1.339, 1.0800, .01728},
              {3.5, 1.268, 1.0568, .01875}, {4, 1.224, 1.0364, .02019},    {4.5, 1.195, 1.0179, .02158},
              {5, 1.169, 0.9999, .01261},   {5.5, 1.149, 0.9885, .00676},  {6, 1.149, 0.9873, .00386},
              {7, 1.147, 0.9849, .00242},   {8, 1.146, 0.9824, .00163},    {9, 1.145, 0.9801, .00148}};
  for (const auto& row : rows) {
    const FluidSediment seabed = sediment_of_grain_size(row.phi);
    EXPECT_NEAR(seabed.density_ratio, row.density, 0.00051) << row.phi;
    EXPECT_NEAR(seabed.speed_ratio, row.speed, 0.0001) << row.phi;
    EXPECT_NEAR(seabed.loss, row.loss, 0.0000051) << row.phi;
  }
  for (const double phi : {-1.01, 9.01, std::nan("")})
    EXPECT_THROW(sediment_of_grain_size(phi), std::invalid_argument);
}

double loss_db(const FluidSediment& seabed, double grazing_deg) {
  return -20 * std::log10(std::abs(reflection_coefficient(seabed, grazing_deg * degree)));
}

TEST(Reflection, PublishedLosses) {
  // Coarse, medium and fine sand and silt, with their published parameters.
  const FluidSediment coarse{2.231, 1.2503, .01638}, medium{1.845, 1.1782, .01624},
      fine{1.451, 1.1072, .01602}, silt{1.149, .9873, .00386};
  const struct {
    const FluidSediment& seabed;
    double phi, grazing, loss, tolerance;
  } values[] = {{coarse, 0.5, 90, 6.5169, 5.1e-5}, {medium, 1.5, 90, 8.6391, 5.1e-5},
                {fine, 2.5, 90, 12.6612, 5.1e-5},  {silt, 6, 90, 24.0135, 5.1e-5},
                {medium, 1.5, 20, 0.564, 5.1e-4},  {fine, 2.5, 20, 1.3475, 5.1e-5},
                {silt, 6, 20, 32.545, 5.1e-4}};
  for (const auto& v : values) {
    EXPECT_NEAR(loss_db(v.seabed, v.grazing), v.loss, v.tolerance) << v.phi;
    EXPECT_NEAR(loss_db(sediment_of_grain_size(v.phi), v.grazing), v.loss, 1e-3 * v.loss) << v.phi;
  }
  // Water of 1023 kg/m3 and 1540 m/s over a seabed of 1200 kg/m3 and 1600 m/s.
  EXPECT_NEAR(reflection_coefficient({1200.0 / 1023, 1600.0 / 1540, 0}, 90 * degree).real(), 0.09858, 5e-6);
}

TEST(Reflection, NeverReturnsMoreThanComesInAndAllOfItAtGrazing) {
  const unsigned seed = 11;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> density(0.5, 4), speed(0.5, 4), loss(0, 2), grazing(1e-6, 90);
  for (int run = 0; run < 2000; ++run) {
    const FluidSediment seabed = fluid_sediment(density(random), speed(random), loss(random));
    const double energy = reflected_energy(seabed, grazing(random) * degree);
    ASSERT_LE(energy, 1 + 1e-12) << "seed " << seed << ", run " << run;
    ASSERT_GE(energy, 0);
    ASSERT_NEAR(reflection_coefficient(seabed, 0).real(), -1, 1e-12);
  }
  // This includes a fluid with the sound speed of water, at grazing incidence.
  EXPECT_EQ(reflection_coefficient({1.2, 1, 0}, 0), -1.0);
  // Beyond the critical angle a lossless seabed reflects all sound. At the angle of intromission it
  // reflects none.
  const FluidSediment sand = fluid_sediment(1.9, 1.1, 0);
  const double critical = std::acos(1 / 1.1);
  EXPECT_NEAR(reflected_energy(sand, 0.9 * critical), 1, 1e-12);
  EXPECT_LT(reflected_energy(sand, 1.1 * critical), 0.5);
  const double m = 1.5, n = 1 / 0.98;  // sin^2 = (n^2 - 1) / (m^2 - 1)
  EXPECT_NEAR(reflected_energy(fluid_sediment(m, 1 / n, 0), std::asin(std::sqrt((n * n - 1) / (m * m - 1)))),
              0, 1e-24);
  // A loss of 1 is a decay of the amplitude by e^-2 pi per wavelength.
  EXPECT_NEAR(fluid_sediment(1, 1, 2 * std::numbers::pi * 20 / std::numbers::ln10).loss, 1, 1e-12);
  EXPECT_THROW(fluid_sediment(0, 1, 0), std::invalid_argument);
  EXPECT_THROW(fluid_sediment(1, -1, 0), std::invalid_argument);
  EXPECT_THROW(fluid_sediment(1, 1, std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
