// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that lanes of sixteen rays give the same bits as single rays: directions, weights, plane
// intersections, echoes, and the exponential decay.
#include "engine/rays/ray_lanes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/echo/hit_lanes.hpp"
#include "engine/rays/ray_planes.hpp"
#include "fixtures/world/ray_scenes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using namespace splitmix;

TEST(RayLanes, DirectionsAndWeightsAreThoseOfOneRay) {
  const TubeSet tubes = pyramid({0, 0, 0}, {1, 0.2, -0.7}, 25 * degree, 40 * degree);
  const RayPatch patch(tubes, tubes.tubes[0]);
  RayCells cells;
  for (int k = 0; k < RayPacket::size; ++k) {
    cells.column[k] = k % 4;
    cells.u_step[k] = 0.25;
    cells.begin[k] = 4.0 * (k / 4);
    cells.count[k] = 4;
    cells.weight[k] = 1 / 16.0;
  }
  cells.share = 1 / 16.0;
  constexpr std::uint64_t key = 77, first = 5;
  RayPacket packet;
  aim_into(patch, cells, key, first, packet);
  for (int k = 0; k < RayPacket::size; ++k) {
    const std::uint64_t bits = mixed(key + golden * (first + std::uint64_t(k)));
    const double u = (cells.column[k] + upper_uniform(bits)) * cells.u_step[k];
    const double v = (cells.begin[k] + lower_uniform(bits) * cells.count[k]) * cells.share;
    const glm::dvec3 p = patch.at(u, v);
    const double inverse = 1 / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    EXPECT_EQ(packet.x[k], p.x * inverse) << k;
    EXPECT_EQ(packet.y[k], p.y * inverse) << k;
    EXPECT_EQ(packet.z[k], p.z * inverse) << k;
    EXPECT_EQ(packet.weight[k], patch.triple(u, v) * (inverse * inverse * inverse) * cells.weight[k]) << k;
  }
}

TEST(RayLanes, PlanesAreMetAsByOneRay) {
  FacetMesh mesh = flat_seabed(10);
  add_rectangle(mesh, {-1, -1, -5}, {2, 0.3, 0.1}, {0, 2, 0.4});
  add_rectangle(mesh, {0, 0, -1}, {0, 0, -2}, {1, 0.5, 0});  // the apex lies in its plane
  const RayPlanes planes(mesh, grid.unit_m());
  const GridPoint apex = grid.snap({0, 0, 0});
  std::mt19937_64 random(5);
  std::normal_distribution<double> gauss;
  int sure = 0, doubtful = 0;
  for (int round = 0; round < 200; ++round) {
    RayPacket rays;
    std::array<FacetId, RayPacket::size> facet{};
    std::array<float, RayPacket::size> embree{};
    for (int k = 0; k < RayPacket::size; ++k) {
      const glm::dvec3 d = glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
      rays.x[k] = d.x;
      rays.y[k] = d.y;
      rays.z[k] = d.z;
      facet[k] = FacetId((round + k) % int(mesh.facets.size()));
      RayHit hit;
      hit.facet = facet[k];
      planes.meet(apex, d, 1, hit);
      embree[k] = k % 5 == 0 ? 3.0f : float(hit.slant_range_m);  // a fifth have another range
    }
    MetPlanes met;
    planes.meet(apex, rays, facet, embree.data(), met);
    std::int64_t some_doubtful = 0;
    for (int k = 0; k < RayPacket::size; ++k) {
      RayHit hit;
      hit.facet = facet[k];
      const bool is_met = planes.meet(apex, {rays.x[k], rays.y[k], rays.z[k]}, double(embree[k]), hit);
      some_doubtful |= met.doubtful[k];
      if (met.doubtful[k] != 0) {
        ++doubtful;
        continue;
      }
      ++sure;
      ASSERT_TRUE(is_met);
      ASSERT_EQ(met.range_m[k], hit.slant_range_m);
      ASSERT_EQ(met.sine_grazing[k], hit.sine_grazing);
    }
    ASSERT_EQ(met.any_doubtful != 0, some_doubtful != 0);
  }
  EXPECT_GT(sure, 200);
  EXPECT_GT(doubtful, 200);
}

TEST(RayLanes, EchoesOfHitsTogetherAreThoseOfHitsAlone) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  const std::vector<std::uint16_t> material{0, 1, 2, 0};
  const std::vector<double> mu{0.002, 0.5, 0.003};
  const std::vector<std::uint32_t> beam_of_tube{0, 1, 0};
  const RangeSamples samples{2, 0.7, 9};
  for (const double absorption : {0.0, 0.3}) {
    const EchoModel model{mu, material, absorption};
    for (const int count : {0, 1, 15, 16, 17, 100}) {
      History history;
      history.tubes.tubes.resize(3);
      std::vector<double> expected(18);
      for (int k = 0; k < count; ++k) {
        RayHit hit;
        hit.facet = FacetId(random() % 4);
        hit.tube = std::uint32_t(random() % 3);
        hit.slant_range_m = 10 * uniform(random);  // some before the first range bin, some behind the last
        hit.sine_grazing = k % 11 == 7 ? 0 : uniform(random);
        hit.solid_angle_sr = 1e-4 * uniform(random);
        hit.direction = {0, 0, -1};
        history.hits.push_back(hit);
        const double r = hit.slant_range_m, sine = hit.sine_grazing;
        const double beta = absorption * std::log(10.0) / 10;
        const auto sample = int(std::floor((r - 2) / 0.7));
        if (sine > 0 && sample >= 0 && sample < 9)
          expected[beam_of_tube[hit.tube] * 9 + std::size_t(sample)] +=
              mu[material[hit.facet]] * sine * std::exp(-2 * beta * r) / (r * r) * hit.solid_angle_sr;
      }
      const Echo echo = integrate_echo(history, {2, beam_of_tube}, samples, model);
      std::vector<double> alone(18);
      for (const RayHit& hit : history.hits) {
        History one;
        one.tubes = history.tubes;
        one.hits = {hit};
        const Echo own = integrate_echo(one, {2, beam_of_tube}, samples, model);
        for (std::size_t k = 0; k < 18; ++k) alone[k] += own.energy[k];
      }
      for (std::size_t k = 0; k < 18; ++k) {
        EXPECT_NEAR(echo.energy[k], alone[k], 1e-15 * expected[k]) << count << " hits, bin " << k;
        EXPECT_NEAR(echo.energy[k], expected[k], 1e-14 * expected[k]) << count << " hits, bin " << k;
      }
    }
  }
}

TEST(RayLanes, DecayIsTheExponential) {
  double worst = 0;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  HitBlock::Lanes<double> x, out;
  for (int round = 0; round < 20000; ++round) {
    for (double& one : x) one = round % 2 == 0 ? -708 * uniform(random) : -std::exp(-40 * uniform(random));
    if (round == 0) x = {0, -0.0, -708, -1e-300, -0.34657359027997264, -0.34657359027997270, -0.5, -1};
    decay(x, out);
    for (std::size_t k = 0; k < x.size(); ++k) {
      const long double exact = std::exp(static_cast<long double>(x[k]));
      worst = std::max(worst, double(std::abs(out[k] / exact - 1)));
    }
  }
  EXPECT_LT(worst, 4e-16);
  x.fill(-708.5);
  x[3] = -std::numeric_limits<double>::infinity();
  decay(x, out);
  for (const double value : out) EXPECT_EQ(value, 0);
}

TEST(RayLanes, BordersOfSamplesDecide) {
  const RangeSamples samples{0.3, 0.1, 7};
  const SampleFinder finder(samples);
  const std::vector<std::uint16_t> material{0};
  const std::vector<double> mu{1, -1};
  HitBlock::Lanes<double> under;
  for (int border = 0; border <= 7; ++border)
    for (const int side : {-1, 0, 1}) {
      HitBlock block;
      block.count = 0;
      const double at = samples.border_m(border);
      const double r = side == 0 ? at : std::nextafter(at, at + side);
      for (int k = 0; k < 16; ++k) block.append({0, 0, r, k == 15 ? 0 : 0.5, 1, {}});
      EXPECT_EQ(find_mu(block, material, mu, under), 1);
      const LambertEchoes echoes = echoes_of(block, under, 0, finder);
      const int expected = side < 0 ? border - 1 : border;
      for (int k = 0; k < 15; ++k)
        EXPECT_EQ(echoes.sample[k], expected < 7 ? expected : LambertEchoes::no_sample) << r;
      EXPECT_EQ(echoes.sample[15], LambertEchoes::no_sample);
      EXPECT_FALSE(echoes.whole);
    }
}

TEST(RayLanes, MaterialsOfOtherLawsStandAmongEvenOnes) {
  const std::vector<std::uint16_t> material{0, 1};
  const std::vector<double> mu{0.002, 0.5};
  const std::vector<std::shared_ptr<const ScatteringModel>> models{
      nullptr, std::make_shared<const ScatteringModel>(
                   ScatteringModel::gsab({.oblique = 1e-3, .oblique_exponent = 1}))};
  const std::vector<std::uint32_t> beam_of_tube{0};
  EchoModel model{mu, material, 0.1};
  model.scattering = models;
  History history;
  history.tubes.tubes.resize(1);
  double expected = 0;
  for (int k = 0; k < 40; ++k) {
    RayHit hit;
    hit.facet = FacetId(k % 3 == 0);
    hit.slant_range_m = 3 + 0.1 * k;
    hit.sine_grazing = 0.02 * (k + 1);
    hit.solid_angle_sr = 1e-5;
    history.hits.push_back(hit);
    const double sigma =
        hit.facet == 1 ? 1e-3 * hit.sine_grazing : 0.002 * hit.sine_grazing * hit.sine_grazing;
    expected += sigma * std::exp(-2 * 0.01 * std::log(10.0) * hit.slant_range_m) * 1e-5 /
                (hit.sine_grazing * hit.slant_range_m * hit.slant_range_m);
  }
  const Echo echo = integrate_echo(history, {1, beam_of_tube}, {1, 19, 1}, model);
  EXPECT_NEAR(echo.energy[0] / expected, 1, 1e-13);
}

TEST(RayLanes, HitsOfNoBeamOrNoMaterialAreRefused) {
  const std::vector<std::uint16_t> material{0};
  const std::vector<double> mu{0.002};
  const std::vector<std::uint32_t> beam_of_tube{0};
  History history;
  history.tubes.tubes.resize(1);
  RayHit one, other;
  one.slant_range_m = one.sine_grazing = other.slant_range_m = other.sine_grazing = 0.5;
  const auto echo = [&] {
    history.hits = {one, other};
    return integrate_echo(history, {1, beam_of_tube}, {0, 1, 1}, {mu, material, 0});
  };
  EXPECT_NO_THROW(echo());
  other.tube = 1;
  EXPECT_THROW(echo(), std::invalid_argument);
  other.tube = 0;
  other.facet = 1;
  EXPECT_THROW(echo(), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
