// SPDX-License-Identifier: GPL-3.0-or-later
// Tests apparent surfaces in stratified water. It covers closed forms of one gradient, shadows, hidden
// seabed, true positions and areas, and scattering at true grazing angles.

#include "engine/surface/refracted_surface.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numeric>

#include "engine/certified/reference.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "engine/water/apparent_map.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "fixtures/world/gradient_seabed.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::seabed_gradient;

const double mu = std::pow(10, -2.7);

/// A flat seabed, the apex at the origin of the local frame, and the sea surface above it.
struct Site {
  static constexpr double below_m = 20, apex_depth_m = 10;
  WorldGrid grid{20, glm::dvec3(0)};
  FacetMesh base;

  explicit Site(double half_width_m = 256, double cell_m = 512) {
    MeshBuilder builder(grid);
    test::add_flat_seabed(builder, half_width_m, cell_m, below_m);
    MeshReport report;
    base = builder.finish(report);
  }

  ApparentSurface surface_mesh(const WaterColumn& water, double travel_path_error_m,
                               double absorption = 0) const {
    std::vector<FacetId> all(base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const ApparentMap apparent_map(water, glm::dvec3(0), apex_depth_m);
    return map_apparent(base, all, grid, apparent_map, absorption,
                        {.travel_path_error_m = travel_path_error_m});
  }
};

/// Tubes of a fan that looks along x, all in one beam.
TubeSet fan() {
  AngularGrid angles;
  for (int k = 0; k <= 4; ++k) angles.azimuth_edges_rad.push_back(20 * degree * (k / 4.0 - 0.5));
  angles.elevation_edges_rad = {-80 * degree, -40 * degree, -20 * degree, -3 * degree};
  TubeSet set;
  set.reach = 1e12;
  append_tubes(set, angles);
  return set;
}

struct Reception {
  Echo echo;
  std::vector<double> bound;
};

Reception hear(const FacetMesh& mesh, std::span<const double> factor, const RangeSamples& samples,
               double absorption = 0, double tolerance = 0) {
  const SceneTree tree(mesh);
  const std::vector<double> material_mu{mu};
  EchoModel model{material_mu, mesh.material, absorption, nullptr};
  model.path.facet_factor = factor;
  const TubeSet tubes = fan();
  const std::vector<std::uint32_t> beams(tubes.tubes.size(), 0);
  const History history = TubeEngine(mesh, tree, 0x1p-20, {}).trace(tubes);
  Reception received{integrate_echo(history, {1, beams}, samples, model), {}};
  if (tolerance > 0) {
    const CertifiedEcho certified =
        certify_echo(mesh, tree, history, {}, beams, samples, model, received.echo, tolerance);
    received.bound = certified.bound;
    for (std::size_t k = 0; k < received.bound.size(); ++k)
      EXPECT_LE(std::abs(received.echo.energy[k] - certified.echo.energy[k]),
                certified.bound[k] + 1e-14 * mu);
  }
  return received;
}

const RangeSamples range_samples{40, 5, 20};

/// Returns the energy from the ring between two one-way travel times. With G = g t, the area element, tube
/// area and angles of one gradient have closed forms (physics sheet 2.2). The integral is over time.
double ring_energy(double g, double t1, double t2) {
  const double h = Site::below_m, cs = 1500, cr = cs + g * h;
  const auto density = [&](double t) {
    const double x2 = 2 * cs * cr / (g * g) * (std::cosh(g * t) - 1) - h * h;
    const double sinh_g = std::sinh(g * t) / g, area = cr * cr * sinh_g * sinh_g;
    const double chord = std::sqrt(x2 + h * h), tilt = std::atan(g * std::sqrt(x2) / (cs + cr));
    const double sine = std::sin(std::asin(h / chord) - tilt);
    return mu * sine * sine * cr * cr / (cs * cs) / (area * area) * cs * cr * sinh_g;
  };
  return 20 * degree *
         boost::math::quadrature::gauss_kronrod<double, 31>::integrate(density, t1, t2, 5, 1e-13);
}

TEST(RefractedSurface, IsovelocityWaterIsTheStraightEngine) {
  const Site site;
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {50, 1480}}), {0.05, 0.05, 0.05}};
  const ApparentSurface surface_mesh = site.surface_mesh(water, 1e-6, 0.05);
  EXPECT_EQ(surface_mesh.refined.mesh.vertices, site.base.vertices);
  EXPECT_EQ(surface_mesh.refined.mesh.facets, site.base.facets);
  EXPECT_TRUE(surface_mesh.unclear.empty());
  EXPECT_EQ(surface_mesh.reference_speed_m_s, 1480);
  EXPECT_LT(surface_mesh.largest_travel_path_error_m, 1e-11);
  for (const double factor : surface_mesh.facet_factor) EXPECT_NEAR(factor, 1, 1e-11);
  const Echo straight = hear(site.base, {}, range_samples, 0.05).echo;
  const Echo refracted = hear(surface_mesh.refined.mesh, surface_mesh.facet_factor, range_samples, 0.05).echo;
  for (std::size_t k = 0; k < straight.energy.size(); ++k) {
    EXPECT_GT(straight.energy[k], 0);
    EXPECT_NEAR(refracted.energy[k] / straight.energy[k], 1, 1e-10);
  }
}

TEST(RefractedSurface, FlatSeabedUnderOneGradientConvergesToTheClosedForm) {
  const Site site;
  for (const double g : {-0.5, 0.3}) {
    SCOPED_TRACE(g);
    double before = 0;
    for (const double gap : {0.16, 0.04, 0.01}) {
      const ApparentSurface surface_mesh = site.surface_mesh(seabed_gradient(g), gap);
      EXPECT_TRUE(surface_mesh.unclear.empty());
      EXPECT_LE(surface_mesh.largest_travel_path_error_m, gap);
      const Echo echo = hear(surface_mesh.refined.mesh, surface_mesh.facet_factor, range_samples).echo;
      double sum = 0, found = 0, wanted = 0;
      for (int k = 0; k < range_samples.count; ++k) {
        const double r1 = range_samples.first_m + k * range_samples.step_m, r2 = r1 + range_samples.step_m;
        const double truth = ring_energy(g, r1 / 1500, r2 / 1500);
        // Each factor is correct for a whole facet. The error of far parts of a large facet exceeds that of
        // near parts.
        EXPECT_NEAR(echo.energy[k] / truth, 1, 0.55 * gap) << g << ' ' << gap << ' ' << k;
        sum += std::abs(echo.energy[k] - truth) / truth / range_samples.count;
        found += echo.energy[k];
        wanted += truth;
      }
      EXPECT_NEAR(found / wanted, 1, 0.2 * gap) << g << ' ' << gap;
      if (before > 0) {
        EXPECT_LT(sum, before / 2);
      }
      before = sum;
    }
    EXPECT_LT(before, 2e-3);
  }
}

TEST(RefractedSurface, PointsConvergeAtSecondOrder) {
  // The travel-path error is the error at the middle of a facet: half the edge length gives a quarter of
  // it.
  const WaterColumn water = seabed_gradient(-0.5);
  const ApparentMap apparent_map(water, glm::dvec3(0), Site::apex_depth_m);
  double before = 0;
  for (const double cell : {32., 16., 8., 4.}) {
    const Site site(128, cell);
    const ApparentSurface surface_mesh = site.surface_mesh(water, 1e9);
    ASSERT_EQ(surface_mesh.refined.mesh.facets, site.base.facets);
    double gap = 0;
    for (const auto& f : site.base.facets)
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 a = site.grid.to_metres(site.base.vertices[f[k]]),
                         b = site.grid.to_metres(site.base.vertices[f[(k + 1) % 3]]);
        gap = std::max(
            gap, edge_travel_path_error_m(apparent_map.apparent(a)->at_m, apparent_map.apparent(b)->at_m,
                                          apparent_map.apparent((a + b) / 2.0)->at_m));
      }
    EXPECT_LE(gap, surface_mesh.largest_travel_path_error_m);  // a bound where it was not measured
    EXPECT_LT(surface_mesh.largest_travel_path_error_m, 5 * gap);
    if (before > 0) {
      EXPECT_NEAR(before / gap, 4, 1) << cell;
    }
    before = gap;
  }
}

TEST(RefractedSurface, TubesOverApparentFacetsClose) {
  const Site site;
  const ApparentSurface surface_mesh = site.surface_mesh(seabed_gradient(-0.5), 0.02);
  EXPECT_GT(surface_mesh.refined.mesh.facets.size(), 100u);
  const SceneTree tree(surface_mesh.refined.mesh);
  const TubeEngine engine(surface_mesh.refined.mesh, tree, 0x1p-20, {});
  for (const TubeAudit& audit : engine.audit(fan(), 1)) EXPECT_TRUE(audit.closes);
}

TEST(RefractedSurface, ShadowsAreReportedAndLeftOut) {
  const Site site;
  // Rays diverge from the depth of the highest speed, 20 m, between apex and seabed. The last ray that
  // passes is horizontal there.
  const WaterColumn water{SoundSpeedProfile({{0, 1460}, {20, 1500}, {40, 1460}}), {}};
  const double edge = 2 * std::sqrt((1500 - 1480) * (1500 + 1480.)) / 2;
  const ApparentSurface surface_mesh = site.surface_mesh(water, 0.05);
  ASSERT_FALSE(surface_mesh.unclear.empty());
  EXPECT_GT(surface_mesh.facets_in_shadow, 0u);
  for (const UnclearPlace& place : surface_mesh.unclear) {
    EXPECT_EQ(place.eigenrays, 0);
    EXPECT_GT(std::hypot(place.at_m.x, place.at_m.y), edge * (1 - 1e-9));
    EXPECT_NEAR(glm::length(place.direction), 1, 1e-12);
  }
  EXPECT_GT(surface_mesh.facet_factor.size(), 0u);
}

// Rays may bend upwards before they reach the seabed. Rays that would come through the seabed from below
// lie behind it.
TEST(RefractedSurface, SeabedBehindTheLastRayIsHidden) {
  const Site site;
  const double g = 2, cr = 1500 + 20 * g;
  const double last_s =
      std::atanh(std::sqrt((cr - 1500) * (cr + 1500)) / cr) / g;  // to the point of the grazing ray
  const ApparentSurface surface_mesh = site.surface_mesh(seabed_gradient(g), 0.02);
  const Echo echo =
      hear(surface_mesh.refined.mesh, surface_mesh.facet_factor, {1500 * last_s + 1, 1, 100}).echo;
  const Echo before =
      hear(surface_mesh.refined.mesh, surface_mesh.facet_factor, {1500 * last_s - 12, 1, 10}).echo;
  const auto sum = [](const Echo& e) { return std::accumulate(e.energy.begin(), e.energy.end(), 0.0); };
  EXPECT_GT(sum(before), 0);
  EXPECT_LT(sum(echo), 1e-2 * sum(before));
}

TEST(RefractedSurface, TruePlacesAndAreasAreThoseOfTheSeabed) {
  const Site site;
  const ApparentSurface surface_mesh = site.surface_mesh(seabed_gradient(-0.5), 0.02);
  double area_m2 = 0;
  for (FacetId f = 0; f < surface_mesh.refined.mesh.facets.size(); ++f) {
    glm::dvec3 seen[3], centre(0);
    for (std::size_t k = 0; k < 3; ++k) {
      seen[k] =
          site.grid.to_metres(surface_mesh.refined.mesh.vertices[surface_mesh.refined.mesh.facets[f][k]]);
      centre += seen[k] / 3.0;
      EXPECT_LT(glm::distance(surface_mesh.true_place(f, seen[k], site.grid),
                              surface_mesh.truth[surface_mesh.refined.mesh.facets[f][k]]),
                1e-9);
    }
    EXPECT_NEAR(surface_mesh.true_place(f, centre, site.grid).z, -Site::below_m, 1e-9);
    area_m2 += surface_mesh.area_ratio(f, site.grid) *
               glm::length(glm::cross(seen[1] - seen[0], seen[2] - seen[0])) / 2;
  }
  EXPECT_NEAR(area_m2 / (512. * 512.), 1, 1e-12);
}

// No facet that has an apparent position in the tubes is missing.
TEST(RefractedSurface, FacetsSeenHoldAllWithAnImageInTheTubes) {
  const Site site(128, 4);
  const SceneTree tree(site.base);
  for (const double g : {-0.5, -0.05, 0.3}) {
    const WaterColumn water = seabed_gradient(g);
    const ApparentMap apparent_map(water, glm::dvec3(0), Site::apex_depth_m);
    for (const double reach_m : {40., 90.}) {
      TubeSet tubes = fan();
      tubes.reach = reach_m / site.grid.unit_m();
      const Sector sector(tubes, site.grid.unit_m());
      const std::vector<FacetId> seen =
          ViewBounds(tubes, site.grid.unit_m(), apparent_map).facets(site.base, tree, site.grid);
      std::size_t inside = 0;
      for (FacetId f = 0; f < site.base.facets.size(); ++f) {
        bool any = false;
        for (const VertexId v : site.base.facets[f]) {
          const auto image = apparent_map.apparent(site.grid.to_metres(site.base.vertices[v]));
          any = any || (image && sector.may_meet(image->at_m, 0));
        }
        inside += any;
        if (any) {
          EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), f)) << g << ' ' << f;
        }
      }
      EXPECT_GT(inside, 30u);
      EXPECT_LT(seen.size(), site.base.facets.size() / 2);
    }
  }
}

// A model that equals Lambert's law under another name gives the same energy. Another model uses its own
// angles.
TEST(RefractedSurface, OtherLawsScatterAtTrueGrazingAngles) {
  const Site site(32, 2);
  std::vector<FacetId> all(site.base.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  const WaterColumn water = seabed_gradient(-0.5);
  const ApparentMap apparent_map(water, glm::dvec3(0), Site::apex_depth_m);
  const std::vector<std::shared_ptr<const ScatteringModel>> models{std::make_shared<const ScatteringModel>(
      ScatteringModel::gsab({.oblique = 0.1, .oblique_exponent = 5}))};
  const ApparentSurface lambert = site.surface_mesh(water, 1);
  const ApparentSurface other =
      map_apparent(site.base, all, site.grid, apparent_map, 0, {.travel_path_error_m = 1}, {}, models);
  ASSERT_EQ(lambert.facet_factor.size(), other.facet_factor.size());
  for (std::size_t f = 0; f < all.size(); ++f) {
    glm::dvec3 lies(0), seen(0), corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = other.refined.mesh.facets[f][k];
      lies += other.truth[v] / 3.0;
      corner[k] = site.grid.to_metres(other.refined.mesh.vertices[v]);
      seen += corner[k] / 3.0;
    }
    const auto ray = apparent_map.apparent(lies)->ray;
    const glm::dvec3 n = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    const double sine_seen = std::abs(glm::dot(n, glm::normalize(seen)));
    // sigma is sine^5, Lambert's is sine^2: three more powers of the ratio of the sines.
    EXPECT_NEAR(other.facet_factor[f] / (lambert.facet_factor[f] * std::pow(ray.arrival_sine / sine_seen, 3)),
                1, 5e-3);
  }
}

TEST(RefractedSurface, FactorsAreReadByEveryIntegrator) {
  const Site site(64, 16);
  std::vector<double> factor(site.base.facets.size());
  for (std::size_t f = 0; f < factor.size(); ++f) factor[f] = 1 + double(f % 5);
  const Reception plain = hear(site.base, {}, {25, 5, 6}, 0.02);
  const Reception twice = hear(site.base, std::vector<double>(factor.size(), 2.0), {25, 5, 6}, 0.02, 1e-4);
  for (std::size_t k = 0; k < plain.echo.energy.size(); ++k)
    EXPECT_NEAR(twice.echo.energy[k], 2 * plain.echo.energy[k], 1e-15 * mu);
  // checks that the ordinary integral lies inside the bound
  hear(site.base, factor, {25, 5, 6}, 0.02, 1e-4);
  // A ray hit.
  const std::vector<double> material_mu{mu};
  EchoModel model{material_mu, site.base.material, 0, nullptr};
  model.path.facet_factor = factor;
  History history;
  history.hits.push_back(
      {.facet = 3, .tube = 0, .slant_range_m = 27, .sine_grazing = 0.5, .solid_angle_sr = 0.1});
  const std::vector<std::uint32_t> beams{0};
  EXPECT_NEAR(integrate_echo(history, {1, beams}, {25, 5, 6}, model).energy[0], 4 * mu * 0.5 * 0.1 / 27 / 27,
              1e-18);
  model.path.facet_factor = std::span(factor).first(2);
  EXPECT_THROW(integrate_echo(history, {1, beams}, {25, 5, 6}, model), std::invalid_argument);
}

TEST(RefractedSurface, RefusesGapsThatAreNone) {
  const Site site;
  EXPECT_THROW(site.surface_mesh(seabed_gradient(0.1), 0), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
