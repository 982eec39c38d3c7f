// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the random field of scatterers on surfaces: variance per area, independence of facets and layers,
// scatterer density, and the intensity statistics of textures.

#include "engine/signal/surface_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <iostream>
#include <map>
#include <random>
#include <vector>

#include "engine/signal/smooth_pieces.hpp"
#include "fixtures/statistics.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using Places = std::map<std::array<double, 3>, Complex>;

Places places_of(const SurfaceField& field, const std::vector<glm::dvec3>& corners, glm::dvec3 normal) {
  Places all;
  field.for_scatterers(corners, normal, [&](glm::dvec3 p, Complex z) {
    EXPECT_TRUE(all.insert({{p.x, p.y, p.z}, z}).second);
  });
  return all;
}

struct Plate {
  const char* name;
  glm::dvec3 corner, u, v;
  std::vector<glm::dvec3> corners() const { return {corner, corner + u, corner + u + v, corner + v}; }
  glm::dvec3 normal() const { return glm::normalize(glm::cross(u, v)); }
  double area() const { return glm::length(glm::cross(u, v)); }
};

const std::vector<Plate> plates{
    {"flat", {0.31, 0.2, -3}, {1.1, 0.13, 0}, {-0.2, 1, 0}},
    {"a slope of 30 degrees", {0.31, 0.2, -3}, {1.1, 0, 0}, {0, 1, std::sqrt(1.0 / 3)}},
    {"the steepest slope by plan", {-0.3, 0.2, -3}, {1.1, 0, 1.1}, {0.3, 1, 1}},
    {"a wall", {0.31, 0.2, -3}, {1.1, 0.4, 0}, {0, 0, 1}},
    {"a wall along y", {0.31, 0.2, -3}, {0, 1, 0}, {0, 0.1, 1.2}},
    {"an overhang", {0.31, 0.2, -3}, {0, 1, 0}, {-1, 0, 0.5}},
};

// Law Y4.
TEST(SurfaceField, ASquareMetreHasVarianceOneOnEverySlopeAndWall) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  constexpr int draws = 4000;
  for (const Plate& plate : plates)
    for (const double spacing : {0.05, 0.3, 1.5}) {  // even where a plate has no cell of its own
      double areas = 0, square = 0, many = 0;
      Complex sum = 0, twice = 0;
      const glm::dvec3 q(14, -9, 5);
      for (int n = 0; n < draws / (spacing < 0.1 ? 4 : 1); ++n) {
        Complex y = 0;
        double own = 0;
        SurfaceField{seed + std::uint64_t(n), spacing}.for_scatterers(
            plate.corners(), plate.normal(), [&](glm::dvec3 p, Complex z) {
              y += z * std::polar(1.0, glm::dot(q, p));
              own += std::norm(z);
            });
        areas += own;
        square += own * own;
        sum += y;
        twice += y * y;
        many += std::norm(y);
      }
      const int n = draws / (spacing < 0.1 ? 4 : 1);
      const double error = std::sqrt((square / n - areas / n * areas / n) / n);
      EXPECT_NEAR(areas / n, plate.area(), 5 * error) << plate.name << ' ' << spacing;
      const double per_draw = std::sqrt(2.0 / n) * (1 + 2 * spacing);
      EXPECT_NEAR(many / n / plate.area(), 1, 5 * per_draw) << plate.name << ' ' << spacing;
      // The field is circular: the mean and E[y y] are zero.
      EXPECT_LT(std::abs(sum) / n, 5 * std::sqrt(plate.area() / n)) << plate.name;
      EXPECT_LT(std::abs(twice) / n, 7 * plate.area() * per_draw) << plate.name;
    }
}

// Law Y5.
TEST(SurfaceField, DoesNotDependOnFacetsOrOnWhoCutsThem) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> share(0.2, 0.8);
  for (const Plate& plate : plates) {
    const SurfaceField field{5, 0.03};
    const Places whole = places_of(field, plate.corners(), plate.normal());
    ASSERT_GT(whole.size(), 500u);
    EXPECT_EQ(whole, places_of(field, plate.corners(), plate.normal()));
    // The opposite orientation, from the other side, has the same scatterers.
    auto reversed = plate.corners();
    std::reverse(reversed.begin(), reversed.end());
    EXPECT_EQ(whole.size(), places_of(field, reversed, -plate.normal()).size());
    // Four triangles about a point within.
    const glm::dvec3 middle = plate.corner + share(random) * plate.u + share(random) * plate.v;
    Places parts;
    const auto corners = plate.corners();
    for (std::size_t k = 0; k < 4; ++k)
      for (const auto& [place, z] :
           places_of(field, {corners[k], corners[(k + 1) % 4], middle}, plate.normal()))
        EXPECT_TRUE(parts.insert({place, z}).second) << "twice on an edge";
    ASSERT_EQ(parts.size(), whole.size()) << plate.name;
    for (auto a = whole.cbegin(), b = parts.cbegin(); a != whole.end(); ++a, ++b) {
      for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_NEAR(a->first[axis], b->first[axis], 1e-13);
      ASSERT_EQ(a->second, b->second) << plate.name;
    }
  }
}

TEST(SurfaceField, LayersAndSeedsAreStrangers) {
  const SurfaceField field{5, 0.05};
  const Plate& low = plates[0];
  Plate high = low;
  high.corner.z += 0.5;
  const Places below = places_of(field, low.corners(), low.normal()),
               above = places_of(field, high.corners(), high.normal());
  ASSERT_EQ(below.size(), above.size());
  Complex product = 0;
  double power = 0;
  for (auto a = below.cbegin(), b = above.cbegin(); a != below.end(); ++a, ++b) {
    product += a->second * std::conj(b->second);
    power += std::norm(a->second);
  }
  EXPECT_LT(std::abs(product) / power, 5 / std::sqrt(double(below.size())));
  EXPECT_NE(places_of({6, 0.05}, low.corners(), low.normal()).begin()->second, below.begin()->second);
}

TEST(SurfaceField, DensityIsWhatTheSheetAsksFor) {
  const double b = 20e3, wavelength = 0.02, c = 1500, look = 0.5;
  const double spacing = surface_spacing_m(b, wavelength, c, look);
  const double per_m2 = 2 * b / c * (2 * look / wavelength);
  for (const Plate& plate : plates) {
    const double count = double(places_of({1, spacing}, plate.corners(), plate.normal()).size());
    EXPECT_GT(count / plate.area(), 0.9 * per_m2) << plate.name;
    EXPECT_LT(count / plate.area(), 2 * per_m2) << plate.name;
  }
  EXPECT_THROW(surface_spacing_m(0, 1, 1, 1), std::invalid_argument);
}

// In a resolution cell within one cell of texture, E[I^2] / E[I]^2 = 2 (1 + 1 / shape) with the moments of
// the texture. In a cell that contains many texture cells the value is less.
TEST(SurfaceField, TexturesHaveTheirMoments) {
  const std::uint64_t seed = 31;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const SurfaceTexture texture :
       {SurfaceTexture::none, SurfaceTexture::gamma, SurfaceTexture::log_normal})
    for (const double shape : {2.0, 5.0}) {
      std::vector<double> factors, intensities;
      constexpr int draws = 6000;
      for (int n = 0; n < draws; ++n) {
        const SurfaceField field{seed + std::uint64_t(n) * 7919, 0.02, texture, shape, 10};
        factors.push_back(field.texture_at({1, 2, 3}));
        Complex y = 0;
        field.for_scatterers(std::vector<glm::dvec3>{{1, 1, -3}, {1.1, 1, -3}, {1.1, 1.1, -3}, {1, 1.1, -3}},
                             {0, 0, 1}, [&](glm::dvec3, Complex z) { y += z; });
        intensities.push_back(std::norm(y));
      }
      const double variance = texture == SurfaceTexture::none ? 0 : 1 / shape;
      EXPECT_NEAR(statistics::mean(factors), 1, 5 * std::sqrt(variance / draws) + 1e-15);
      EXPECT_NEAR(statistics::variance(factors), variance, 0.25 * variance + 1e-15);
      // 25 cells: random positions alone make 1 / 25 of it or less.
      EXPECT_NEAR(statistics::scintillation(intensities), 2 * (1 + variance), 0.35)
          << int(texture) << ' ' << shape;
      EXPECT_NEAR(statistics::mean(intensities), 0.01, 0.01 * 5 * std::sqrt((1 + 2 * variance) / draws));
    }
}

// Tests distributions in addition to moments: intensities over their mean are exponential or K-distributed,
// by Kolmogorov's distance. P(I > x) = 2 / Gamma(nu) (nu x)^(nu/2) K_nu(2 sqrt(nu x)).
TEST(SurfaceField, GammaTexturesMakeIntensitiesOfTheKLaw) {
  const std::uint64_t seed = 5000;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const std::vector<glm::dvec3> square{{1, 1, -3}, {1.1, 1, -3}, {1.1, 1.1, -3}, {1, 1.1, -3}};  // 25 cells
  constexpr int draws = 8000;
  const auto distance = [&](SurfaceTexture texture, double shape, const auto& above) {
    std::vector<double> drawn;
    for (int n = 0; n < draws; ++n) {
      Complex y = 0;
      SurfaceField{seed + std::uint64_t(n) * 104729, 0.02, texture, shape, 10}.for_scatterers(
          square, {0, 0, 1}, [&](glm::dvec3, Complex z) { y += z; });
      drawn.push_back(std::norm(y) / 0.01);
    }
    std::sort(drawn.begin(), drawn.end());
    double most = 0;
    for (int n = 0; n < draws; ++n)
      most = std::max(most, std::abs(1 - above(drawn[std::size_t(n)]) - (n + 0.5) / draws));
    return most * std::sqrt(double(draws));
  };
  constexpr double one_in_a_thousand = 1.95;
  const auto exponential = [](double x) { return std::exp(-x); };
  EXPECT_LT(distance(SurfaceTexture::none, 1, exponential), one_in_a_thousand);
  for (const double nu : {0.5, 1.0, 4.0}) {
    const auto k_model = [nu](double x) {
      const double root = std::sqrt(nu * x);
      return 2 / std::tgamma(nu) * std::pow(root, nu) * boost::math::cyl_bessel_k(nu, 2 * root);
    };
    EXPECT_LT(distance(SurfaceTexture::gamma, nu, k_model), one_in_a_thousand) << nu;
    EXPECT_GT(distance(SurfaceTexture::gamma, nu, exponential), 2 * one_in_a_thousand) << nu;
  }
}

// E[I^2] / E[I]^2 of N scatterers of equal strength is 2 - 1/N. The scatterers of the field have circular
// amplitudes, so that the value is 2 for any number.
TEST(SurfaceField, FewScatterersAreAsManyForTheSecondMoment) {
  const std::uint64_t seed = 77;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  constexpr int draws = 20000;
  for (const int side : {1, 2, 3}) {
    const double n = side * side;
    const std::vector<glm::dvec3> corners{
        {0, 0, -3}, {0.1 * side, 0, -3}, {0.1 * side, 0.1 * side, -3}, {0, 0.1 * side, -3}};
    std::vector<double> own, even;
    for (int draw = 0; draw < draws; ++draw) {
      Complex sum = 0, of_one_strength = 0;
      int count = 0;
      SurfaceField{seed + std::uint64_t(draw), 0.1}.for_scatterers(corners, {0, 0, 1},
                                                                   [&](glm::dvec3, Complex z) {
                                                                     sum += z;
                                                                     of_one_strength += z / std::abs(z);
                                                                     ++count;
                                                                   });
      ASSERT_EQ(count, n);
      own.push_back(std::norm(sum));
      even.push_back(std::norm(of_one_strength));
    }
    EXPECT_NEAR(statistics::scintillation(own), 2, 0.15) << n;
    EXPECT_NEAR(statistics::scintillation(even), 2 - 1 / n, 0.1) << n;
  }
}

/// E[I^2] / E[I]^2 of a field at one focus: by draws of positions alone with circular Gaussian amplitudes,
/// and by draws of both.
struct FocusedSpeckle {
  double by_places, by_draws;

  FocusedSpeckle(double spacing_m, double along_m, double across_m, glm::dvec3 normal, std::uint64_t seed,
                 int draws) {
    const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); };
    const FacetPlane plane{normal, 3};
    const PlaneFrame frame(plane);
    const double reach = 3;
    std::vector<glm::dvec3> corners;
    for (const glm::dvec2 at : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      corners.push_back(-3.0 * normal + reach * (at.x * along_m * frame.u + at.y * across_m * frame.v));
    std::vector<double> means, intensities;
    for (int draw = 0; draw < draws; ++draw) {
      const SurfaceField field{seed + std::uint64_t(draw) * 7919, spacing_m};
      double mean = 0;
      Complex sum = 0;
      field.for_scatterers(corners, normal, [&](glm::dvec3 place, Complex z) {
        const glm::dvec3 off = place + 3.0 * normal;
        const double weight =
            sinc(glm::dot(off, frame.u) / along_m) * sinc(glm::dot(off, frame.v) / across_m);
        mean += weight * weight;
        sum += weight * z;
      });
      means.push_back(mean);
      intensities.push_back(std::norm(sum));
    }
    by_places = 2 * statistics::scintillation(means);
    by_draws = statistics::scintillation(intensities);
  }
};

// At the default spacing of runs, fully focused speckle has the moments of circular Gaussian signals: 2 to
// 0.02. This holds on level seabeds and on slopes, for square cells and for long ones.
TEST(SurfaceField, DefaultSpacingHasTheSecondMomentOfSpeckle) {
  const std::uint64_t seed = 20261127;
  std::cout << "seed " << seed << '\n';
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const double wavelength = 0.025, c = 1500, look = 60 * pi / 180, across = wavelength / (2 * look);
  const int draws = 1000, many = 10000;
  for (const double ratio : {0.5, 1.0, 6.0})
    for (const glm::dvec3 normal : {glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(0.2, -0.3, 1)),
                                    glm::normalize(glm::dvec3(0.99, 0.97, 1))}) {
      const double along = ratio * across, spacing = speckle_spacing_m(c / (2 * along), wavelength, c, look);
      const FocusedSpeckle speckle(spacing, along, across, normal, seed, draws);
      EXPECT_NEAR(speckle.by_places, 2, 0.02) << ratio << ' ' << normal.z;
    }
  const FocusedSpeckle drawn(speckle_spacing_m(c / (2 * across), wavelength, c, look), across, across,
                             {0, 0, 1}, seed, many);
  // Four standard errors of 2 / sqrt(draws).
  EXPECT_NEAR(drawn.by_draws, 2, 0.02 + 8 / std::sqrt(many));
  // The density that follows from whiteness alone is too low.
  const FocusedSpeckle white(surface_spacing_m(c / (2 * across), wavelength, c, look), across, across,
                             {0, 0, 1}, seed, draws);
  EXPECT_GT(white.by_places, 2.08);
  EXPECT_THROW(speckle_spacing_m(0, 1, 1, 1), std::invalid_argument);
}

TEST(SurfaceField, RefusesWhatIsNone) {
  EXPECT_THROW(check(SurfaceField{1, 0}), std::invalid_argument);
  EXPECT_THROW(check(SurfaceField{1, HUGE_VAL}), std::invalid_argument);
  EXPECT_THROW(check(SurfaceField{1, 1, SurfaceTexture::gamma, 0}), std::invalid_argument);
  EXPECT_THROW(check(SurfaceField{1, 1, SurfaceTexture::log_normal, 1, -1}), std::invalid_argument);
  EXPECT_THROW(check_reach(SurfaceField{1, 1e-6}, {3000, 0, 0}), std::invalid_argument);
  EXPECT_NO_THROW(check_reach(SurfaceField{1, 1e-3}, {3000, 0, 0}));
}

}  // namespace
}  // namespace tubefoot
