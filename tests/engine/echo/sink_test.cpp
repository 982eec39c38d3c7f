// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that all sinks receive the same integral of the same integrand: echoes, contributions and energies
// of footprints add up to one echo.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/scattering/density.hpp"
#include "engine/visibility/path_footprints.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "geometry/numbers/ball.hpp"

namespace tubefoot {
namespace {

constexpr double unit = 0x1p-20;
const std::vector<double> sink_material_mu{0.002};
const RangeSamples samples{2, 0.0625, 300};
const std::vector<std::uint32_t> beams{0, 1, 2, 3, 4, 5}, none(6, 0);

TEST(Density, InBallsItHoldsWhatItIsInDoubles) {
  const std::uint64_t seed = 20271;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> range(0.1, 500), beta(0, 0.1), part(1e-3, 1);
  for (int k = 0; k < 200; ++k) {
    const double tx = range(random), rx = range(random), b = beta(random), sigma = part(random);
    const double apart = density(sigma, TwoWayRange<double>::of(tx, rx), b),
                 lambert = lambert_density(TwoWayRange<double>::of(tx, rx), b),
                 together = lambert_density(TwoWayRange<double>::of(tx), b);
    const auto way = TwoWayRange<Ball>::of(Ball(tx), Ball(rx));
    EXPECT_NEAR(density(Ball(sigma), way, Ball(b)).middle() / apart, 1, 1e-14);
    EXPECT_NEAR(lambert_density(way, Ball(b)).middle() / lambert, 1, 1e-14);
    EXPECT_NEAR(lambert_density(TwoWayRange<Ball>::of(Ball(tx)), Ball(b)).middle() / together, 1, 1e-14);
    // Compares Lambert's cross-section from heights with its definition.
    const double heights = 0.03, sines = heights / (tx * rx);
    EXPECT_NEAR(heights * lambert / density(sines, TwoWayRange<double>::of(tx, rx), b), 1, 1e-14);
    EXPECT_NEAR(apart / (sigma * std::exp(-b * (tx + rx)) / std::pow(tx * rx, 2)), 1, 1e-13);
  }
}

/// A rough seabed that six beams see, with and without patterns. The receiver is at the apex or 2 m aside.
struct Seabed {
  FacetMesh mesh;
  SceneTree tree;
  TubeSet tubes = test::forward_tubes({0, 0, 0}, 6, 1, 50, 30, 20),
          aside = test::forward_tubes({0, 2000000, 0}, 6, 1, 50, 30, 20);
  BeamPatterns patterns;

  explicit Seabed(FacetMesh m) : mesh(std::move(m)), tree(mesh) {
    const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, 5};
    patterns.transmit = {line};
    patterns.fan_of_tube = none;
    patterns.beams_of_tube.assign(6, {0, 6});
    for (int b = 0; b < 6; ++b) {
      patterns.receive.push_back(line);
      patterns.receive.back().centre = 0.1 * (b - 2.5);
    }
  }
  static FacetMesh rough() {
    test::Random random(20266);
    return test::rough_terrain(random, 10, 20000000, -3000000, 500000);
  }
};

class Sinks : public testing::Test {
 protected:
  Sinks()
      : seabed(Seabed::rough()),
        alone(TubeEngine(seabed.mesh, seabed.tree, unit, {}).trace(seabed.tubes)),
        apart(trace_bistatic(seabed.mesh, seabed.tree, unit, {}, seabed.tubes, seabed.aside)) {}

  template <class Take>
  void for_all(const Take& take) {
    const BeamPatterns* given = &seabed.patterns;
    for (const BeamPatterns* patterns : {static_cast<const BeamPatterns*>(nullptr), given})
      for (const CommonVisibility& visibility : {CommonVisibility(alone), CommonVisibility(apart)}) {
        SCOPED_TRACE(testing::Message() << (visibility.one_apex() ? "one apex" : "two apexes")
                                        << (patterns ? ", patterns" : ""));
        take(visibility, EchoModel{sink_material_mu, seabed.mesh.material, 0.1, patterns, 1e-12});
      }
  }

  Seabed seabed;
  History alone;
  BistaticHistory apart;
};

TEST_F(Sinks, PartsByOwnerSumToTheEcho) {
  for (const Binning binning : {Binning::exact, Binning::spread, Binning::centroid})
    for_all([&](const CommonVisibility& visibility, const EchoModel& model) {
      SCOPED_TRACE(name_of(binning));
      Quadrature owned(binning);
      const Echo echo = integrate_echo(visibility, {6, beams}, samples, model, owned);
      const double peak = *std::max_element(echo.energy.begin(), echo.energy.end());
      ASSERT_GT(peak, 0);
      std::vector<double> sum(echo.energy.size());
      owned.by_owner = true;
      std::map<std::uint32_t, int> owners;
      integrate(visibility, {6, beams}, samples, model, owned, [&](const Part<double>& part) {
        ASSERT_LT(part.seen, visibility.end());
        ++owners[part.seen];
        sum[part.beam * 300 + part.sample] += part.value;
      });
      EXPECT_GT(owners.size(), 20u);
      for (std::size_t bin = 0; bin < sum.size(); ++bin)
        ASSERT_NEAR(sum[bin], echo.energy[bin], 1e-12 * peak) << bin;
    });
}

TEST_F(Sinks, ContributionsSumToTheEchoAndAreEachOnce) {
  for_all([&](const CommonVisibility& visibility, const EchoModel& model) {
    const Echo echo = integrate_echo(visibility, {6, beams}, samples, model);
    const double peak = *std::max_element(echo.energy.begin(), echo.energy.end());
    std::vector<double> sum(echo.energy.size());
    const auto all = contributions(visibility, {6, beams}, samples, model, {}, echo);
    for (std::size_t k = 0; k < all.size(); ++k) {
      sum[all[k].beam * 300 + all[k].sample] += all[k].energy_j;
      if (k == 0) continue;
      const auto key = [](const Contribution& c) { return std::tuple(c.footprint, c.beam, c.sample); };
      ASSERT_LT(key(all[k - 1]), key(all[k]));
    }
    for (std::size_t bin = 0; bin < sum.size(); ++bin)
      ASSERT_NEAR(sum[bin], echo.energy[bin], 1e-12 * peak) << bin;
  });
}

TEST_F(Sinks, EnergiesOfFootprintsSumToTheEcho) {
  for_all([&](const CommonVisibility& visibility, const EchoModel& model) {
    const Echo echo = integrate_echo(visibility, {6, beams}, samples, model);
    const double whole = std::accumulate(echo.energy.begin(), echo.energy.end(), 0.0);
    const PathFootprints pairs = visibility.one_apex() ? PathFootprints{} : path_footprints(apart);
    const FootprintSet& footprints = visibility.one_apex() ? alone.footprints : pairs.footprints;
    const FootprintEnergies energies =
        footprint_energies(footprints, visibility.one_apex() ? visibility : CommonVisibility(pairs.history),
                           beams, {6, beams}, samples, model);
    ASSERT_EQ(energies.all_beams.size(), footprints.footprints.size());
    EXPECT_NEAR(std::accumulate(energies.all_beams.begin(), energies.all_beams.end(), 0.0) / whole, 1, 1e-10);
    for (std::size_t k = 0; k < energies.all_beams.size(); ++k)
      ASSERT_LE(energies.own_beam[k], energies.all_beams[k] * (1 + 1e-12));
  });
}

TEST_F(Sinks, PartsOfAVisibilityAddUp) {
  for_all([&](const CommonVisibility& visibility, const EchoModel& model) {
    const Echo echo = integrate_echo(visibility, {6, beams}, samples, model);
    std::vector<double> sum(echo.energy.size());
    for (std::size_t first = 0; first < visibility.end(); first += 7) {
      const Echo part = integrate_echo(visibility.within(first, first + 7), {6, beams}, samples, model);
      for (std::size_t bin = 0; bin < sum.size(); ++bin) sum[bin] += part.energy[bin];
    }
    const double peak = *std::max_element(echo.energy.begin(), echo.energy.end());
    for (std::size_t bin = 0; bin < sum.size(); ++bin)
      ASSERT_NEAR(sum[bin], echo.energy[bin], 1e-12 * peak) << bin;
  });
}

TEST_F(Sinks, LegsThatDoNotFitAreRefused) {
  EchoModel model{sink_material_mu, seabed.mesh.material, 0.1};
  model.path.tx.loss.factor = 0.5;
  EXPECT_THROW(integrate_echo(alone, {6, beams}, samples, model), std::invalid_argument);
  EXPECT_NO_THROW(integrate_echo(apart, {6, beams}, samples, model));
}

TEST_F(Sinks, MirrorsOnEitherLegTakeTheirPart) {
  for (const Binning binning : {Binning::exact, Binning::spread, Binning::centroid}) {
    EchoModel model{sink_material_mu, seabed.mesh.material, 0.1};
    const Echo whole = integrate_echo(apart, {6, beams}, samples, model, binning);
    model.path.tx.loss.factor = 0.5;
    model.path.rx = Leg{};
    model.path.rx->loss.factor = 0.25;
    const Echo lost = integrate_echo(apart, {6, beams}, samples, model, binning);
    for (std::size_t bin = 0; bin < whole.energy.size(); ++bin)
      ASSERT_NEAR(lost.energy[bin], whole.energy[bin] / 8, 1e-12 * whole.energy[bin]) << bin;
  }
}

}  // namespace
}  // namespace tubefoot
