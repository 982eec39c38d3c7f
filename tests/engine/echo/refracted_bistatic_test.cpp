// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the engine with a separate transmitter and receiver in stratified water. The comparisons are the
// straight engine, closed forms of one gradient, and reciprocity.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "engine/echo/echo.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"
#include "engine/surface/facet_flattening.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "engine/water/apparent_map.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::total;

constexpr double refracted_mu = 0.002, below_m = 20, surface_m = 10;
const std::vector<double> refracted_material_mu{refracted_mu};
const WorldGrid grid{20, glm::dvec3(0)};
const glm::dvec3 transmitter(0), receiver(-6, 5, 3);

/// A seabed of cells between x = 10 and 40 whose height is a function of x and y, with an optional box.
template <class Height>
FacetMesh seabed(double cell_m, const Height& height, bool with_box = false) {
  MeshBuilder builder(grid);
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto quad = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
    const auto i = std::uint32_t(points.size());
    for (const glm::dvec3& p : {a, b, c, d}) points.push_back(p);
    triangles.push_back({i, i + 1, i + 2});
    triangles.push_back({i, i + 2, i + 3});
  };
  const auto at = [&](double x, double y) { return glm::dvec3(x, y, height(x, y)); };
  for (double x = 10; x < 40; x += cell_m)
    for (double y = -15; y < 15; y += cell_m)
      quad(at(x, y), at(x + cell_m, y), at(x + cell_m, y + cell_m), at(x, y + cell_m));
  if (with_box)
    for (int side = 0; side < 4; ++side) {
      const glm::dvec2 corner[5]{{20, -3}, {23, -3}, {23, 4}, {20, 4}, {20, -3}};
      const glm::dvec2 a = corner[side], b = corner[side + 1];
      quad({a, -21}, {b, -21}, {b, -15}, {a, -15});
    }
  builder.add(points, triangles, 0, 0);
  MeshReport report;
  return builder.finish(report);
}

double flat(double, double) { return -below_m; }
double wavy(double x, double y) { return -below_m + 0.8 * std::sin(0.7 * x) * std::cos(0.5 * y); }

WaterColumn gradient(double g) {
  // The sound speed is 1500 m/s at the transmitter.
  return {SoundSpeedProfile({{0, 1500 - surface_m * g}, {60, 1500 + (60 - surface_m) * g}}), {}};
}

/// Tubes over the whole seabed.
TubeSet tubes_at(glm::dvec3 apex_m, bool fine = false) {
  TubeSet set;
  set.apex = grid.snap(apex_m);
  set.reach = 1e12;
  AngularGrid angles{{-75 * degree, -35 * degree, 0, 35 * degree, 75 * degree},
                     {-87 * degree, -55 * degree, -30 * degree, -3 * degree}};
  if (fine)
    for (auto* edges : {&angles.azimuth_edges_rad, &angles.elevation_edges_rad}) {
      std::vector<double> halves;
      for (std::size_t k = 0; k + 1 < edges->size(); ++k)
        for (const double part : {0.0, 0.3, 0.6})
          halves.push_back((*edges)[k] + part * ((*edges)[k + 1] - (*edges)[k]));
      halves.push_back(edges->back());
      *edges = halves;
    }
  append_tubes(set, angles);
  return set;
}

struct Scenery {
  FacetMesh base;
  const WaterColumn& water;
  double travel_path_error_m = 0.01;
  std::shared_ptr<const ReflectivityField> texture;
  double absorption = 0;

  BistaticHistory history(const TubeSet& sent, const TubeSet& received) const {
    const ApparentMap transmit(water, grid.to_metres(sent.apex), surface_m, {}, 1500),
        receive(water, grid.to_metres(received.apex), surface_m, {}, 1500);
    std::vector<FacetId> all(base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const ApparentPair pair = map_apparent_pair(base, all, grid, transmit, receive, absorption,
                                                {.travel_path_error_m = travel_path_error_m});
    material = pair.mesh.material;
    return trace_bistatic(pair, grid, {}, sent, received, transmit, receive, absorption);
  }
  BistaticHistory straight(const TubeSet& sent, const TubeSet& received) const {
    material = base.material;
    return trace_bistatic(base, SceneTree(base), grid.unit_m(), {}, sent, received);
  }
  Echo echo(const BistaticHistory& of, const RangeSamples& samples) const {
    const std::vector<std::uint32_t> beam(of.receive.tubes.size(), 0);
    const std::vector<std::shared_ptr<const ReflectivityField>> textures{texture};
    EchoModel model{refracted_material_mu, material, absorption, nullptr};
    if (texture) model.reflectivity = textures;
    model.path.tx.apex_m = grid.to_metres(of.transmit.apex);
    return integrate_echo(of, {1, beam}, samples, model);
  }
  mutable std::vector<std::uint16_t> material{};
};

TEST(RefractedBistatic, IsovelocityWaterIsTheStraightEngine) {
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {60, 1500}}), {0.02, 0.02}};
  const auto texture = std::make_shared<const PerlinReflectivity>(
      PerlinReflectivity::Settings{.wavelength_m = 2, .octaves = 1, .depth = 0.8, .seed = 4});
  const TubeSet sent = tubes_at(transmitter), received = tubes_at(receiver);
  for (const auto& field : {std::shared_ptr<const PerlinReflectivity>(), texture}) {
    const Scenery scenery{seabed(2, wavy, true), water, 0.01, field, 0.02};
    const RangeSamples samples{20, 0.5, 60};
    const Echo straight = scenery.echo(scenery.straight(sent, received), samples);
    const BistaticHistory history = scenery.history(sent, received);
    ASSERT_EQ(history.bistatic.size(), history.shared.facets.size());
    for (const BistaticFacet& facet : history.bistatic) EXPECT_LT(facet.misfit_m, 1e-9);
    const Echo refracted = scenery.echo(history, samples);
    const double peak = *std::max_element(straight.energy.begin(), straight.energy.end());
    int lit = 0;
    for (std::size_t k = 0; k < straight.energy.size(); ++k) {
      EXPECT_NEAR(refracted.energy[k], straight.energy[k], 2e-10 * straight.energy[k] + 1e-13 * peak) << k;
      lit += straight.energy[k] > 0;
    }
    EXPECT_GT(lit, 30);
  }
}

/// The ray between two points in one gradient, in closed form (physics sheet 2.2).
struct Ray {
  double time_s, sine_at_seabed, tube_area_m2;  ///< area at the seabed per steradian at the apex
  Ray(double g, glm::dvec3 apex, glm::dvec3 at) {
    const double cs = 1500 - g * apex.z, cr = 1500 - g * at.z, h = apex.z - at.z;
    const double x = std::hypot(at.x - apex.x, at.y - apex.y), chord2 = x * x + h * h;
    time_s = std::acosh(1 + g * g * chord2 / (2 * cs * cr)) / std::abs(g);
    sine_at_seabed = std::sin(std::asin(h / std::sqrt(chord2)) - std::atan(g * x / (cs + cr)));
    tube_area_m2 = std::pow(cr * std::sinh(g * time_s) / g, 2);
  }
};

/// Returns the energy over a flat seabed, and the mean half path as a range.
std::pair<double, double> closed_form(double g, glm::dvec3 t, glm::dvec3 r) {
  using Rule = boost::math::quadrature::gauss_kronrod<double, 31>;
  const auto over_seabed = [&](bool with_path) {
    return Rule::integrate(
        [&](double x) {
          return Rule::integrate(
              [&](double y) {
                const glm::dvec3 at(x, y, -below_m);
                const Ray tx(g, t, at), rx(g, r, at);
                const double speeds = (1500 - g * r.z) / (1500 + g * below_m);
                return refracted_mu * tx.sine_at_seabed * rx.sine_at_seabed /
                       (tx.tube_area_m2 * rx.tube_area_m2 * speeds * speeds) *
                       (with_path ? 750 * (tx.time_s + rx.time_s) : 1);
              },
              -15.0, 15.0, 5, 1e-11);
        },
        10.0, 40.0, 5, 1e-11);
  };
  const double energy = over_seabed(false);
  return {energy, over_seabed(true) / energy};
}

TEST(RefractedBistatic, FlatSeabedUnderOneGradientConvergesToTheClosedForm) {
  for (const double g : {-1.0, 0.4}) {
    const WaterColumn water = gradient(g);
    const auto [energy, path] = closed_form(g, transmitter, receiver);
    double before = 0;
    for (const double gap : {0.04, 0.0025}) {
      SCOPED_TRACE(testing::Message() << "g " << g << " gap " << gap);
      const Scenery scenery{seabed(15, flat), water, gap, nullptr};
      const RangeSamples samples{15, 0.02, 2000};
      const BistaticHistory history = scenery.history(tubes_at(transmitter), tubes_at(receiver));
      for (const BistaticFacet& facet : history.bistatic) EXPECT_LT(facet.misfit_m, 1e-9);
      const Echo echo = scenery.echo(history, samples);
      double mean = 0;
      for (int k = 0; k < samples.count; ++k)
        mean += echo.energy[std::size_t(k)] * (samples.first_m + (k + 0.5) * samples.step_m);
      const double error = std::abs(total(echo) / energy - 1);
      EXPECT_LT(error, 0.3 * gap);
      EXPECT_NEAR(mean / total(echo), path, gap);
      if (gap == 0.0025) {
        EXPECT_LT(error, before / 3);
      }
      before = error;
    }
  }
}

// By reciprocity, the tube areas in both directions differ by the square of the ratio of the sound speeds
// at the ends.
TEST(RefractedBistatic, SwappingTransmitterAndReceiverIsReciprocal) {
  for (const double g : {-1.0, 0.4}) {
    SCOPED_TRACE(g);
    const WaterColumn water = gradient(g);
    const Scenery scenery{seabed(3, wavy, true), water, 0.02, nullptr};
    const TubeSet a = tubes_at(transmitter), b = tubes_at(receiver);
    const RangeSamples samples{20, 0.5, 60};
    const Echo there = scenery.echo(scenery.history(a, b), samples),
               back = scenery.echo(scenery.history(b, a), samples);
    const double speeds = std::pow((1500 - g * receiver.z) / 1500, 2);
    const double peak = *std::max_element(there.energy.begin(), there.energy.end());
    for (std::size_t k = 0; k < there.energy.size(); ++k)
      EXPECT_NEAR(there.energy[k] * speeds, back.energy[k], 1e-9 * back.energy[k] + 1e-13 * peak) << k;
    EXPECT_GT(peak, 0);
  }
}

// Visible polygons of adjacent tubes neither overlap nor leave gaps in the area that each apex sees.
TEST(RefractedBistatic, TubesAddUp) {
  const WaterColumn water = gradient(-1);
  const Scenery scenery{seabed(3, wavy, true), water, 0.02, nullptr};
  const RangeSamples samples{10, 60, 1};
  const double whole =
      total(scenery.echo(scenery.history(tubes_at(transmitter), tubes_at(receiver)), samples));
  for (const auto& [a, b] : {std::pair{true, false}, {false, true}, {true, true}}) {
    const BistaticHistory parts = scenery.history(tubes_at(transmitter, a), tubes_at(receiver, b));
    EXPECT_NEAR(total(scenery.echo(parts, samples)) / whole, 1, 1e-9) << a << b;
  }
}

// With both ends at one position, the echo equals that of the monostatic engine, except for the error of
// one factor per facet.
TEST(RefractedBistatic, InOnePlaceItIsTheMonostaticEcho) {
  const WaterColumn water = gradient(-1);
  const FacetMesh base = seabed(3, wavy, true);
  const double gap = 0.001;
  const Scenery scenery{base, water, gap, nullptr};
  const TubeSet tubes = tubes_at(transmitter);
  const RangeSamples samples{20, 0.5, 60};
  const Echo apart = scenery.echo(scenery.history(tubes, tubes), samples);
  std::vector<FacetId> all(base.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  const ApparentSurface surface_mesh = map_apparent(
      base, all, grid, ApparentMap(water, transmitter, surface_m, {}, 1500), 0, {.travel_path_error_m = gap});
  const FacetMesh& mesh = surface_mesh.refined.mesh;
  EchoModel model{refracted_material_mu, mesh.material, 0, nullptr};
  model.path.facet_factor = surface_mesh.facet_factor;
  const std::vector<std::uint32_t> beam(tubes.tubes.size(), 0);
  const SceneTree tree(mesh);
  const Echo one =
      integrate_echo(TubeEngine(mesh, tree, grid.unit_m(), {}).trace(tubes), {1, beam}, samples, model);
  int lit = 0;
  for (std::size_t k = 0; k < one.energy.size(); ++k) {
    EXPECT_NEAR(apart.energy[k], one.energy[k], 1e-3 * one.energy[k]) << k;
    lit += one.energy[k] > 0;
  }
  EXPECT_GT(lit, 30);
}

TEST(RefractedBistatic, RefusesPairsOfOtherFacets) {
  const WaterColumn water = gradient(-1);
  const Scenery scenery{seabed(15, flat), water, 0.1, nullptr};
  BistaticHistory history = scenery.history(tubes_at(transmitter), tubes_at(receiver));
  history.bistatic.pop_back();
  EXPECT_THROW(scenery.echo(history, {15, 1, 40}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
