// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified volume reverberation: its bounds contain ordinary results of high accuracy and closed
// forms, and meet the requested tolerance.
#include "engine/certified/volume_reference.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/echo/volume_echo.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "fixtures/world/histories.hpp"

namespace tubefoot {
namespace {

/// A transmission in a scene, with one beam per tube or one beam for all.
struct WaterPing {
  FacetMesh mesh;
  TubeSet tubes;
  double unit_m;
  std::vector<std::uint32_t> beams;
  int beam_count = 1;
  EchoModel model{};
  std::vector<double> mu = std::vector<double>(4, 0.002);

  struct Result {
    Echo ordinary;
    CertifiedEcho certified;
  };
  Result run(const RangeSamples& samples, const VolumeScattering& volume, double tolerance) {
    VisibilityOptions options;
    options.open_water = true;
    const SceneTree tree(mesh);
    const History history = TubeEngine(mesh, tree, unit_m, options).trace(tubes);
    model.material_mu = mu;
    model.material = mesh.material;
    Result result;
    result.ordinary = volume_echo(history, {beam_count, beams}, samples, model, volume);
    result.certified = certify_volume(mesh, tree, history, options, beams, samples, model, volume,
                                      result.ordinary, tolerance);
    return result;
  }
};

WaterPing random_ping(std::uint64_t seed) {
  WaterPing ping;
  test::Random random(seed);
  ping.mesh = test::make_random_triangles(random, 6, 20 << 10, 12 << 10);
  ping.tubes.reach = 1e9;
  AngularGrid grid;
  grid.azimuth_edges_rad = {1.2, 1.6, 2.0};
  grid.elevation_edges_rad = {-0.4, 0.3};
  append_tubes(ping.tubes, grid);
  ping.unit_m = 1.0 / (1 << 10);
  ping.beams = {0, 1};
  ping.beam_count = 2;
  return ping;
}

void expect_enclosed(const WaterPing::Result& result, double tolerance, double rounding) {
  EXPECT_EQ(result.certified.bins_over, 0u);
  const double largest = *std::ranges::max_element(result.ordinary.energy);
  ASSERT_GT(largest, 0);
  for (std::size_t bin = 0; bin < result.ordinary.energy.size(); ++bin) {
    const double energy = result.certified.echo.energy[bin], bound = result.certified.bound[bin];
    EXPECT_NEAR(result.ordinary.energy[bin], energy, bound + rounding * energy + 1e-15 * largest)
        << "bin " << bin;
    EXPECT_LE(bound, tolerance * std::max(energy, reference_floor * largest) * 1.001);
  }
}

TEST(VolumeReference, BoundsContainOrdinaryResultsInRandomScenesWithLayers) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (const double absorption : {0.0, 0.1}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", absorption " << absorption << " dB/m");
      WaterPing ping = random_ping(seed);
      ping.model.absorption_db_per_m = absorption;
      for (const VolumeScattering& volume :
           {VolumeScattering{{}, {1e-7}}, VolumeScattering{{-5, 1}, {2e-7, 0, 1e-7}}})
        expect_enclosed(ping.run({4, 3, 12}, volume, 1e-7), 1e-7, 1e-11);
    }
}

TEST(VolumeReference, SurfaceOnTheBorderOfALayerEndsTheLayer) {
  for (const double height : {-10.0, 10.0}) {
    WaterPing ping;
    const auto at = [&](double x, double y) { return glm::dvec3(x, y, height); };
    ping.mesh = test::mesh_of({{at(-512, -512), at(512, -512), at(512, 512)},
                               {at(-512, -512), at(512, 512), at(-512, 512)},
                               {glm::dvec3(8, -1, height / 2), {9, -1, height / 2}, {9, 1, height / 2}}});
    ping.unit_m = 0x1p-20;
    ping.tubes.reach = 1e12;
    ping.beams = {0};
    AngularGrid grid;
    grid.azimuth_edges_rad = {-0.3, 0.3};
    grid.elevation_edges_rad = height < 0 ? std::vector{-0.7, -0.35} : std::vector{0.35, 0.7};
    append_tubes(ping.tubes, grid);
    const WaterPing::Result uniform = ping.run({5, 2, 14}, {{}, {1e-7}}, 1e-7),
                            layers = ping.run(
                                {5, 2, 14},
                                {{height}, height > 0 ? std::vector{1e-7, 0.0} : std::vector{0.0, 1e-7}},
                                1e-7);
    for (std::size_t k = 0; k < 14; ++k)
      EXPECT_NEAR(layers.certified.echo.energy[k], uniform.certified.echo.energy[k],
                  layers.certified.bound[k] + uniform.certified.bound[k])
          << "plane at " << height << " m, sample " << k;
    expect_enclosed(layers, 1e-7, 1e-11);
  }
}

TEST(VolumeReference, FanAboveSeabedIsInsideTheBound) {
  // A fan between the depressions 20 and 40 degrees at 10 m above the seabed. The upper and lower walls are
  // planes, so the solid angle at each range follows from one integral over azimuth.
  WaterPing ping;
  const auto at = [](double x, double y) { return glm::dvec3(x, y, -10); };
  ping.mesh = test::mesh_of(
      {{at(-512, -512), at(512, -512), at(512, 512)}, {at(-512, -512), at(512, 512), at(-512, 512)}});
  ping.unit_m = 0x1p-20;
  ping.tubes.reach = 1e12;
  ping.beams = {0};
  AngularGrid grid;
  grid.azimuth_edges_rad = {-0.3, 0.3};
  grid.elevation_edges_rad = {-0.7, -0.35};
  append_tubes(ping.tubes, grid);
  const RangeSamples samples{5, 1, 28};
  const WaterPing::Result result = ping.run(samples, {{}, {1e-7}}, 1e-8);
  expect_enclosed(result, 1e-8, 1e-11);
  std::array<glm::dvec3, 4> ray;
  for (std::size_t k = 0; k < 4; ++k) {
    const GridPoint& r = ping.tubes.rays[ping.tubes.tubes[0][k]];
    ray[k] = glm::normalize(glm::dvec3(double(r.x), double(r.y), double(r.z)));
  }
  // Depression of a wall in an azimuth: the wall contains two rays with the same depression.
  const auto wall = [&](bool upper) {
    std::vector<glm::dvec3> pair;
    for (const glm::dvec3& d : ray)
      if ((d.z > -0.5) == upper) pair.push_back(d);
    return glm::cross(pair[0], pair[1]);
  };
  const glm::dvec3 upper = wall(true), lower = wall(false);
  const auto sine_at = [](const glm::dvec3& normal, double azimuth) {
    const double tangent = (normal.x * std::cos(azimuth) + normal.y * std::sin(azimuth)) / normal.z;
    return tangent / std::sqrt(1 + tangent * tangent);
  };
  const double edge = std::atan2(ray[0].y, ray[0].x);
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 61>;
  for (int k = 0; k < samples.count; ++k) {
    const double r0 = samples.border_m(k), r1 = samples.border_m(k + 1);
    const auto per_azimuth = [&](double azimuth) {
      // The walls have sines s, and the seabed the range R = H / s. Beyond r, s is below H / r.
      const double least = sine_at(upper, azimuth), most = sine_at(lower, azimuth);
      const auto primitive = [&](double r) {  // integral of (min(most, H/r) - least) r^-2, from the far end
        const double from = 10 / most, to = 10 / least;
        const double x = std::min(r, to);
        const auto beyond = [&](double y) { return -5 / (y * y) + least / y; };
        return x <= from ? (most - least) * (1 / from - 1 / x) : beyond(x) - beyond(from);
      };
      return primitive(r1) - primitive(r0);
    };
    double expected = 0;
    constexpr int panels = 400;  // bins may begin within the azimuths
    for (int p = 0; p < panels; ++p) {
      const double a = std::abs(edge) * (2.0 * p / panels - 1),
                   b = std::abs(edge) * (2.0 * (p + 1) / panels - 1);
      expected += 1e-7 * Kronrod::integrate(per_azimuth, a, b, 0);
    }
    EXPECT_NEAR(
        result.certified.echo.energy[std::size_t(k)], expected,
        result.certified.bound[std::size_t(k)] + 2e-8 * expected + 1e-13 * result.certified.echo.energy[0])
        << "sample " << k;
  }
}

TEST(VolumeReference, PatternsAreInsideTheBound) {
  WaterPing ping = random_ping(3);
  Directivity line;
  line.kind = Directivity::Kind::line;
  line.axis = glm::normalize(glm::dvec3(1, 0.1, 0));
  line.size = 6;
  line.centre = 0.05;
  Directivity wide;
  wide.kind = Directivity::Kind::gaussian;
  wide.axis = {0, 1, 0};
  wide.from_axis = true;
  wide.size = 0.8;
  const BeamPatterns patterns{{TransmitPattern(wide)}, {line}, {0, 0}, {{0, 1}, {0, 1}}};
  ping.beams = {0, 0};
  ping.beam_count = 1;
  ping.model.patterns = &patterns;
  ping.model.pattern_tolerance = 1e-10;
  expect_enclosed(ping.run({4, 8, 4}, {{-5}, {2e-7, 1e-7}}, 1e-6), 1e-6, 1e-8);
}

}  // namespace
}  // namespace tubefoot
