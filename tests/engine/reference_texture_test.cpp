// SPDX-License-Identifier: GPL-3.0-or-later
// Certified energies of a seabed with micro-texture against brute force: rules of Gauss in plane Cartesian
// coordinates between all lines and circles at which the integrand is not smooth. The reference goes round
// the foot point in rings instead, and cuts polygons beforehand.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "engine/certified_perlin.hpp"
#include "engine/reference.hpp"
#include "engine/tube_engine.hpp"
#include "geometry/facet_mesh.hpp"

namespace tubefoot {
namespace {

using Vec = glm::tvec3<long double>;
const double mu = std::pow(10, -2.7);

struct PerlinReflectivity : ReflectivityField, CertifiedPerlin {
  struct Settings {
    double wavelength_m = 0.5;
    int octaves = 1;
    double persistence = 0.5, depth = 0.25;
    std::uint64_t seed = 1;
  };
  explicit PerlinReflectivity(const Settings& s)
      : CertifiedPerlin(PerlinLattice(s.seed), s.wavelength_m, s.octaves, s.persistence, s.depth),
        set(s),
        noise(s.seed) {}
  double factor(glm::dvec3 p) const override {
    double sum = 0, weights = 0;
    for (int i = 0; i < set.octaves; ++i) {
      const glm::dvec3 x = p * std::ldexp(1 / set.wavelength_m, i);
      sum += std::pow(set.persistence, i) * noise(x.x, x.y, x.z);
      weights += std::pow(set.persistence, i);
    }
    return 1 + set.depth * sum / weights;
  }
  using CertifiedPerlin::factor;
  using CertifiedPerlin::largest;
  double largest() const override { return 2; }
  double finest_m() const override { return std::ldexp(set.wavelength_m, 1 - set.octaves); }
  Settings set;
  PerlinLattice noise;
};

/// q = at + along . place, not smooth at its integers.
struct Kinks {
  glm::dvec3 along;
  double at = 0;
};

std::vector<Kinks> kinks_of(const PerlinReflectivity::Settings& s) {
  const double per_m = std::ldexp(1.0, s.octaves - 1) / s.wavelength_m;
  return {{{per_m, 0, 0}, 0}, {{0, per_m, 0}, 0}, {{0, 0, per_m}, 0}};
}

/// What a convex polygon (corners from the apex) returns from ranges r1 to r2.
struct Oracle {
  std::vector<Vec> corners;
  glm::dvec3 apex_m{0};
  std::vector<Kinks> kinks;
  std::function<double(glm::dvec3 from_apex)> weight;
  double absorption = 0;

  long double energy(long double r1, long double r2) const {
    const Vec normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const Vec foot = normal * glm::dot(normal, corners[0]), e = glm::normalize(corners[1] - corners[0]),
              f = glm::cross(normal, e);
    const long double distance2 = glm::dot(foot, foot);
    struct Line {
      long double a, b, c;  // a s + b w + c = 0
    };
    std::vector<Line> lines;
    std::vector<long double> stops, circles;
    std::vector<std::pair<long double, long double>> points;
    for (const Vec& c : corners) points.emplace_back(glm::dot(c - foot, e), glm::dot(c - foot, f));
    const std::size_t edges = points.size();
    for (std::size_t i = 0; i < edges; ++i) {
      const auto [s0, w0] = points[i];
      const auto [s1, w1] = points[(i + 1) % edges];
      lines.push_back({w0 - w1, s1 - s0, s0 * w1 - s1 * w0});
      stops.push_back(s0);
    }
    for (const Kinks& k : kinks) {
      const Vec along(k.along);
      const long double at = k.at + glm::dot(along, Vec(apex_m) + foot), a = glm::dot(along, e),
                        b = glm::dot(along, f);
      long double lo = 1e30L, hi = -1e30L;
      for (const auto& [s, w] : points) {
        lo = std::min(lo, at + a * s + b * w);
        hi = std::max(hi, at + a * s + b * w);
      }
      if (hi - lo < 1e-12L) continue;  // the facet is parallel to the planes
      for (long double n = std::ceil(lo); n <= hi; ++n) lines.push_back({a, b, at - n});
    }
    for (const long double r : {r1, r2})
      if (r * r > distance2) circles.push_back(r * r - distance2);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Line& l = lines[i];
      for (std::size_t j = 0; j < i; ++j)
        if (const long double det = l.a * lines[j].b - lines[j].a * l.b; std::abs(det) > 1e-15L)
          stops.push_back((l.b * lines[j].c - lines[j].b * l.c) / det);
      const long double n2 = l.a * l.a + l.b * l.b;
      for (const long double rho2 : circles)
        if (const long double left = rho2 * n2 - l.c * l.c; left > 0)
          for (const int side : {-1, 1})
            stops.push_back((-l.a * l.c + side * l.b * std::sqrt(left)) / n2);
    }
    for (const long double rho2 : circles) {
      stops.push_back(std::sqrt(rho2));
      stops.push_back(-std::sqrt(rho2));
    }
    std::sort(stops.begin(), stops.end());
    const auto [first, last] = std::minmax_element(points.begin(), points.end());
    const long double beta = 2 * absorption * std::numbers::ln10_v<long double> / 10;
    const auto column = [&](long double s) {
      long double lo = -1e30L, hi = 1e30L;
      std::vector<long double> cuts;
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const Line& l = lines[i];
        if (l.b == 0) continue;
        const long double w = -(l.a * s + l.c) / l.b;
        if (i >= edges)
          cuts.push_back(w);
        else if (l.b > 0)
          lo = std::max(lo, w);
        else
          hi = std::min(hi, w);
      }
      for (const long double rho2 : circles)
        if (rho2 > s * s) {
          cuts.push_back(std::sqrt(rho2 - s * s));
          cuts.push_back(-std::sqrt(rho2 - s * s));
        }
      cuts.push_back(lo);
      cuts.push_back(hi);
      std::sort(cuts.begin(), cuts.end());
      long double sum = 0;
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const long double from = cuts[k], to = cuts[k + 1], middle = (from + to) / 2;
        const long double range = std::sqrt(distance2 + s * s + middle * middle);
        if (from < lo || to > hi || range < r1 || range > r2 || !(to > from)) continue;
        sum += boost::math::quadrature::gauss<long double, 10>::integrate(
            [&](long double w) {
              const Vec p = foot + s * e + w * f;
              const long double r = std::sqrt(distance2 + s * s + w * w);
              return distance2 * std::pow(r, -6.0L) * std::exp(-beta * r) *
                     (long double)(weight(glm::dvec3(p)));
            },
            from, to);
      }
      return sum;
    };
    long double sum = 0;
    for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
      const long double from = std::max(stops[k], first->first), to = std::min(stops[k + 1], last->first);
      if (!(to > from)) continue;
      // Roots at the ends of an interval, where a circle touches, are smooth in the angle.
      sum += boost::math::quadrature::gauss<long double, 25>::integrate(
          [&](long double angle) {
            return column((from + to) / 2 - (to - from) / 2 * std::cos(angle)) * std::sin(angle) *
                   (to - from) / 2;
          },
          0.0L, std::numbers::pi_v<long double>);
    }
    return (long double)(mu) * sum;
  }
};

/// Facets on a grid of 2^-20 m, an apex, and tubes.
struct Bench {
  Bench(const std::vector<std::array<glm::dvec3, 3>>& facets_m, glm::dvec3 apex)
      : grid(20, glm::dvec3(0)), apex_m(grid.to_metres(grid.snap(apex))) {
    MeshBuilder builder(grid);
    for (const auto& facet : facets_m)
      builder.add({facet.begin(), facet.end()}, {{std::array<std::uint32_t, 3>{0, 1, 2}}}, 0, 0);
    MeshReport report;
    mesh = builder.finish(report);
    tree = std::make_unique<SceneTree>(mesh);
  }

  TubeSet tube(const std::array<glm::dvec3, 4>& corners, double reach_m) const {
    TubeSet set;
    set.apex = grid.snap(apex_m);
    set.reach = reach_m / grid.unit_m();
    Tube tube;
    for (int k = 0; k < 4; ++k) {
      tube[k] = std::uint32_t(k);
      set.rays.push_back(integer_ray(glm::normalize(corners[k])));
    }
    if (glm::dot(glm::cross(corners[0], corners[1]), corners[2]) < 0) std::swap(tube[1], tube[3]);
    set.tubes.push_back(tube);
    return set;
  }

  struct Result {
    Echo ordinary;
    CertifiedEcho certified;
    double energy(int k) const { return certified.echo.energy[k]; }
    double bound(int k) const { return certified.bound[k]; }
  };
  Result run(const TubeSet& set, const RangeSamples& samples, double absorption, double tolerance,
             const std::shared_ptr<const ReflectivityField>& texture,
             const BeamPatterns* patterns = nullptr) const {
    const std::vector<double> material_mu{mu};
    EchoLaw law{material_mu, mesh.material, absorption, patterns};
    const std::vector fields{texture};
    law.reflectivity = fields;
    law.apex_m = apex_m;
    const VisibilityOptions options;
    const std::vector<std::uint32_t> beam{0};
    const History history = TubeEngine(mesh, *tree, grid.unit_m(), options).trace(set);
    Result result{integrate_echo(history, beam, 1, samples, law), {}};
    result.certified =
        certify_echo(mesh, *tree, history, options, beam, samples, law, result.ordinary, tolerance);
    return result;
  }

  /// What of the tube's rays' plane section lies on the first facet, if that is all of it.
  std::vector<Vec> section(const TubeSet& set) const {
    const auto corner = [&](int i) {
      return Vec(grid.to_metres(mesh.vertices[mesh.facets[0][i]])) - Vec(apex_m);
    };
    const Vec normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    std::vector<Vec> corners;
    for (int k = 0; k < 4; ++k) {
      const GridPoint g = set.rays[set.tubes[0][k]];
      const Vec ray(g.x, g.y, g.z);
      corners.push_back(ray * (glm::dot(normal, corner(0)) / glm::dot(normal, ray)));
    }
    return corners;
  }

  WorldGrid grid;
  glm::dvec3 apex_m;
  FacetMesh mesh;
  std::unique_ptr<SceneTree> tree;
};

std::array<glm::dvec3, 4> pyramid(glm::dvec3 axis, glm::dvec3 a, glm::dvec3 b) {
  return {axis - a - b, axis + a - b, axis + a + b, axis - a + b};
}

TEST(ReferenceTexture, BoundHoldsOnTiltedFacetsForAnyTexture) {
  const unsigned seed = 20251;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 12; ++trial) {
    const glm::dvec3 apex(20 * unit(random), 20 * unit(random), 5 * unit(random));
    const glm::dvec3 axis(1 + 0.5 * unit(random), 0.5 * unit(random), -1 + 0.4 * unit(random));
    const glm::dvec3 hit = apex + (4 + 2 * unit(random)) * axis;
    const glm::dvec3 tilt(0.5 * unit(random), 0.5 * unit(random), 1);
    const glm::dvec3 p = glm::normalize(glm::cross(tilt, glm::dvec3(1, 0.3, 0))), q = glm::cross(tilt, p);
    const Bench bed({{hit - 40.0 * p - 30.0 * q, hit + 40.0 * p - 30.0 * q, hit + 50.0 * q}}, apex);
    const TubeSet set = bed.tube(pyramid(axis, {0.03, 0.03 * unit(random), 0.05}, {0, 0.06, 0}), 40);
    const std::vector<Vec> corners = bed.section(set);
    long double near = 1e9L, far = 0;
    for (const Vec& c : corners) {
      near = std::min(near, glm::length(c));
      far = std::max(far, glm::length(c));
    }
    const PerlinReflectivity::Settings settings{0.2 + 0.4 * (1 + unit(random)), 1 + trial % 3, 0.6,
                                                0.25 + 0.05 * (trial % 4), std::uint64_t(trial)};
    const auto texture = std::make_shared<const PerlinReflectivity>(settings);
    const double step = double(far - near) / 3.5, absorption = trial % 2 * 0.3;
    const double tolerance = trial % 3 == 0 ? 1e-3 : trial % 3 == 1 ? 1e-6 : 1e-9;
    const auto result = bed.run(set, {double(near) - step / 4, step, 4}, absorption, tolerance, texture);
    EXPECT_EQ(result.certified.bins_over, 0u) << trial;
    const Oracle oracle{corners, bed.apex_m, kinks_of(settings),
                        [&](glm::dvec3 d) { return texture->factor(bed.apex_m + d); }, absorption};
    for (int k = 0; k < 4; ++k) {
      const double r1 = double(near) - step / 4 + step * k;
      const double truth = double(oracle.energy(r1, r1 + step));
      printf("%d %d %g %g bound %g err %g\n", trial, k, truth, result.energy(k) / result.ordinary.energy[k], result.bound(k) / truth,
             (result.energy(k) - truth) / truth);
      EXPECT_LE(std::abs(result.energy(k) - truth), result.bound(k) + 1e-12 * truth) << trial << " " << k;
      EXPECT_LE(result.bound(k), tolerance * result.energy(k)) << trial << " " << k;
    }
  }
}

}  // namespace
}  // namespace tubefoot
