// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies of tubes between angles of azimuth and elevation, and their solid angles
// (physics sheet 7.1, 7.3, 7.5). The true value lies inside the certified bound.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "engine/certified/reference.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

const double seabed_mu = std::pow(10, -2.7);

/// A mesh on a grid of 2^-20 m about the apex.
struct Site {
  explicit Site(const std::vector<std::array<glm::dvec3, 3>>& facets_m)
      : mesh(test::mesh_of(facets_m)), tree(std::make_unique<SceneTree>(mesh)) {}

  /// Energy and bound of all tubes together, in one range bin.
  struct Sum {
    double energy = 0, bound = 0;
  };
  Sum run(const TubeSet& set, const RangeSamples& samples, double tolerance) const {
    const std::vector<double> material_mu{seabed_mu};
    const EchoModel model{material_mu, mesh.material, 0, nullptr};
    const std::vector<std::uint32_t> beams(set.tubes.size(), 0);
    const History history = TubeEngine(mesh, *tree, 0x1p-20, {}).trace(set);
    const Echo ordinary = integrate_echo(history, {1, beams}, samples, model);
    const CertifiedEcho certified =
        certify_echo(mesh, *tree, history, {}, beams, samples, model, ordinary, tolerance);
    EXPECT_EQ(certified.bins_over, 0u);
    Sum sum;
    for (std::size_t k = 0; k < certified.bound.size(); ++k) {
      sum.energy += certified.echo.energy[k];
      sum.bound += certified.bound[k];
    }
    return sum;
  }

  FacetMesh mesh;
  std::unique_ptr<SceneTree> tree;
};

Site seabed(double height) {
  const auto at = [&](double x, double y) { return glm::dvec3(x, y, -height); };
  return Site({{at(-512, -512), at(512, -512), at(512, 512)}, {at(-512, -512), at(512, 512), at(-512, 512)}});
}

/// Tubes between two azimuths and two depressions.
TubeSet fan(double width, int cells, double shallow, double steep) {
  AngularGrid grid;
  for (int k = 0; k <= cells; ++k) grid.azimuth_edges_rad.push_back(width * (double(k) / cells - 0.5));
  grid.elevation_edges_rad = {-steep, -shallow};
  TubeSet set;
  set.reach = 1e12;
  append_tubes(set, grid);
  return set;
}

/// Returns the energy of the convex polygon in which a tube meets the seabed, from the corner rays. In
/// polar coordinates about the foot point the integral of r^-6 rho drho is closed. One integral over the
/// azimuth remains.
double energy_through(const TubeSet& set, const Tube& tube, double height) {
  const auto corner = [&](int k) {
    const GridPoint& r = set.rays[tube[k % 4]];
    return glm::dvec2(double(r.x) / -double(r.z), double(r.y) / -double(r.z)) * height;
  };
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec2 a = corner(k), b = corner(k + 1), along = glm::normalize(b - a);
    const double p = a.x * along.y - a.y * along.x;  // of the line of the edge, from the foot point
    if (p == 0) continue;
    const auto angle = [&](glm::dvec2 q) { return std::atan(glm::dot(q, along) / p); };
    const auto density = [&](double phi) {
      const double rho = p / std::cos(phi), r2 = rho * rho + height * height;
      return (std::pow(height, -4) - 1 / (r2 * r2)) / 4;
    };
    sum +=
        boost::math::quadrature::gauss_kronrod<double, 61>::integrate(density, angle(a), angle(b), 5, 1e-15);
  }
  return seabed_mu * height * height * std::abs(sum);
}

TEST(TubeClosedForms, AzimuthElevationTubesOnASeabedAreInsideTheBound) {
  const struct {
    double height, width, shallow, steep;
  } cases[] = {{10, 1.5, 20, 25}, {10, 1.5, 60, 61}, {4, 20, 30, 70}, {2.5, 0.3, 5, 19}, {8, 90, 40, 50}};
  for (const auto& c : cases) {
    SCOPED_TRACE(testing::Message() << "height " << c.height << ", width " << c.width << ", depression "
                                    << c.shallow << " to " << c.steep);
    const Site site = seabed(c.height);
    const TubeSet set = fan(c.width * degree, 1, c.shallow * degree, c.steep * degree);
    const double truth = energy_through(set, set.tubes[0], c.height);
    // The straight walls extend farther inwards than the ring of the same depressions.
    const double near = 0.9 * c.height * std::cos(c.width / 2 * degree),
                 far = 1.1 * c.height / std::sin(c.shallow * degree);
    for (const double tolerance : {1e-6, 1e-9}) {
      const Site::Sum sum = site.run(set, {near, (far - near) / 40, 40}, tolerance);
      EXPECT_LE(std::abs(sum.energy - truth), sum.bound + 2e-12 * truth);
      EXPECT_LE(sum.bound, tolerance * sum.energy * 1.0001);
      EXPECT_GT(sum.bound, 0);
    }
    // The bound does not hold for a tube that is a millionth of a degree wider.
    const TubeSet wider = fan((c.width + 1e-6) * degree, 1, c.shallow * degree, c.steep * degree);
    EXPECT_GT(std::abs(energy_through(wider, wider.tubes[0], c.height) - truth), 1e-9 * truth);
  }
}

TEST(TubeClosedForms, NarrowTubesTendToTheRingOfTheirDepressions) {
  // E = mu H^2 dphi / 4 (R1^-4 - R2^-4) (physics sheet 7.5). The error of straight walls is proportional to
  // the square of their width.
  const double h = 10, width = 24 * degree, shallow = 20 * degree, steep = 25 * degree;
  const Site site = seabed(h);
  const double truth = seabed_mu * h * h * width / 4 *
                       (std::pow(h / std::sin(steep), -4) - std::pow(h / std::sin(shallow), -4));
  std::vector<double> error;
  for (const int cells : {2, 4, 8})
    error.push_back(
        std::abs(site.run(fan(width, cells, shallow, steep), {10, 25, 1}, 1e-9).energy / truth - 1));
  EXPECT_LT(error[0], 0.02);
  EXPECT_NEAR(error[0] / error[1], 4, 0.1);
  EXPECT_NEAR(error[1] / error[2], 4, 0.1);
}

/// Returns the solid angle between the pole and the great circle through two directions of the same
/// elevation. It is that of a spherical triangle with two sides and the angle between them.
double cap_triangle(double width, double elevation) {
  const double t = std::tan((pi / 2 - elevation) / 2);
  return 2 * std::atan2(t * t * std::sin(width), 1 + t * t * std::cos(width));
}

double solid_angle(const TubeSet& set) {
  double sum = 0;
  for (const Tube& tube : set.tubes) {
    const auto ray = [&](int k) {
      const GridPoint& r = set.rays[tube[k]];
      return glm::normalize(glm::dvec3(r.x, r.y, r.z));
    };
    for (const int k : {1, 2}) {
      const glm::dvec3 a = ray(0), b = ray(k), c = ray(k + 1);
      sum +=
          2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
    }
  }
  return sum;
}

TEST(TubeClosedForms, SolidAnglesOfAzimuthElevationTubes) {
  for (const auto& [width, low, high] : {std::tuple{1.5, 20.0, 25.0},
                                         {29.0, -7.0, 7.0},
                                         {0.3, -7.0, 7.0},
                                         {120.0, 10.0, 60.0},
                                         {40.0, -80.0, -5.0}}) {
    const TubeSet set = fan(width * degree, 1, -high * degree, -low * degree);
    const double expected =
        cap_triangle(width * degree, low * degree) - cap_triangle(width * degree, high * degree);
    EXPECT_NEAR(solid_angle(set), expected, 4e-9) << width << ' ' << low << ' ' << high;
  }
  EXPECT_NEAR(solid_angle(fan(0.3 * degree, 1, -7 * degree, 7 * degree)), .00127621278, 2e-8);
}

/// A part of the sphere about the apex, for directions near +x, in n x n quadrangles.
Site dome(double radius, double half_width, int n) {
  std::vector<std::array<glm::dvec3, 3>> facets;
  const auto at = [&](int i, int j) {
    const double y = half_width * (2.0 * i / n - 1), z = half_width * (2.0 * j / n - 1);
    return radius * glm::normalize(glm::dvec3(1, y, z));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return Site(facets);
}

TEST(TubeClosedForms, InsideASphereTheEnergyIsTheSolidAngle) {
  // At normal incidence and one range E = mu Omega / R^2. The error of facets of size s is proportional to
  // the square of s / R.
  constexpr double radius = 5;
  TubeSet pyramid;  // 29 x 14 degrees: 4 asin(sin 14.5 sin 7)
  pyramid.reach = 1e12;
  const double a = std::tan(14.5 * degree), b = std::tan(7 * degree);
  for (const auto& [y, z] : {std::pair{-a, -b}, {a, -b}, {a, b}, {-a, b}})
    pyramid.rays.push_back(integer_ray(glm::normalize(glm::dvec3(1, y, z))));
  pyramid.tubes = {{0, 1, 2, 3}};
  const double low = cap_triangle(29 * degree, -7 * degree), high = cap_triangle(29 * degree, 7 * degree);
  const struct {
    TubeSet set;
    double solid_angle;
  } cases[] = {{pyramid, 0.122073535208}, {fan(29 * degree, 1, -7 * degree, 7 * degree), low - high}};
  for (const auto& c : cases) {
    std::vector<double> error;
    double bound = 0;
    for (const int n : {8, 16, 32}) {
      const Site::Sum sum = dome(radius, 0.5, n).run(c.set, {4, 2, 1}, 1e-8);
      error.push_back(sum.energy * radius * radius / seabed_mu / c.solid_angle - 1);
      bound = sum.bound * radius * radius / seabed_mu / c.solid_angle;
    }
    EXPECT_LT(bound, 1.1e-8);
    EXPECT_NEAR(error[0] / error[1], 4, 0.8);  // the rim of the tube cuts facets at arbitrary places
    EXPECT_NEAR(error[1] / error[2], 4, 0.4);
    EXPECT_NEAR((4 * error[2] - error[1]) / 3, 0, 1e-4);  // extrapolated
  }
}

}  // namespace
}  // namespace tubefoot
