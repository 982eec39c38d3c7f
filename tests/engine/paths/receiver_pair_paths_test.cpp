// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a receiver pair that receives over mirrors. The comparisons are the image of the receiver pair,
// points with rays to both receivers, and closed forms.
#include "engine/paths/receiver_pair_paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>

#include "fixtures/world/point_sum.hpp"
#include "fixtures/world/receiver_pairs.hpp"

namespace tubefoot {
namespace {

using namespace test;

const ReceiverBaseline slanting{slanting_axis, 0.3, 40};

/// Returns the ordinary echo, and the echoes over one mirror and over two mirrors.
std::array<ReceiverPairEcho, 3> by_mirrors(const Setting& s, const ReceiverBaseline& receiver_pair) {
  const SceneTree tree(s.mesh);
  const std::size_t tubes = s.receive.tubes.size();
  const BeamPatterns patterns = even_patterns(tubes);
  ReceiverPairPathEcho paths = received_by_receiver_pair(s, receiver_pair);
  return {integrate_receiver_pair_echo(
              trace_receiver_pair(s.mesh, tree, unit, {}, s.transmit, s.receive, receiver_pair),
              receiver_pair, 0, 0, s.samples, s.model(s.transmit, &patterns)),
          std::move(paths.by_order[2]), std::move(paths.by_order[3])};
}

/// The sonar is 1.5 m below the surface and 2.5 m above a seabed. A tilted plate before it reflects and
/// scatters.
Setting before_a_plate(int order) {
  Setting s;
  s.mesh = square_seabed(-4, 3);
  add_quad(s.mesh, {2, -1.5, -3.5}, {2, 1.5, -3.6}, {2.6, 1.5, -1}, {2.6, -1.5, -0.9}, 1);
  s.transmit = s.receive = around({0, 0, -1.5}, -89.9, 89.9, 4, 24);
  s.samples = {1, 0.25, 44};
  s.mu = {0.1, 0.05};
  s.reflection = {0, 0.6};
  s.paths.order = order;
  s.paths.cutoff_db = 300;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0};
  s.absorption_db_per_m = 0.05;
  return s;
}

/// Traces direct legs between points, and legs over mirrors, by rays.
class Rays {
 public:
  explicit Rays(const FacetMesh& mesh) {
    for (const auto& f : mesh.facets)
      facets_.push_back(
          {metres(mesh.vertices[f[0]]), metres(mesh.vertices[f[1]]), metres(mesh.vertices[f[2]])});
  }
  /// A mirror: the surface (none), or the facets in the plane of a given facet.
  using Mirror = std::optional<std::size_t>;

  struct Ray {
    double length;
    glm::dvec3 arrives;  // direction at the point
  };
  std::optional<Ray> way(glm::dvec3 apex, const std::vector<Mirror>& chain, glm::dvec3 point) const {
    std::vector<glm::dvec3> images{apex};
    for (const Mirror& mirror : chain) images.push_back(reflected(images.back(), mirror));
    const Ray way{glm::distance(images.back(), point), glm::normalize(point - images.back())};
    glm::dvec3 to = point;
    for (std::size_t k = chain.size(); k-- > 0;) {
      const auto [normal, offset] = plane(chain[k]);
      const double here = glm::dot(normal, to) - offset, there = glm::dot(normal, images[k + 1]) - offset;
      if (!(here * there < 0) || std::abs(here) < 1e-5) return std::nullopt;  // not in the mirror itself
      const glm::dvec3 met = to + here / (here - there) * (images[k + 1] - to);
      if (chain[k] && !on_mirror(*chain[k], met)) return std::nullopt;
      if (blocked(met, to)) return std::nullopt;
      to = met;
    }
    if (blocked(apex, to)) return std::nullopt;
    return way;
  }

 private:
  struct Triangle {
    glm::dvec3 a, b, c;
  };
  std::pair<glm::dvec3, double> plane(const Mirror& mirror) const {
    if (!mirror) return {glm::dvec3(0, 0, 1), 0.0};
    const auto& [a, b, c] = facets_[*mirror];
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    return {normal, glm::dot(normal, a)};
  }
  glm::dvec3 reflected(glm::dvec3 p, const Mirror& mirror) const {
    const auto [normal, offset] = plane(mirror);
    return p - 2 * (glm::dot(normal, p) - offset) * normal;
  }
  bool on_mirror(std::size_t mirror, glm::dvec3 p) const {
    const auto normal = plane(mirror).first;
    for (std::size_t f = 0; f < facets_.size(); ++f)
      if (std::abs(glm::dot(plane(f).first, normal)) > 1 - 1e-9 && inside(facets_[f], normal, p) &&
          std::abs(glm::dot(normal, facets_[f].a - p)) < 1e-5)
        return true;
    return false;
  }
  static bool inside(const Triangle& t, glm::dvec3 normal, glm::dvec3 p) {
    const double u = glm::dot(glm::cross(t.b - t.a, p - t.a), normal),
                 v = glm::dot(glm::cross(t.c - t.b, p - t.b), normal),
                 w = glm::dot(glm::cross(t.a - t.c, p - t.c), normal);
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
  }
  bool blocked(glm::dvec3 from, glm::dvec3 to) const {
    for (const Triangle& t : facets_) {
      const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
      const double here = glm::dot(normal, from - t.a), there = glm::dot(normal, to - t.a);
      if (here * there >= 0) continue;
      const double part = here / (here - there);
      if (part < 1e-6 || part > 1 - 1e-6) continue;
      if (inside(t, normal, from + part * (to - from))) return true;
    }
    return false;
  }
  std::vector<Triangle> facets_;
};

/// Sums over n^2 points per facet, by the number of mirrors.
std::array<ReceiverPairSums, 3> over_points(const Setting& s, const ReceiverBaseline& receiver_pair, int n) {
  const Rays rays(s.mesh);
  using Mirror = Rays::Mirror;
  const std::vector<std::vector<Mirror>> chains{
      {}, {Mirror()}, {Mirror(2)}, {Mirror(), Mirror(2)}, {Mirror(2), Mirror()}};
  const auto loss = [&](const std::vector<Mirror>& chain) {
    double part = 1;
    for (const Mirror& mirror : chain) part *= mirror ? s.reflection[1] : s.paths.mirrors.surface->reflection;
    return part;
  };
  const ReceiverPairSums none(s.samples);
  std::array<ReceiverPairSums, 3> sums{none, none, none};
  const glm::dvec3 half = receiver_pair.baseline_m / 2 * receiver_pair.axis, middle = metres(s.receive.apex);
  for (std::size_t f = 0; f < s.mesh.facets.size(); ++f) {
    const auto& [i, j, k] = s.mesh.facets[f];
    const glm::dvec3 a = metres(s.mesh.vertices[i]), u = (metres(s.mesh.vertices[j]) - a) / double(n),
                     v = (metres(s.mesh.vertices[k]) - a) / double(n), cross = glm::cross(u, v),
                     normal = glm::normalize(cross);
    const double strength = s.mu[s.mesh.material[f]] * glm::length(cross) / 2;
    for (int x = 0; x < n; ++x)
      for (int y = 0; x + y < n; ++y)
        for (int part = 0; part < (x + y + 1 < n ? 2 : 1); ++part) {
          const glm::dvec3 p = a + (x + (1 + part) / 3.0) * u + (y + (1 + part) / 3.0) * v;
          std::vector<std::array<std::optional<Rays::Ray>, 3>> ways;
          for (const auto& chain : chains)
            ways.push_back({rays.way(metres(s.transmit.apex), chain, p), rays.way(middle + half, chain, p),
                            rays.way(middle - half, chain, p)});
          for (std::size_t tx = 0; tx < chains.size(); ++tx)
            for (std::size_t rx = 0; rx < chains.size(); ++rx) {
              const std::size_t mirrors = chains[tx].size() + chains[rx].size();
              if (mirrors > 2 || !ways[tx][0]) continue;
              const Rays::Ray& there = *ways[tx][0];
              std::array<double, 2> energy{0, 0}, way{0, 0};
              for (std::size_t end = 0; end < 2; ++end) {
                const auto& back = ways[rx][1 + end];
                if (!back) continue;
                const double sines = glm::dot(normal, there.arrives) * glm::dot(normal, back->arrives);
                if (!(sines > 0)) continue;
                way[end] = back->length;
                energy[end] = strength * sines *
                              std::pow(10, -s.absorption_db_per_m * (there.length + back->length) / 10) /
                              std::pow(there.length * back->length, 2) * loss(chains[tx]) * loss(chains[rx]);
              }
              sums[mirrors].add(energy, there.length, way, receiver_pair.wavenumber_rad_m);
            }
        }
  }
  return sums;
}

/// Adds the unscattered arrivals at both receivers over two mirrors. They have order 2, as paths with one
/// scattering and one mirror.
void add_arrivals(const Setting& s, const ReceiverBaseline& receiver_pair, ReceiverPairSums& to) {
  const Rays rays(s.mesh);
  const glm::dvec3 half = receiver_pair.baseline_m / 2 * receiver_pair.axis, middle = metres(s.receive.apex);
  for (const std::vector<Rays::Mirror>& chain :
       {std::vector<Rays::Mirror>{{}, 2}, std::vector<Rays::Mirror>{2, {}}}) {
    std::array<std::optional<Rays::Ray>, 2> ways;
    std::array<double, 2> energy{}, length{};
    for (std::size_t end = 0; end < 2; ++end) {
      ways[end] = rays.way(metres(s.transmit.apex), chain, end == 0 ? middle + half : middle - half);
      if (!ways[end]) continue;
      length[end] = ways[end]->length;
      energy[end] = s.reflection[1] * s.paths.mirrors.surface->reflection *
                    std::pow(10, -s.absorption_db_per_m * length[end] / 10) / (length[end] * length[end]);
    }
    to.add(energy, 0, length, receiver_pair.wavenumber_rad_m);
  }
}

void expect_sums(const std::array<ReceiverPairEcho, 3>& echo, const std::array<ReceiverPairSums, 3>& sums,
                 double tolerance) {
  for (std::size_t mirrors = 0; mirrors <= 2; ++mirrors) {
    const ReceiverPairEcho& one = echo[mirrors];
    const ReceiverPairSums& expected = sums[mirrors];
    const double most = *std::ranges::max_element(expected.upper);
    EXPECT_GT(most, 0);
    for (std::size_t k = 0; k < expected.upper.size(); ++k) {
      SCOPED_TRACE(testing::Message() << mirrors << " mirrors, sample " << k);
      EXPECT_NEAR(one.upper_j[k], expected.upper[k], tolerance * most);
      EXPECT_NEAR(one.lower_j[k], expected.lower[k], tolerance * most);
      EXPECT_LT(std::abs(product(one, k) - expected.cross[k]), tolerance * most);
      EXPECT_LE(std::abs(product(one, k)), std::sqrt(one.upper_j[k] * one.lower_j[k]) * (1 + 1e-6));
    }
  }
}

TEST(ReceiverPairPaths, PointsWithRaysOverMirrorsToBothEnds) {
  for (const bool apart : {false, true}) {
    Setting s = before_a_plate(3);
    if (apart) s.receive = around({-0.4, 0.7, -1.2}, -89.9, 89.9, 4, 24);
    // All energy falls into one range bin, so that only the integrals and the visibility matter.
    s.samples = {0.5, 20, 1};
    auto sums = over_points(s, slanting, 160);
    add_arrivals(s, slanting, sums[1]);
    for (const ReceiverPairSums& one : sums)
      EXPECT_LT(std::abs(one.cross[0]), 0.9 * one.upper[0]);  // phases differ
    expect_sums(by_mirrors(s, slanting), sums, 3e-3);
  }
}

TEST(ReceiverPairPaths, EachReceiverHasItsOwnSamples) {
  for (const bool apart : {false, true}) {
    Setting s = before_a_plate(3);
    if (apart) s.receive = around({-0.4, 0.7, -1.2}, -89.9, 89.9, 4, 24);
    auto sums = over_points(s, slanting, 160);
    add_arrivals(s, slanting, sums[1]);
    expect_sums(by_mirrors(s, slanting), sums, 3e-3);
  }
}

// Both legs go over the surface: the image of the receiver pair looks down from above the water.
TEST(ReceiverPairPaths, AReceiverPairInTheSurfaceIsItsImage) {
  Setting s;
  s.mesh = square_seabed(-9, 14);
  const auto looking = [](double z, double up) {
    TubeSet set;
    set.apex = at({0, 0, z});
    set.reach = 80 / unit;
    append_tubes(set, {steps(-40, 40, 4), steps(-40, 40, 4),
                       glm::dmat3(glm::dvec3(0, 0, up), glm::dvec3(0, up, 0), glm::dvec3(1, 0, 0))});
    return set;
  };
  s.transmit = s.receive = looking(-5, 1);
  s.samples = {13.5, 0.1, 40};
  s.mu = {0.1};
  s.paths.order = 3;
  s.paths.cutoff_db = 300;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0};
  ReceiverBaseline receiver_pair = slanting;
  receiver_pair.wavenumber_rad_m = 8;
  const ReceiverPairPathEcho echo = received_by_receiver_pair(s, receiver_pair);
  ReceiverBaseline image = receiver_pair;
  image.axis.z = -image.axis.z;
  const TubeSet down = looking(5, -1);
  const SceneTree tree(s.mesh);
  const std::size_t tubes = down.tubes.size();
  const BeamPatterns patterns = even_patterns(tubes);
  const ReceiverPairEcho expected =
      integrate_receiver_pair_echo(trace_receiver_pair(s.mesh, tree, unit, {}, down, down, image), image, 0,
                                   0, s.samples, s.model(down, &patterns));
  double turned = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    const double scale = 1e-6 * (expected.upper_j[k] + expected.upper_j[k > 0 ? k - 1 : 0]) + 1e-20;
    EXPECT_NEAR(echo.by_order[3].upper_j[k], 0.49 * expected.upper_j[k], scale) << k;
    EXPECT_NEAR(echo.by_order[3].lower_j[k], 0.49 * expected.lower_j[k], scale) << k;
    EXPECT_LT(std::abs(product(echo.by_order[3], k) - 0.49 * product(expected, k)), scale) << k;
    turned = std::max(turned, std::abs(product(expected, k).imag()));
  }
  EXPECT_GT(turned, 0.02 * *std::ranges::max_element(expected.upper_j));
}

// A direct arrival from an image has the phase of its two path lengths, also for mirrors that the grid does
// not represent exactly.
TEST(ReceiverPairPaths, ArrivalsHaveThePhaseOfTheirLengths) {
  Setting s = before_a_plate(1);
  s.receive = around({0.6, -0.4, -2.2}, -89.9, 89.9, 4, 24);
  s.samples = {0.5, 0.5, 30};
  ReceiverBaseline receiver_pair = slanting;
  receiver_pair.wavenumber_rad_m = 2000;
  const ReceiverPairPathEcho echo = received_by_receiver_pair(s, receiver_pair);
  const Rays rays(s.mesh);
  const glm::dvec3 from = metres(s.transmit.apex), middle = metres(s.receive.apex),
                   half = receiver_pair.baseline_m / 2 * receiver_pair.axis;
  std::size_t met = 0;
  std::vector<double> upper(30), lower(30);
  std::vector<Complex> cross(30);
  for (const auto& mirror : {Rays::Mirror(), Rays::Mirror(2)}) {
    const auto u = rays.way(from, {mirror}, middle + half), l = rays.way(from, {mirror}, middle - half);
    if (!u || !l) continue;
    ++met;
    const auto energy = [&](const Rays::Ray& way) {
      return (mirror ? 0.6 : 0.8) * std::pow(10, -0.005 * way.length) / (way.length * way.length);
    };
    const auto sample = [&](const Rays::Ray& way) { return std::size_t((way.length / 2 - 0.5) / 0.5); };
    upper[sample(*u)] += energy(*u);
    lower[sample(*l)] += energy(*l);
    if (sample(*u) == sample(*l))
      cross[sample(*u)] += std::polar(std::sqrt(energy(*u) * energy(*l)),
                                      receiver_pair.wavenumber_rad_m * (u->length - l->length));
  }
  EXPECT_EQ(met, 2u);
  for (std::size_t k = 0; k < 30; ++k) {
    EXPECT_NEAR(echo.by_order[1].upper_j[k], upper[k], 1e-5 * upper[k]) << k;
    EXPECT_NEAR(echo.by_order[1].lower_j[k], lower[k], 1e-5 * lower[k]) << k;
    EXPECT_LT(std::abs(product(echo.by_order[1], k) - cross[k]), 5e-3 * upper[k] + 1e-20) << k;
  }
}

TEST(ReceiverPairPaths, WithoutLengthAReceiverPairIsOneReceiver) {
  Setting s = before_a_plate(3);
  s.paths.scatterings = 3;
  s.paths.patch_m = 1.5;
  s.samples = {1, 0.5, 20};
  ReceiverBaseline receiver_pair = slanting;
  receiver_pair.baseline_m = 1e-8;
  const ReceiverPairPathEcho echo = received_by_receiver_pair(s, receiver_pair);
  const PathEcho one = s.run();
  for (std::size_t order = 1; order <= 3; ++order)
    for (std::size_t k = 0; k < 20; ++k) {
      const ReceiverPairEcho& both = echo.by_order[order];
      const double scale = 1e-6 * *std::ranges::max_element(one.by_order[order].energy);
      EXPECT_NEAR(both.upper_j[k], one.by_order[order].energy[k], scale) << order << " " << k;
      EXPECT_NEAR(both.lower_j[k], one.by_order[order].energy[k], scale) << order << " " << k;
      EXPECT_LT(std::abs(product(both, k) - one.by_order[order].energy[k]), scale) << order << " " << k;
    }
}

// A seabed and a wall insonify each other: the sum is over all pairs of points of the two.
TEST(ReceiverPairPaths, TwoScatteringsAgreeWithPairsOfPoints) {
  Setting s;
  s.mesh = square_seabed(-4, 1.5);
  add_quad(s.mesh, {2, -1.5, -3.5}, {2, -1.5, -1}, {2, 1.5, -1}, {2, 1.5, -3.5}, 1);
  s.transmit = s.receive = around({-0.5, 0.2, -0.5}, -89.9, 89.9, 4, 24);
  s.samples = {2, 0.4, 15};
  s.mu = {0.1, 0.05};
  s.paths.order = s.paths.scatterings = 2;
  s.paths.patch_m = 0.4;
  s.paths.cutoff_db = 300;
  const ReceiverPairPathEcho echo = received_by_receiver_pair(s, slanting);

  const ReceiverPairSums sums = PointSum(s, 28, slanting).twice_by_receiver_pair();
  const ReceiverPairEcho& two = echo.by_order[2];
  const double most = *std::ranges::max_element(sums.upper);
  double coherent = 0;
  for (std::size_t k = 0; k < 15; ++k) {
    EXPECT_NEAR(two.upper_j[k], sums.upper[k], 0.01 * most) << k;
    EXPECT_NEAR(two.lower_j[k], sums.lower[k], 0.01 * most) << k;
    EXPECT_LT(std::abs(product(two, k) - sums.cross[k]), 0.01 * most) << k;
    coherent = std::max(coherent, std::abs(sums.cross[k]));
  }
  EXPECT_GT(coherent, 0.2 * most);
}

}  // namespace
}  // namespace tubefoot
