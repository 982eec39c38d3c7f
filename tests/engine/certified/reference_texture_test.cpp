// SPDX-License-Identifier: GPL-3.0-or-later
// Compares certified energies of a seabed with micro-texture with brute-force quadrature. The quadrature
// uses Gauss rules in plane Cartesian coordinates between all lines and circles at which the integrand is
// not smooth. The reference instead integrates over rings about the foot point and cuts polygons first.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "engine/certified/certified_perlin.hpp"
#include "engine/certified/reference.hpp"
#include "engine/scattering/layered_reflectivity.hpp"
#include "engine/scattering/map_reflectivity.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {
namespace {

using Vec = glm::tvec3<long double>;
const double texture_mu = std::pow(10, -2.7);

/// Lines on which q = at + along . place is an integer, where the integrand is not smooth.
struct Kinks {
  glm::dvec3 along;
  double at = 0;
};

std::vector<Kinks> kinks_of(const PerlinReflectivity::Settings& s) {
  const double per_m = std::ldexp(1.0, s.octaves - 1) / s.wavelength_m;
  return {{{per_m, 0, 0}, 0}, {{0, per_m, 0}, 0}, {{0, 0, per_m}, 0}};
}

/// Computes the energy of a convex polygon (corners relative to the apex) from ranges r1 to r2.
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
          for (const int side : {-1, 1}) stops.push_back((-l.a * l.c + side * l.b * std::sqrt(left)) / n2);
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
      // Square roots at the ends of an interval, where a circle is tangent, are smooth in the angle.
      sum += boost::math::quadrature::gauss<long double, 25>::integrate(
          [&](long double angle) {
            return column((from + to) / 2 - (to - from) / 2 * std::cos(angle)) * std::sin(angle) *
                   (to - from) / 2;
          },
          0.0L, std::numbers::pi_v<long double>);
    }
    return (long double)(texture_mu)*sum;
  }
};

/// Facets on a grid of 2^-20 m, an apex, and tubes.
struct TextureBench {
  TextureBench(const std::vector<std::array<glm::dvec3, 3>>& facets_m, glm::dvec3 apex)
      : grid(20, glm::dvec3(0)),
        apex_m(grid.to_metres(grid.snap(apex))),
        mesh(test::mesh_of(facets_m, grid)),
        tree(std::make_unique<SceneTree>(mesh)) {}

  TubeSet tube(const std::array<glm::dvec3, 4>& corners, double reach_m) const {
    TubeSet set;
    set.apex = grid.snap(apex_m);
    set.reach = reach_m / grid.unit_m();
    test::add_pyramid(set, corners);
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
    const std::vector<double> material_mu{texture_mu};
    EchoModel model{material_mu, mesh.material, absorption, patterns};
    const std::vector fields{texture};
    model.reflectivity = fields;
    model.path.tx.apex_m = apex_m;
    const VisibilityOptions options;
    const std::vector<std::uint32_t> beam{0};
    const History history = TubeEngine(mesh, *tree, grid.unit_m(), options).trace(set);
    Result result{integrate_echo(history, {1, beam}, samples, model), {}};
    result.certified =
        certify_echo(mesh, *tree, history, options, beam, samples, model, result.ordinary, tolerance);
    return result;
  }

  /// Section of the tube with the plane of the first facet. The facet must contain the whole section.
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

/// Range bins from before the nearest point of a polygon to beyond its farthest point.
RangeSamples samples_over(const std::vector<Vec>& corners, int count) {
  long double near = 1e9L, far = 0;
  for (const Vec& c : corners) {
    near = std::min(near, glm::length(c));
    far = std::max(far, glm::length(c));
  }
  const double step = double(far - near) / (count - 0.5);
  return {double(near) - step / 4, step, count};
}

struct Held {
  double tolerance = 1e-9, oracle = 1e-11;
};

/// The true value lies in the bound, the bound is as narrow as requested, and the ordinary echo keeps its
/// own error.
void expect_held(const TextureBench::Result& result, const RangeSamples& samples, const Oracle& oracle,
                 Held held) {
  EXPECT_EQ(result.certified.bins_over, 0u);
  double sum = 0;
  for (int k = 0; k < samples.count; ++k) {
    const double r1 = samples.first_m + samples.step_m * k;
    const double truth = double(oracle.energy(r1, samples.first_m + samples.step_m * (k + 1)));
    sum += truth;
    EXPECT_LE(std::abs(result.energy(k) - truth), result.bound(k) + held.oracle * truth) << k;
    EXPECT_LE(result.bound(k), held.tolerance * result.energy(k)) << k;
    EXPECT_GT(result.bound(k), 0) << k;
  }
  EXPECT_GT(sum, 0);
}

TEST(ReferenceTexture, BoundHoldsOnTiltedFacetsForAnyNoise) {
  const unsigned seed = 20251;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
    const glm::dvec3 apex(20 * unit(random), 20 * unit(random), 5 * unit(random));
    const glm::dvec3 axis(1 + 0.5 * unit(random), 0.5 * unit(random), -1 + 0.4 * unit(random));
    const glm::dvec3 hit = apex + (4 + 2 * unit(random)) * axis;
    const glm::dvec3 tilt(0.5 * unit(random), 0.5 * unit(random), 1);
    const glm::dvec3 p = glm::normalize(glm::cross(tilt, glm::dvec3(1, 0.3, 0))), q = glm::cross(tilt, p);
    const TextureBench seabed({{hit - 40.0 * p - 30.0 * q, hit + 40.0 * p - 30.0 * q, hit + 50.0 * q}}, apex);
    const TubeSet set = seabed.tube(pyramid(axis, {0.03, 0.03 * unit(random), 0.05}, {0, 0.06, 0}), 40);
    const PerlinReflectivity::Settings settings{0.2 + 0.4 * (1 + unit(random)), 1 + trial % 3, 0.6,
                                                0.25 + 0.05 * (trial % 4), std::uint64_t(trial)};
    const auto texture = std::make_shared<const PerlinReflectivity>(settings);
    const double absorption = trial % 2 * 0.3;
    const double tolerance = trial % 3 == 0 ? 1e-3 : trial % 3 == 1 ? 1e-6 : 1e-9;
    const Oracle oracle{seabed.section(set), seabed.apex_m, kinks_of(settings),
                        [&](glm::dvec3 d) { return texture->factor(seabed.apex_m + d); }, absorption};
    const RangeSamples samples = samples_over(oracle.corners, 4);
    const auto result = seabed.run(set, samples, absorption, tolerance, texture);
    expect_held(result, samples, oracle, {tolerance, 1e-9});
    for (int k = 0; k < samples.count; ++k)
      EXPECT_NEAR(result.ordinary.energy[k], result.energy(k), result.bound(k) + 1e-6 * result.energy(k));
  }
}

TEST(ReferenceTexture, FootCornersAndFacetMayLieInPlanesBetweenCells) {
  // The wavelength is 1. The facet lies in the plane z = -4, and its corners and the foot point lie on
  // nodes of the lattice. The cases are whole circles, arcs and empty bins.
  const TextureBench seabed({{glm::dvec3(-4, -3, -4), {5, -3, -4}, {0, 4, -4}}}, {0, 0, 0});
  const TubeSet set = seabed.tube(pyramid({0, 0, -1}, {8, 0, 0}, {0, 8, 0}), 40);
  const PerlinReflectivity::Settings settings{1, 2, 0.5, 0.9, 5};
  const auto texture = std::make_shared<const PerlinReflectivity>(settings);
  const Oracle oracle{{{-4, -3, -4}, {5, -3, -4}, {0, 4, -4}},
                      {0, 0, 0},
                      kinks_of(settings),
                      [&](glm::dvec3 d) { return texture->factor(d); },
                      0.1};
  const RangeSamples samples{4, 0.5, 6};
  expect_held(seabed.run(set, samples, 0.1, 1e-9, texture), samples, oracle, {1e-9, 1e-10});
}

Directivity texture_pattern(Directivity::Kind kind, glm::dvec3 axis, bool from_axis, double centre,
                            double size) {
  return {kind, glm::normalize(axis), from_axis, centre, size, {}};
}

TEST(ReferenceTexture, BoundHoldsWithPatterns) {
  using Kind = Directivity::Kind;
  const TextureBench seabed({{glm::dvec3(-100, -100, -8), {100, -100, -9}, {0, 150, -8.5}}}, {0.3, 0.2, 0.1});
  const glm::dvec3 axis(1, 0.2, -1);
  const TubeSet set = seabed.tube(pyramid(axis, {0.04, 0, 0.04}, {0, 0.06, 0}), 60);
  const BeamPatterns patterns{
      {TransmitPattern(std::vector{texture_pattern(Kind::line, {0, 1, 0}, false, 0.1, 9),
                                   texture_pattern(Kind::gaussian, {0, 0, 1}, false, -0.6, 0.3)})},
      {texture_pattern(Kind::piston, axis, true, 0, 12)},
      {0},
      {{0, 1}}};
  const PerlinReflectivity::Settings settings{0.6, 2, 0.5, 0.25, 11};
  const auto texture = std::make_shared<const PerlinReflectivity>(settings);
  const Oracle oracle{seabed.section(set), seabed.apex_m, kinks_of(settings),
                      [&](glm::dvec3 p) {
                        const glm::dvec3 d = glm::normalize(p);
                        return texture->factor(seabed.apex_m + p) * patterns.transmit[0].gain(d) *
                               patterns.receive[0].gain(d);
                      },
                      0.05};
  const RangeSamples samples = samples_over(oracle.corners, 3);
  const auto result = seabed.run(set, samples, 0.05, 1e-7, texture, &patterns);
  expect_held(result, samples, oracle, {1e-7, 1e-9});
  const double peak = *std::max_element(result.ordinary.energy.begin(), result.ordinary.energy.end());
  for (int k = 0; k < samples.count; ++k)
    EXPECT_NEAR(result.ordinary.energy[k], result.energy(k), result.bound(k) + 1e-5 * peak);
}

/// A map of random factors on pixels that are oblique to the axes of the frame.
std::shared_ptr<const MapReflectivity> random_map(bool tiled, glm::dvec2 first) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> unit(0, 2);
  MapReflectivity::Grid grid{7, 5, {}};
  for (int k = 0; k < 35; ++k) grid.values.push_back(unit(random));
  return std::make_shared<const MapReflectivity>(
      grid, MapReflectivity::Placing{first, {0.31, 0.07}, {-0.05, 0.29}, tiled});
}

std::vector<Kinks> kinks_of(const MapReflectivity& map) {
  const glm::dvec2 first = map.placing().first_m, c = map.to_column(), r = map.to_row();
  return {{{c, 0}, -glm::dot(c, first)}, {{r, 0}, -glm::dot(r, first)}};
}

TEST(ReferenceTexture, BoundHoldsForMapsAndProducts) {
  const TextureBench seabed({{glm::dvec3(-100, -100, -8), {100, -100, -9}, {0, 150, -8.5}}}, {0.3, 0.2, 0.1});
  const glm::dvec3 axis(1, 0.2, -1);
  const TubeSet set = seabed.tube(pyramid(axis, {0.04, 0, 0.04}, {0, 0.06, 0}), 60);
  const std::vector<Vec> corners = seabed.section(set);
  const RangeSamples samples = samples_over(corners, 3);
  // A tiled map, and a map whose border crosses the footprint.
  for (const bool tiled : {true, false}) {
    const auto map = random_map(tiled, glm::dvec2(seabed.apex_m) + glm::dvec2(corners[0]) * 1.05);
    const PerlinReflectivity::Settings settings{0.9, 1, 0.5, 0.5, 2};
    const auto noise = std::make_shared<const PerlinReflectivity>(settings);
    const auto both = std::make_shared<const LayeredReflectivity>(
        std::vector<std::shared_ptr<const ReflectivityField>>{map, noise});
    std::vector<Kinks> kinks = kinks_of(*map);
    Oracle oracle{corners, seabed.apex_m, kinks, [&](glm::dvec3 d) { return map->factor(seabed.apex_m + d); },
                  0};
    expect_held(seabed.run(set, samples, 0, 1e-8, map), samples, oracle, {1e-8, 1e-10});
    for (const Kinks& k : kinks_of(settings)) oracle.kinks.push_back(k);
    oracle.weight = [&](glm::dvec3 d) { return both->factor(seabed.apex_m + d); };
    expect_held(seabed.run(set, samples, 0, 1e-6, both), samples, oracle, {1e-6, 1e-9});
  }
}

TEST(ReferenceTexture, NoDepthIsNoTexture) {
  const TextureBench seabed({{glm::dvec3(-100, -100, -8), {100, -100, -9}, {0, 150, -8.5}}}, {0.3, 0.2, 0.1});
  const TubeSet set = seabed.tube(pyramid({1, 0.2, -1}, {0.04, 0, 0.04}, {0, 0.06, 0}), 60);
  const RangeSamples samples = samples_over(seabed.section(set), 5);
  const auto even = seabed.run(set, samples, 0.1, 1e-9, nullptr);
  const auto flat =
      seabed.run(set, samples, 0.1, 1e-9,
                 std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{0.5, 2, 0.5, 0, 1}));
  // A modulation depth far below the tolerance is enclosed as a whole. A depth of a few tolerances is
  // enclosed cell by cell.
  const auto faint = seabed.run(
      set, samples, 0.1, 1e-9,
      std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{0.5, 1, 0.5, 1e-12, 1}));
  const auto little = seabed.run(
      set, samples, 0.1, 1e-9,
      std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{0.5, 1, 0.5, 1e-8, 1}));
  for (int k = 0; k < samples.count; ++k) {
    EXPECT_EQ(flat.energy(k), even.energy(k)) << k;
    EXPECT_EQ(flat.bound(k), even.bound(k)) << k;
    EXPECT_NEAR(faint.energy(k), even.energy(k), faint.bound(k) + even.bound(k)) << k;
    EXPECT_GT(faint.bound(k), 0.9e-12 * even.energy(k));
    EXPECT_NEAR(little.energy(k), even.energy(k), little.bound(k) + even.bound(k) + 1.05e-8 * even.energy(k))
        << k;
    EXPECT_NE(little.energy(k), even.energy(k)) << k;
  }
}

TEST(ReferenceTexture, MoreCellsThanAllowedAreEnclosedByTheTexturesRange) {
  const TextureBench seabed({{glm::dvec3(-100, -100, -8), {100, -100, -9}, {0, 150, -8.5}}}, {0.3, 0.2, 0.1});
  const TubeSet set = seabed.tube(pyramid({1, 0.2, -1}, {0.04, 0, 0.04}, {0, 0.06, 0}), 60);
  const RangeSamples samples = samples_over(seabed.section(set), 3);
  const auto even = seabed.run(set, samples, 0, 1e-9, nullptr);
  // For a wavelength of micrometres over a metre, only the amplitude of the oscillation is known. The mean
  // is 1.
  std::vector<std::shared_ptr<const ReflectivityField>> fields{
      std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{5e-6, 1, 0.5, 0.25, 1})};
  const std::vector<double> material_mu{texture_mu};
  EchoModel model{material_mu, seabed.mesh.material, 0};
  model.reflectivity = fields;
  model.path.tx.apex_m = seabed.apex_m;
  const std::vector<std::uint32_t> beam{0};
  const History history = TubeEngine(seabed.mesh, *seabed.tree, seabed.grid.unit_m(), {}).trace(set);
  const CertifiedEcho certified =
      certify_echo(seabed.mesh, *seabed.tree, history, {}, beam, samples, model, even.ordinary, 1e-3);
  EXPECT_EQ(certified.bins_over, 3u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(std::abs(certified.echo.energy[k] - even.energy(k)), certified.bound[k]);
    EXPECT_GT(certified.bound[k], 0.25 * even.energy(k));
    EXPECT_LT(certified.bound[k], 0.27 * even.energy(k));
  }
}

TEST(ReferenceTexture, RefusesAFieldThatItCannotEnclose) {
  struct Other : ReflectivityField {
    double factor(glm::dvec3) const override { return 1; }
    double largest() const override { return 1; }
    double finest_m() const override { return 1; }
    std::span<const CellPlanes> cells() const override { return {}; }
    double change(double) const override { return 0; }
  };
  const auto other = std::make_shared<const Other>();
  const auto noise = std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{});
  const auto layered = std::make_shared<const LayeredReflectivity>(
      std::vector<std::shared_ptr<const ReflectivityField>>{noise, other});
  using Fields = std::vector<std::shared_ptr<const ReflectivityField>>;
  EXPECT_EQ(material_without_enclosure(Fields{nullptr, noise}), std::nullopt);
  EXPECT_EQ(material_without_enclosure(Fields{nullptr, noise, other}), 2u);
  EXPECT_EQ(material_without_enclosure(Fields{nullptr, layered, noise}), 1u);
  const TextureBench seabed({{glm::dvec3(-100, -100, -8), {100, -100, -9}, {0, 150, -8.5}}}, {0, 0, 0});
  const TubeSet set = seabed.tube(pyramid({1, 0.2, -1}, {0.04, 0, 0.04}, {0, 0.06, 0}), 60);
  try {
    seabed.run(set, {10, 1, 2}, 0, 1e-6, other);
    FAIL() << "enclosed what it knows nothing of";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("material 0"), std::string::npos) << error.what();
  }
}

/// A rectangle of complex numbers and points in it.
struct Rectangle {
  double lo, hi, across;
  ComplexBall ball() const { return {Ball::between(lo, hi), Ball::between(-across, across)}; }
};

TEST(ReferenceTexture, EnclosuresOfOneCellHoldEverywhereInIt) {
  const unsigned seed = 271828;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const PerlinReflectivity::Settings settings{0.7, 3, 0.6, 0.8, 9};
  const auto noise = std::make_shared<const PerlinReflectivity>(settings);
  const auto map = random_map(false, {0.2, 0.1});
  using Complex = std::complex<double>;
  const auto noise_at = [&](std::span<const std::int64_t> cell, std::array<Complex, 3> x) {
    Complex sum = 0;
    double weights = 0;
    for (int i = 0; i < 3; ++i) {
      const std::int64_t parts = 4 >> i;
      std::array<std::int64_t, 3> own;
      std::array<Complex, 3> at;
      for (int a = 0; a < 3; ++a) {
        own[a] = std::int64_t(std::floor(double(cell[a]) / double(parts)));
        at[a] = (double(cell[a] - own[a] * parts) + x[a]) / double(parts);
      }
      sum += std::pow(0.6, i) * noise->lattice().in_cell(own[0], own[1], own[2], at[0], at[1], at[2]);
      weights += std::pow(0.6, i);
    }
    return 1.0 + 0.8 * sum / weights;
  };
  const auto map_at = [&](std::span<const std::int64_t> cell, std::array<Complex, 3> x) {
    const auto i = double(cell[0]), j = double(cell[1]);
    return (1.0 - x[1]) * ((1.0 - x[0]) * map->value(i, j) + x[0] * map->value(i + 1, j)) +
           x[1] * ((1.0 - x[0]) * map->value(i, j + 1) + x[0] * map->value(i + 1, j + 1));
  };
  for (const bool of_map : {false, true}) {
    const std::shared_ptr<const CertifiedTexture> texture =
        of_map ? certified_texture(map) : certified_texture(noise);
    const auto value = [&](std::span<const std::int64_t> cell, const std::array<Complex, 3>& x) {
      return of_map ? map_at(cell, x) : noise_at(cell, x);
    };
    const std::size_t axes = texture->axes().size();
    double tightest = 1e9;
    for (int trial = 0; trial < 3000; ++trial) {
      std::vector<std::int64_t> cell;
      std::vector<Ball> box, beside;
      std::vector<ComplexBall> around;
      std::array<Complex, 3> inside{}, anywhere{}, outside{}, nearest{};
      const double wide = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1e-3 : 1, beyond = 2 * unit(random);
      for (std::size_t a = 0; a < axes; ++a) {
        cell.push_back(std::int64_t(12 * unit(random)) - (of_map ? 3 : 6));
        const auto c = double(cell[a]);
        const double lo = (1 - wide) * unit(random), hi = lo + wide * unit(random),
                     x = lo + (hi - lo) * unit(random);
        box.push_back(Ball(c) + Ball::between(lo, hi));
        inside[a] = x;
        const Rectangle r{x - beyond * unit(random), x + beyond * unit(random), beyond * unit(random)};
        around.push_back(ComplexBall(c) + r.ball());
        anywhere[a] = {unit(random) < 0.5 ? r.lo : r.hi, unit(random) < 0.5 ? r.across : -r.across};
        outside[a] = unit(random) < 0.5 ? -0.01 * unit(random) : 1 + 0.01 * unit(random);
        nearest[a] = std::clamp(outside[a].real(), 0.0, 1.0);
      }
      const double truth = value(cell, inside).real();
      const Ball enclosure = texture->factor(cell, box), range = texture->range();
      EXPECT_LE(enclosure.lo(), truth + 1e-14);
      EXPECT_GE(enclosure.hi(), truth - 1e-14);
      EXPECT_LE(range.lo(), truth);
      EXPECT_GE(range.hi(), truth);
      if (wide == 0) {
        EXPECT_LT(enclosure.hi() - enclosure.lo(), 1e-12);
      }
      const double largest = texture->largest(cell, around), modulus = std::abs(value(cell, anywhere));
      EXPECT_LE(modulus, largest);
      if (modulus > 0) tightest = std::min(tightest, largest / modulus);
      EXPECT_LE(std::abs(value(cell, outside) - value(cell, nearest)), texture->difference(0.01) / 2);
    }
    EXPECT_LT(tightest, 3);  // the bound is close to these values
  }
}

/// Returns whether the noise is at most `most` in a box of side `size` about p in the unit cell. The bound
/// uses the gradients at each corner along its two longest components. The function divides boxes whose
/// bound exceeds `most`.
bool noise_stays_below(double most, std::array<double, 3> p, double size, int depth) {
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<double, 3> way;
    for (int a = 0; a < 3; ++a) {
      const double u = fade(p[a]);
      weight *= (corner >> a & 1) != 0 ? u : 1 - u;
      way[a] = std::abs(p[a] - (corner >> a & 1));
    }
    std::sort(way.begin(), way.end());
    sum += weight * (way[1] + way[2]);
  }
  if (sum > most) return false;
  // |d/dp_a| <= 15/8 2 + 1: the means of both sides lie between 0 and 2, and so does their difference.
  if (sum + 3 * 4.75 * size / 2 <= most) return true;
  if (depth == 0) return false;
  for (int part = 0; part < 8; ++part) {
    std::array<double, 3> q = p;
    for (int a = 0; a < 3; ++a) q[a] += (part >> a & 1) != 0 ? size / 4 : -size / 4;
    if (!noise_stays_below(most, q, size / 2, depth - 1)) return false;
  }
  return true;
}

TEST(ReferenceTexture, NoNoiseIsLargerThanItsBound) {
  EXPECT_TRUE(noise_stays_below(CertifiedPerlin::largest_noise, {0.5, 0.5, 0.5}, 1, 14));
  EXPECT_FALSE(noise_stays_below(1.03, {0.5, 0.5, 0.5}, 1, 14));
  // The bound of the lattice is attained at one point and is never exceeded.
  const std::array<double, 3> at{0.481492208, 0.5, 0.644743299};
  EXPECT_FALSE(noise_stays_below(1.03635381, at, 0, 0));
  EXPECT_TRUE(noise_stays_below(PerlinLattice::largest, at, 0, 0));
}

}  // namespace
}  // namespace tubefoot
