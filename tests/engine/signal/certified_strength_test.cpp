// SPDX-License-Identifier: GPL-3.0-or-later
// Compares backscattering lengths in ball arithmetic with values in 50 digits. The comparison is Gordon's
// sum over the edges of visible polygons that need no engine: convex bodies, and a plate before another.
#include "engine/signal/certified_strength.hpp"

#include <gtest/gtest.h>

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "engine/signal/target_strength.hpp"
#include "scene/meshes/primitives.hpp"

namespace tubefoot {
namespace {

using Real50 = boost::multiprecision::cpp_bin_float_50;
constexpr double strength_sound_speed = 1500;

struct Complex50 {
  Real50 re = 0, im = 0;
  friend Complex50 operator+(const Complex50& a, const Complex50& b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex50 operator-(const Complex50& a, const Complex50& b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex50 operator*(const Complex50& a, const Complex50& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend Complex50 operator/(const Complex50& a, const Complex50& b) {
    const Real50 size = b.re * b.re + b.im * b.im;
    return {(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
  }
};
Complex50 turned(const Real50& phase) { return {cos(phase), sin(phase)}; }

struct Point {
  Real50 x, y, z;
};
using Polygon = std::vector<Point>;

/// Unit vectors to the right, upwards and towards the sonar.
struct View {
  Point u, v, w;
  View(double azimuth_deg, double elevation_deg) {
    const Real50 degree = boost::math::constants::pi<Real50>() / 180;
    const Real50 a = Real50(azimuth_deg) * degree, e = Real50(elevation_deg) * degree;
    w = {cos(e) * cos(a), cos(e) * sin(a), sin(e)};
    u = {-sin(a), cos(a), 0};
    v = {-sin(e) * cos(a), -sin(e) * sin(a), cos(e)};
  }
  Point of(glm::dvec3 p) const {
    const auto along = [&](const Point& e) {
      return e.x * Real50(p.x) + e.y * Real50(p.y) + e.z * Real50(p.z);
    };
    return {along(u), along(v), along(w)};
  }
};

Real50 cross(const Point& o, const Point& a, const Point& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

/// Heights over the plane perpendicular to the line of sight: z = c + x gx + y gy. There is none for a
/// facet that is seen edge-on.
struct Plane {
  Real50 c = 0, gx = 0, gy = 0;
  explicit Plane(const Polygon& p) {
    const Real50 twice = cross(p[0], p[1], p[2]);
    const Real50 x1 = p[1].x - p[0].x, y1 = p[1].y - p[0].y, z1 = p[1].z - p[0].z;
    const Real50 x2 = p[2].x - p[0].x, y2 = p[2].y - p[0].y, z2 = p[2].z - p[0].z;
    gx = (z1 * y2 - z2 * y1) / twice;
    gy = (x1 * z2 - x2 * z1) / twice;
    c = p[0].z - gx * p[0].x - gy * p[0].y;
  }
  Real50 at(const Point& p) const { return c + gx * p.x + gy * p.y; }
};

/// Integral of e^{-2ikz} over a polygon perpendicular to the line of sight, with z on the plane; positive
/// counter-clockwise.
Complex50 integral(const Polygon& p, const Plane& plane, const Real50& k) {
  const Real50 qx = -2 * k * plane.gx, qy = -2 * k * plane.gy, square = qx * qx + qy * qy;
  const std::size_t n = p.size();
  Complex50 sum;
  if (square < 1e-24) {
    Real50 twice = 0;
    for (std::size_t j = 1; j + 1 < n; ++j) twice += cross(p[0], p[j], p[j + 1]);
    return Complex50{twice / 2} * turned(-2 * k * plane.at(p[0]));
  }
  for (std::size_t j = 0; j < n; ++j) {
    const Point &a = p[j], &b = p[(j + 1) % n];
    const Real50 ex = b.x - a.x, ey = b.y - a.y, half = (qx * ex + qy * ey) / 2;
    const Real50 sinc = half == 0 ? Real50(1) : Real50(sin(half) / half);
    const Complex50 middle = turned(-k * (plane.at(a) + plane.at(b)));
    sum = sum + Complex50{(qx * ey - qy * ex) * sinc} * middle;
  }
  return sum * Complex50{0, -1 / square};
}

/// Returns the intersection of two convex polygons, both counter-clockwise.
Polygon common(Polygon p, const Polygon& other) {
  for (std::size_t j = 0; j < other.size(); ++j) {
    const Point &a = other[j], &b = other[(j + 1) % other.size()];
    Polygon kept;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Point &from = p[i], &to = p[(i + 1) % p.size()];
      const Real50 in = cross(a, b, from), out = cross(a, b, to);
      if (in >= 0) kept.push_back(from);
      if ((in > 0 && out < 0) || (in < 0 && out > 0)) {
        const Real50 t = in / (in - out);
        kept.push_back({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), 0});
      }
    }
    p = kept;
  }
  return p;
}

Complex50 factor_50(const SmoothSurface& surface, const Real50& sine, const Real50& k) {
  Complex50 mirror{surface.reflection.real(), surface.reflection.imag()};
  if (surface.fluid) {
    const Complex50 slowness{Real50(1) / Real50(surface.fluid->speed_ratio),
                             Real50(surface.fluid->loss) / Real50(surface.fluid->speed_ratio)};
    const Complex50 z = slowness * slowness - Complex50{1 - sine * sine};
    const Real50 size = sqrt(z.re * z.re + z.im * z.im);
    const Complex50 p{sqrt((size + z.re) / 2), sqrt((size - z.re) / 2)};
    const Complex50 across{Real50(surface.fluid->density_ratio) * sine};
    mirror = (across - p) / (across + p);
  }
  const Real50 change = 2 * k * sine * Real50(surface.roughness_m);
  return mirror * Complex50{exp(-change * change / 2)};
}

Real50 wave_number(double hertz) {
  return 2 * boost::math::constants::pi<Real50>() * Real50(hertz) / Real50(strength_sound_speed);
}
Complex50 length_of(const Complex50& silhouette, const Real50& k) {
  return silhouette * Complex50{0, -k / (2 * boost::math::constants::pi<Real50>())};
}

/// Computes the length of a closed convex body whose facets are counter-clockwise about their outward
/// normals. With `sheet` it is one open surface that is visible from both sides.
Complex50 convex_50(const ComponentMesh& mesh, bool sheet, const View& view, const SmoothSurface& surface,
                    double hertz) {
  const Real50 k = wave_number(hertz);
  Complex50 sum;
  for (const auto& t : mesh.triangles) {
    Polygon p{view.of(mesh.points_m[t[0]]), view.of(mesh.points_m[t[1]]), view.of(mesh.points_m[t[2]])};
    Real50 twice = cross(p[0], p[1], p[2]);
    if (twice == 0 || (twice < 0 && !sheet)) continue;
    if (twice < 0) std::swap(p[1], p[2]);
    const Plane plane(p);
    const Real50 sine = 1 / sqrt(1 + plane.gx * plane.gx + plane.gy * plane.gy);
    sum = sum + factor_50(surface, sine, k) * integral(p, plane, k);
  }
  return length_of(sum, k);
}

double off(const CertifiedLength& certified, const Complex50& truth) {
  const Real50 x = truth.re - Real50(certified.length_m.real()),
               y = truth.im - Real50(certified.length_m.imag());
  return static_cast<double>(Real50(sqrt(x * x + y * y)));
}

/// Share of the bound that the error uses, over all requests.
struct Use {
  int requested = 0, by_rounding_alone = 0;
  double most = 0;
};

void expect_within(const ComponentMesh& mesh, bool sheet, double azimuth, double elevation,
                   const SmoothSurface& surface, std::span<const double> hertz, Use& use) {
  const auto seen = CertifiedStrength(mesh.points_m, mesh.triangles)
                        .towards(azimuth, elevation, surface, strength_sound_speed, hertz);
  const glm::dvec3 towards = sonar_direction(azimuth, elevation);
  std::vector<double> wave_numbers;
  for (const double f : hertz) wave_numbers.push_back(2 * std::numbers::pi * f / strength_sound_speed);
  const auto ordinary = backscattering_lengths(far_view(mesh.points_m, mesh.triangles, towards),
                                               mesh.points_m, mesh.triangles, towards, surface, wave_numbers);
  const View view(azimuth, elevation);
  for (std::size_t i = 0; i < hertz.size(); ++i) {
    const CertifiedLength& c = seen.lengths[i];
    const double error = off(c, convex_50(mesh, sheet, view, surface, hertz[i]));
    ASSERT_TRUE(std::isfinite(c.bound_m));
    EXPECT_LE(error, c.bound_m) << "azimuth " << azimuth << ", elevation " << elevation << ", " << hertz[i];
    EXPECT_LE(std::abs(ordinary[i] - c.length_m), c.bound_m + 1e-15);
    EXPECT_LE(c.grid_m, c.bound_m);
    ++use.requested;
    if (error <= c.bound_m - c.grid_m) ++use.by_rounding_alone;
    use.most = std::max(use.most, error / c.bound_m);
  }
}

ComponentMesh rectangle(double a, double b) {
  ComponentMesh plate;
  plate.points_m = {{-a / 2, -b / 2, 0}, {a / 2, -b / 2, 0}, {a / 2, b / 2, 0}, {-a / 2, b / 2, 0}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  return plate;
}

ComponentMesh disc(std::uint32_t sides, double radius) {
  ComponentMesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i)
    mesh.points_m.emplace_back(radius * std::cos(2 * std::numbers::pi * i / sides),
                               radius * std::sin(2 * std::numbers::pi * i / sides), 0);
  for (std::uint32_t i = 2; i < sides; ++i) mesh.triangles.push_back({0, i - 1, i});
  return mesh;
}

/// Makes a tetrahedron of four random corners with facets that face outwards.
ComponentMesh tetrahedron(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  ComponentMesh mesh;
  for (int i = 0; i < 4; ++i) mesh.points_m.emplace_back(normal(random), normal(random), normal(random));
  const auto& p = mesh.points_m;
  if (glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) > 0)
    std::swap(mesh.points_m[1], mesh.points_m[2]);
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  return mesh;
}

const std::vector<double> ten_octaves{100, 1e3, 7e3, 30e3, 100e3, 400e3};

// Law Q10, over random and special directions of a body: along its axes, in its plane, and as close to the
// plane as doubles permit.
TEST(CertifiedStrength, HoldsConvexBodies) {
  std::mt19937_64 random(24);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::pair<double, double>> directions{{0, 90},  {0, -90},  {0, 0},    {90, 0},     {45, 0},
                                                    {0, 45},  {30, 20},  {0, 1e-7}, {17, 1e-12}, {17, -1e-3},
                                                    {180, 0}, {1e-9, 0}, {359, 0.1}};
  for (int i = 0; i < 12; ++i) directions.emplace_back(180 * unit(random), 90 * unit(random));
  Use use;
  for (const auto& [azimuth, elevation] : directions) {
    expect_within(rectangle(0.10, 0.06), true, azimuth, elevation, {}, ten_octaves, use);
    expect_within(disc(41, 0.3), true, azimuth, elevation, {}, ten_octaves, use);
    expect_within(box_facets({{0.3, 0.5, 0.2}}, {}), false, azimuth, elevation, {}, ten_octaves, use);
    expect_within(tetrahedron(random), false, azimuth, elevation, {}, ten_octaves, use);
    expect_within(sphere_facets({0.2}, 0.05, {}), false, azimuth, elevation, {}, ten_octaves, use);
  }
  EXPECT_EQ(use.requested, 25 * 5 * 6);
  // The bound comes from the grid, and the errors use some of it.
  EXPECT_LT(use.by_rounding_alone, use.requested / 3);
  EXPECT_GT(use.most, 0.02);
}

TEST(CertifiedStrength, HoldsFluidAndRoughSurfaces) {
  std::mt19937_64 random(25);
  std::uniform_real_distribution<double> unit(-1, 1);
  Use use;
  const std::vector<double> hertz{1e3, 30e3, 100e3};
  // Without loss there is total reflection. The third material differs from water only in its loss.
  for (const SmoothSurface& surface :
       {SmoothSurface{1, FluidSediment{1.9, 1.2, 0}, 0},
        SmoothSurface{1, FluidSediment{1.5, 0.95, 0.02}, 2e-3},
        SmoothSurface{1, FluidSediment{1, 1, 1e-3}, 0}, SmoothSurface{-0.7, std::nullopt, 5e-3}})
    for (int i = 0; i < 10; ++i) {
      const double azimuth = 180 * unit(random), elevation = i == 0 ? 0 : i == 1 ? 90 : 90 * unit(random);
      expect_within(box_facets({{0.3, 0.5, 0.2}}, {}), false, azimuth, elevation, surface, hertz, use);
      expect_within(tetrahedron(random), false, azimuth, elevation, surface, hertz, use);
      expect_within(rectangle(0.10, 0.06), true, azimuth, elevation, surface, hertz, use);
      if (i < 2)
        expect_within(sphere_facets({0.2}, 0.03, {}), false, azimuth, elevation, surface, hertz, use);
    }
}

// A tilted plate before another hides the plate behind it along the line of sight.
TEST(CertifiedStrength, HoldsWhatIsHidden) {
  std::mt19937_64 random(26);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hidden = 0;
  for (int n = 0; n < 60; ++n) {
    const double elevation = 90 - 25 * (1 + unit(random)), azimuth = 180 * unit(random);
    ComponentMesh mesh;
    const auto add = [&](glm::dvec3 middle, double half, double tilt) {
      const auto first = static_cast<std::uint32_t>(mesh.points_m.size());
      for (const glm::dvec2 p : {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1), glm::dvec2(-1, 1)})
        mesh.points_m.push_back(middle + glm::dvec3(half * p.x, half * p.y, tilt * half * p.x));
      // Facets are exactly planar: two triangles of four corners of a parallelogram are planar except for
      // rounding.
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    };
    add({0, 0, 0}, 0.5, 0.2 * unit(random));
    add({0.5 * unit(random), 0.5 * unit(random), 0.6}, 0.25, 0.4 * unit(random));
    const View view(azimuth, elevation);
    const auto triangle = [&](std::size_t facet) {
      Polygon p;
      for (const std::uint32_t v : mesh.triangles[facet]) p.push_back(view.of(mesh.points_m[v]));
      return p;
    };
    const std::vector<double> hertz{3e3, 50e3};
    const auto seen = CertifiedStrength(mesh.points_m, mesh.triangles)
                          .towards(azimuth, elevation, {}, strength_sound_speed, hertz);
    for (std::size_t i = 0; i < hertz.size(); ++i) {
      const Real50 k = wave_number(hertz[i]);
      Complex50 sum;
      for (std::size_t back = 0; back < 2; ++back) {
        const Polygon p = triangle(back);
        sum = sum + integral(p, Plane(p), k);
        for (std::size_t front = 2; front < 4; ++front) {
          const Polygon q = common(p, triangle(front));
          if (q.size() < 3) continue;
          ++hidden;
          sum = sum - integral(q, Plane(p), k);
        }
      }
      for (std::size_t front = 2; front < 4; ++front) {
        const Polygon p = triangle(front);
        sum = sum + integral(p, Plane(p), k);
      }
      EXPECT_LE(off(seen.lengths[i], length_of(sum, k)), seen.lengths[i].bound_m) << n;
    }
  }
  EXPECT_GT(hidden, 100);
}

// Without the contribution of the grid, the bound contains only the rounding of the corners, which is too
// small to measure.
TEST(CertifiedStrength, BoundsAreNarrow) {
  const ComponentMesh sphere = sphere_facets({1.0}, 2e-2, {});
  const std::vector<double> hertz{1e3, 10e3, 100e3};
  const auto seen =
      CertifiedStrength(sphere.points_m, sphere.triangles).towards(31, 12, {}, strength_sound_speed, hertz);
  EXPECT_NEAR(seen.silhouette_m2, std::numbers::pi, 0.1);
  for (std::size_t i = 0; i < hertz.size(); ++i) {
    const CertifiedLength& c = seen.lengths[i];
    const double k = 2 * std::numbers::pi * hertz[i] / strength_sound_speed;
    EXPECT_LT(c.bound_m - c.grid_m, 1e-12 * k * k);
    EXPECT_LT(c.bound_m, 1e-7 * k * (k + 1));
    EXPECT_GT(c.bound_m, 0);
  }
  // For a plate seen broadside only the borders move.
  const ComponentMesh plate = rectangle(2, 2);
  const auto broadside =
      CertifiedStrength(plate.points_m, plate.triangles).towards(0, 90, {}, strength_sound_speed, hertz);
  EXPECT_LT(broadside.lengths[2].bound_m, 1e-4);
  EXPECT_LT(broadside.lengths[2].bound_m / broadside.lengths[1].bound_m, 10.1);
}

// A slope converts a lateral displacement into one along the line of sight. Five degrees from the plane of
// a plate, the error far exceeds the height errors of its corners.
TEST(CertifiedStrength, SlopesCount) {
  const ComponentMesh plate = rectangle(2, 2);
  const double hertz = 400e3, k = 2 * std::numbers::pi * hertz / strength_sound_speed;
  const auto seen = CertifiedStrength(plate.points_m, plate.triangles)
                        .towards(30, 5, {}, strength_sound_speed, std::span(&hertz, 1));
  const double heights_alone = 2 * k * FarView::vertex_error * std::sqrt(2.0) * seen.silhouette_m2;
  EXPECT_GT(seen.lengths[0].grid_m, 1.5 * heights_alone * k / (2 * std::numbers::pi));
}

TEST(CertifiedStrength, DecibelsHoldTheLengthsBound) {
  const CertifiedLength length{{3, 4}, 0.5, 0};
  const double db = target_strength_db(length.length_m), bound = target_strength_bound_db(length);
  EXPECT_GE(db + bound, 20 * std::log10(5.5));
  EXPECT_NEAR(db - bound, 20 * std::log10(4.5), 1e-9);
  EXPECT_LE(db - bound, 20 * std::log10(4.5));
  EXPECT_TRUE(std::isinf(target_strength_bound_db({{3, 4}, 5, 0})));
  EXPECT_TRUE(std::isinf(target_strength_bound_db({{0, 0}, 0, 0})));
  EXPECT_TRUE(std::isinf(target_strength_bound_db({{1, 0}, std::numeric_limits<double>::infinity(), 0})));
}

TEST(CertifiedStrength, RefusesWhatHasNoAnswer) {
  const std::vector<double> hertz{1e3};
  const ComponentMesh plate = rectangle(1, 1);
  const CertifiedStrength strength(plate.points_m, plate.triangles);
  for (const double wrong :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(strength.towards(0, 0, {}, wrong, hertz), std::invalid_argument);
  const std::vector<glm::dvec3> same(3, glm::dvec3(1));
  const std::vector<std::array<std::uint32_t, 3>> one{{0, 1, 2}};
  EXPECT_THROW(CertifiedStrength(same, one).towards(0, 0, {}, strength_sound_speed, hertz),
               std::invalid_argument);
  const auto nothing = CertifiedStrength({}, {}).towards(0, 0, {}, strength_sound_speed, hertz);
  EXPECT_EQ(nothing.lengths.at(0).length_m, 0.0);
  EXPECT_EQ(nothing.lengths.at(0).bound_m, 0);
}

}  // namespace
}  // namespace tubefoot
