// SPDX-License-Identifier: GPL-3.0-or-later
// Tests Fresnel weights at shadow borders: values of the intensity behind a half-plane, and laws of the
// cells. A screen in front of a rough seabed is compared with closed forms and with a numerical
// Fresnel-Kirchhoff integral.
#include "engine/echo/fresnel_cells.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/echo/fresnel_zones.hpp"
#include "engine/scattering/knife_edge.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Weight of equal transmit and receive legs.
double two_way_knife_edge(double nu) { return std::pow(truncated_knife_edge_intensity(nu), 2); }

double decibels(double energy) { return 10 * std::log10(energy); }

// The values are those of the formula with C and S of tables.
TEST(KnifeEdge, HasTheTwoWayLevelsOfTheFormula) {
  for (const auto& [nu, level_db] :
       {std::pair(-2.0, -1.47), {-1.217, 2.74}, {0.0, -12.04}, {1.0, -27.73}, {2.0, -38.18}}) {
    EXPECT_NEAR(2 * decibels(knife_edge_intensity(nu)), level_db, 0.005) << nu;
    EXPECT_NEAR(decibels(two_way_knife_edge(nu)), level_db, 0.005) << nu;
  }
  EXPECT_EQ(knife_edge_intensity(0), 0.25);
}

// The oracle integrates cos and sin of pi t^2 / 2 from nu to a bound, beyond which an asymptotic series
// holds.
TEST(KnifeEdge, AgreesWithQuadratureOfTheFresnelIntegrals) {
  using Rule = boost::math::quadrature::gauss<double, 30>;
  for (const double nu : {-9.7, -4.3, -1.5, -0.8, 0.3, 1.4999, 1.5001, 2.5, 4.0, 11.3}) {
    const double far = 12.5, phase = std::numbers::pi / 2 * far * far, a = 1 / (std::numbers::pi * far),
                 b = 1 / (std::numbers::pi * std::numbers::pi * far * far * far);
    // 1/2 - C and 1/2 - S at the bound, to terms of order far^-9.
    const double c = 3 / std::pow(std::numbers::pi * far, 3) / (far * far),
                 d = 15 / std::pow(std::numbers::pi * far, 4) / std::pow(far, 3);
    double cosine = -(a - c) * std::sin(phase) + (b - d) * std::cos(phase),
           sine = (a - c) * std::cos(phase) + (b - d) * std::sin(phase);
    constexpr int panels = 400;
    for (int k = 0; k < panels; ++k) {
      const double from = nu + (far - nu) * k / panels, to = nu + (far - nu) * (k + 1) / panels;
      cosine += Rule::integrate([](double t) { return std::cos(std::numbers::pi / 2 * t * t); }, from, to);
      sine += Rule::integrate([](double t) { return std::sin(std::numbers::pi / 2 * t * t); }, from, to);
    }
    const double expected = (cosine * cosine + sine * sine) / 2;
    EXPECT_NEAR(knife_edge_intensity(nu), expected, 1e-9 * expected + 1e-12) << nu;
  }
}

TEST(KnifeEdge, TableAgreesAndIsContinuousAtItsLimits) {
  for (double nu = knife_edge_lit_limit; nu < knife_edge_shadow_limit; nu += 7.3e-4) {
    const double intensity = knife_edge_intensity(nu);
    ASSERT_NEAR(two_way_knife_edge(nu), intensity * intensity, 1e-8) << nu;
  }
  EXPECT_NEAR(two_way_knife_edge(knife_edge_lit_limit + 1e-9), 1, 2e-8);
  EXPECT_EQ(two_way_knife_edge(knife_edge_lit_limit - 1e-9), 1);
  EXPECT_NEAR(decibels(two_way_knife_edge(knife_edge_shadow_limit)), -50, 0.02);
  EXPECT_EQ(two_way_knife_edge(knife_edge_shadow_limit + 1e-9), 0);
}

constexpr double seabed_below_m = 6, screen_range_m = 10, screen_top_m = -4, sector_rad = 0.004;
const double screen_mu = std::pow(10, -2.7);

/// Returns all cells as one block.
template <class Cells, class Make>
Cells all_cells(const Make& make) {
  Cells all;
  make(FresnelBlocks<Cells>{[&](const Cells& block) { all = block; }, std::size_t(-1)});
  return all;
}

/// A sonar at the origin above a seabed, and a screen across its sector. Lengths in metres.
struct ScreenScene {
  /// `top_m`: height of the screen's horizontal edge. `half_width_m`: of the screen.
  explicit ScreenScene(double top_m = screen_top_m, double half_width_m = 100, double tilt = 0) {
    const auto on_seabed = [](double x, double y) { return glm::dvec3(x, y, -seabed_below_m); };
    const auto on_screen = [&](double y, double z) { return glm::dvec3(screen_range_m, y, z + tilt * y); };
    const double low = -seabed_below_m;
    mesh = test::mesh_of(
        {{on_seabed(-200, -200), on_seabed(200, -200), on_seabed(200, 200)},
         {on_seabed(-200, -200), on_seabed(200, 200), on_seabed(-200, 200)},
         {on_screen(-half_width_m, low), on_screen(half_width_m, low), on_screen(half_width_m, top_m)},
         {on_screen(-half_width_m, low), on_screen(half_width_m, top_m), on_screen(-half_width_m, top_m)}});
    mesh.component = {0, 0, 1, 1};
    tree = std::make_unique<SceneTree>(mesh);
  }
  /// Facets and their components. Component 0 is a terrain.
  ScreenScene(const std::vector<std::array<glm::dvec3, 3>>& facets_m, std::vector<std::uint16_t> components)
      : mesh(test::mesh_of(facets_m)) {
    mesh.component = std::move(components);
    tree = std::make_unique<SceneTree>(mesh);
  }
  History history(double sector = sector_rad, int columns = 1) const {
    AngularGrid grid;
    for (int k = 0; k <= columns; ++k) grid.azimuth_edges_rad.push_back(sector * (double(k) / columns - 0.5));
    for (int k = 0; k <= 14; ++k) grid.elevation_edges_rad.push_back(-0.9 + 0.7 * k / 14);
    TubeSet set;
    set.reach = 60 * 0x1p20;
    append_tubes(set, grid);
    VisibilityOptions options;
    options.corner_names = true;
    return TubeEngine(mesh, *tree, 0x1p-20, options).trace(set);
  }
  FresnelCells cells(const History& history, double wavelength_m, double step = fresnel_cell_step) const {
    const VisibilityOptions options;
    return all_cells<FresnelCells>([&](const FresnelBlocks<FresnelCells>& blocks) {
      fresnel_cells({mesh, *tree, options, 0x1p-20, [](std::uint16_t component) { return component == 0; }},
                    history, shadow_edges(mesh, history), wavelength_m, blocks, step);
    });
  }
  std::vector<double> sharp(const History& history, const RangeSamples& samples) const {
    const std::vector<double> mu{screen_mu};
    const std::vector<std::uint32_t> beams(history.tubes.tubes.size(), 0);
    return integrate_echo(history, {1, beams}, samples, {mu, mesh.material, 0, nullptr}).energy;
  }
  /// Energies with the cells.
  std::vector<double> weighted(const History& history, const FresnelCells& cells,
                               const RangeSamples& samples) const {
    const std::vector<double> mu{screen_mu};
    const std::vector<std::uint16_t> material(cells.facet.size(), 0);
    const std::vector<std::uint32_t> beams(history.tubes.tubes.size(), 0);
    EchoModel model{mu, material, 0, nullptr};
    model.path.facet_factor = cells.factor;
    std::vector<double> energy = sharp(history, samples);
    const std::vector<double> change = integrate_echo(cells.history, {1, beams}, samples, model).energy;
    for (std::size_t k = 0; k < energy.size(); ++k) energy[k] += change[k];
    return energy;
  }

  FacetMesh mesh;
  std::unique_ptr<SceneTree> tree;
};

/// Facets of a profile in the plane y = 0, extended along y.
std::vector<std::array<glm::dvec3, 3>> extruded(const std::vector<glm::dvec2>& profile, double half_width_m) {
  std::vector<std::array<glm::dvec3, 3>> facets;
  for (std::size_t k = 1; k < profile.size(); ++k) {
    const auto at = [&](std::size_t corner, double y) {
      return glm::dvec3(profile[corner].x, y, profile[corner].y);
    };
    const double w = half_width_m;
    facets.push_back({at(k - 1, -w), at(k, -w), at(k, w)});
    facets.push_back({at(k - 1, -w), at(k, w), at(k - 1, w)});
  }
  return facets;
}

/// Weight of a place that lies on no border of a cell. It is 1 if the place is visible, plus the factors of
/// all cells that contain it.
double weight_at(const FresnelCells& cells, glm::dvec3 place, bool is_visible) {
  double weight = is_visible ? 1 : 0;
  const FootprintSet& set = cells.history.footprints;
  for (const Footprint& footprint : set.footprints) {
    const Piece& piece = set.pieces[footprint.first_piece];
    const auto corners = std::span(set.corners_m).subspan(piece.first, piece.count);
    if (std::abs(glm::dot(footprint.plane_normal, place - corners[0])) > 1e-4) continue;
    int inside = 0;
    for (std::size_t k = 0; k < corners.size(); ++k)
      inside += glm::dot(glm::cross(corners[k], corners[(k + 1) % corners.size()]), place) > 0 ? 1 : 0;
    if (inside == 0 || inside == int(corners.size())) weight += cells.factor[footprint.facet];
  }
  return weight;
}

/// Fresnel parameter of a place in the plane y = 0 behind a horizontal edge at (x, z).
double parameter_behind(glm::dvec2 edge, glm::dvec2 place, double wavelength_m) {
  const double d1 = glm::length(edge), along = glm::dot(edge, place) / d1;
  return (edge.y * place.x - edge.x * place.y) / d1 *
         std::sqrt(2 * d1 / (wavelength_m * (along - d1) * along));
}

/// Position on the seabed at a slant range relative to the edge of the screen.
struct BehindScreen {
  double d1, d2, h;
  explicit BehindScreen(double range_m) {
    const double x = std::sqrt(range_m * range_m - seabed_below_m * seabed_below_m);
    d1 = std::hypot(screen_range_m, screen_top_m);
    const glm::dvec2 along = glm::dvec2(screen_range_m, screen_top_m) / d1, place(x, -seabed_below_m);
    h = along.y * place.x - along.x * place.y;  // positive below the line through the edge
    d2 = glm::dot(along, place) - d1;
  }
  double parameter(double wavelength_m) const {
    return h * std::sqrt(2 * d1 / (wavelength_m * d2 * (d1 + d2)));
  }
};

/// One-way intensity behind the screen relative to free field, as the Fresnel-Kirchhoff integral over the
/// aperture above the edge. Path lengths are exact. A taper far from the edge ends the aperture.
double kirchhoff_intensity(const BehindScreen& at, double wavelength_m) {
  const double k = 2 * std::numbers::pi / wavelength_m, range = std::hypot(at.d1 + at.d2, at.h),
               unit = std::sqrt(wavelength_m * at.d1 * at.d2 / (2 * (at.d1 + at.d2)));
  constexpr double inner = 16, outer = 32, step = 0.005;
  const auto wave = [&](double s) {
    const double path = std::hypot(at.d1, s * unit) + std::hypot(at.d2, s * unit + at.h), far = std::abs(s);
    const double taper =
        far < inner ? 1 : std::pow(std::cos(std::numbers::pi / 2 * (far - inner) / (outer - inner)), 2);
    return std::polar(taper, k * (path - range));
  };
  const auto integral = [&](double from) {  // Simpson's rule
    const int steps = 2 * int((outer - from) / step / 2);
    const double width = (outer - from) / steps;
    std::complex<double> sum = wave(from) + wave(outer);
    for (int n = 1; n < steps; ++n) sum += (n % 2 == 1 ? 4.0 : 2.0) * wave(from + n * width);
    return sum * width / 3.0;
  };
  return std::norm(integral(0) / integral(-outer));
}

/// Energies of the seabed without a screen, with the weight of the two-way intensity.
template <class Weight>
std::vector<double> expected_of(const RangeSamples& samples, const Weight& weight) {
  std::vector<double> energy;
  for (int k = 0; k < samples.count; ++k) {
    const double from = samples.first_m + k * samples.step_m;
    energy.push_back(boost::math::quadrature::gauss<double, 7>::integrate(
        [&](double r) {
          return screen_mu * sector_rad * seabed_below_m * seabed_below_m * std::pow(r, -5) *
                 weight(BehindScreen(r));
        },
        from, from + samples.step_m));
  }
  return energy;
}

/// Range bins about the shadow border, which lies at a slant range of 16.16 m. Foot of the screen: 11.66 m.
const RangeSamples about_border{12.5, 0.05, 170};

TEST(FresnelCells, AgreeWithTheClosedFormBehindAHalfPlane) {
  const ScreenScene scene;
  const History history = scene.history();
  for (const double wavelength_m : {0.0025, 0.01}) {
    const std::vector<double> expected = expected_of(
        about_border, [&](const BehindScreen& at) { return two_way_knife_edge(at.parameter(wavelength_m)); });
    const std::vector<double> found =
        scene.weighted(history, scene.cells(history, wavelength_m), about_border);
    double sum = 0, expected_sum = 0, worst = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double from = about_border.first_m + double(k) * about_border.step_m,
                   free = screen_mu * sector_rad * seabed_below_m * seabed_below_m / 4 *
                          (std::pow(from, -4) - std::pow(from + about_border.step_m, -4));
      worst = std::max(worst, std::abs(found[k] - expected[k]) / free);
      sum += found[k];
      expected_sum += expected[k];
    }
    EXPECT_LT(worst, 0.01) << wavelength_m;
    EXPECT_NEAR(sum, expected_sum, 2e-5 * expected_sum) << wavelength_m;
    fmt::print(
        "wavelength {} m: largest error of a bin {:.2e} of the energy without screen, of the sum {:.1e}\n",
        wavelength_m, worst, sum / expected_sum - 1);
  }
}

// Errors of bins fall with the width of the cells, and those of sums with its square.
TEST(FresnelCells, ConvergeToTheClosedForm) {
  const ScreenScene scene;
  const History history = scene.history();
  constexpr double wavelength_m = 0.01;
  const std::vector<double> expected = expected_of(
      about_border, [&](const BehindScreen& at) { return two_way_knife_edge(at.parameter(wavelength_m)); });
  const auto rms = [&](double step) {
    const std::vector<double> found =
        scene.weighted(history, scene.cells(history, wavelength_m, step), about_border);
    double sum = 0;
    for (std::size_t k = 0; k < found.size(); ++k)
      if (expected[k] > 0) sum += std::pow(found[k] / expected[k] - 1, 2);
    return std::sqrt(sum / double(found.size()));
  };
  const double coarse = rms(0.16), fine = rms(0.01);
  EXPECT_LT(fine, coarse / 6);
  EXPECT_LT(fine, 2e-3);
}

TEST(FresnelCells, AgreeWithAFresnelKirchhoffIntegral) {
  const ScreenScene scene;
  const History history = scene.history();
  constexpr double wavelength_m = 0.005;
  // Bins without the truncated ends of the weights.
  const RangeSamples near_border{15, 0.05, 56};
  const std::vector<double> expected = expected_of(near_border, [&](const BehindScreen& at) {
    const double intensity = kirchhoff_intensity(at, wavelength_m);
    return intensity * intensity;
  });
  const std::vector<double> found = scene.weighted(history, scene.cells(history, wavelength_m), near_border);
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(decibels(found[k]), decibels(expected[k]), 0.15)
        << near_border.first_m + double(k) * near_border.step_m;
}

// Tubes add up: the division of the sector into tubes does not change energies.
TEST(FresnelCells, DoNotDependOnTheDivisionIntoTubes) {
  const ScreenScene scene(screen_top_m, 0.8, 0.1);
  constexpr double wavelength_m = 0.01, sector = 0.3;
  const History one = scene.history(sector, 1), many = scene.history(sector, 9);
  const auto a = scene.weighted(one, scene.cells(one, wavelength_m), about_border),
             b = scene.weighted(many, scene.cells(many, wavelength_m), about_border);
  double sum = 0;
  for (const double energy : scene.sharp(one, about_border)) sum += energy;
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-4 * sum) << k;
}

// Energies never become negative, and without a wavelength they are those of sharp shadows.
TEST(FresnelCells, TendToSharpShadowsAndKeepEnergiesPositive) {
  const std::uint32_t seed = 20261129;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> top(-5, -3), width(0.2, 2), tilt(-0.4, 0.4);
  for (int trial = 0; trial < 12; ++trial) {
    const ScreenScene scene(top(random), width(random), tilt(random));
    SCOPED_TRACE(fmt::format("seed {}, trial {}", seed, trial));
    const History history = scene.history(0.5, 3);
    const std::vector<double> sharp = scene.sharp(history, about_border);
    double sum = 0;
    for (const double energy : sharp) sum += energy;
    for (const double wavelength_m : {1e-6, 0.003, 0.03}) {
      const FresnelCells cells = scene.cells(history, wavelength_m);
      const std::vector<double> energy = scene.weighted(history, cells, about_border);
      double change = 0;
      for (std::size_t k = 0; k < energy.size(); ++k) {
        ASSERT_GE(energy[k], -1e-12 * sum);
        change += std::abs(energy[k] - sharp[k]);
      }
      if (wavelength_m < 1e-5) {
        EXPECT_LT(change, 2e-3 * sum);
      } else {
        EXPECT_GT(change, 1e-3 * sum);
      }
      for (const double factor : cells.factor) ASSERT_TRUE(factor > -1 && factor < 0.9);
    }
  }
}

/// Energies of a separate receiver, with the cells of both legs if there is a wavelength.
std::vector<double> received_apart(const ScreenScene& scene, const TubeSet& transmit, const TubeSet& receive,
                                   const RangeSamples& samples, double wavelength_m) {
  const VisibilityOptions options;
  const std::vector<double> mu{screen_mu};
  const std::vector<std::uint32_t> beams(receive.tubes.size(), 0);
  std::vector<double> energy =
      integrate_echo(trace_bistatic(scene.mesh, *scene.tree, 0x1p-20, options, transmit, receive), {1, beams},
                     samples, {mu, scene.mesh.material, 0, nullptr})
          .energy;
  if (wavelength_m == 0) return energy;
  const auto cells = all_cells<FresnelPairCells>([&](const FresnelBlocks<FresnelPairCells>& blocks) {
    fresnel_pair_cells(
        {scene.mesh, *scene.tree, options, 0x1p-20, [](std::uint16_t component) { return component == 0; }},
        transmit, receive, wavelength_m, blocks);
  });
  const std::vector<std::uint16_t> material(cells.facet.size(), 0);
  EchoModel model{mu, material, 0, nullptr};
  model.path.facet_factor = cells.factor;
  const std::vector<double> change = integrate_echo(cells.history, {1, beams}, samples, model).energy;
  for (std::size_t k = 0; k < energy.size(); ++k) energy[k] += change[k];
  return energy;
}

TEST(FresnelPairCells, OfOneApexAreThoseOfEqualLegs) {
  const ScreenScene scene(screen_top_m, 0.8, 0.1);
  constexpr double wavelength_m = 0.01;
  const History history = scene.history(0.3, 2);
  const std::vector<double> one = scene.weighted(history, scene.cells(history, wavelength_m), about_border),
                            two = received_apart(scene, history.tubes, history.tubes, about_border,
                                                 wavelength_m);
  double sum = 0;
  for (const double energy : one) sum += energy;
  for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], two[k], 3e-3 * one[k] + 1e-6 * sum) << k;
}

// The receiver is above the transmitter, so that each leg has a shadow border of its own.
TEST(FresnelPairCells, AgreeWithTheClosedFormsOfBothLegs) {
  const ScreenScene scene;
  constexpr double wavelength_m = 0.01, above_m = 1.5;
  const TubeSet transmit = scene.history().tubes;
  TubeSet receive = transmit;
  receive.apex.z += std::int32_t(above_m * 0x1p20);
  const RangeSamples samples{12.5, 0.05, 150};
  const auto parameter = [&](double x, double z) {
    const double d1 = std::hypot(screen_range_m, screen_top_m - z);
    const glm::dvec2 along = glm::dvec2(screen_range_m, screen_top_m - z) / d1, place(x, -seabed_below_m - z);
    const double h = along.y * place.x - along.x * place.y, d = glm::dot(along, place);
    return h * std::sqrt(2 * d1 / (wavelength_m * (d - d1) * d));
  };
  std::vector<double> expected(std::size_t(samples.count));
  constexpr double step_m = 1e-4;
  for (double x = screen_range_m + 0.05; x < 24; x += step_m) {
    const double tx = std::hypot(x, seabed_below_m), rx = std::hypot(x, seabed_below_m + above_m),
                 place = ((tx + rx) / 2 - samples.first_m) / samples.step_m;
    if (!(place >= 0 && place < samples.count)) continue;
    expected[std::size_t(place)] += screen_mu * sector_rad * x * step_m * seabed_below_m *
                                    (seabed_below_m + above_m) / std::pow(tx * rx, 3) *
                                    truncated_knife_edge_intensity(parameter(x, 0)) *
                                    truncated_knife_edge_intensity(parameter(x, above_m));
  }
  const std::vector<double> found = received_apart(scene, transmit, receive, samples, wavelength_m);
  const double largest = *std::ranges::max_element(expected);
  double sum = 0, expected_sum = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_NEAR(found[k], expected[k], 0.015 * largest) << k;
    sum += found[k];
    expected_sum += expected[k];
  }
  EXPECT_NEAR(sum, expected_sum, 1e-3 * expected_sum);
  // Without the cells of one leg, or of both, energies differ.
  const std::vector<double> sharp = received_apart(scene, transmit, receive, samples, 0);
  double change = 0;
  for (std::size_t k = 0; k < found.size(); ++k) change += std::abs(found[k] - sharp[k]);
  EXPECT_GT(change, 0.1 * sum);
}

// A far ridge does not remove the terrain on which a nearer ridge casts its shadow.
TEST(FresnelCells, FillTheShadowsOfTwoRidgesOfATerrain) {
  const auto facets = extruded(
      {{-50, -6}, {9, -6}, {10, -4.5}, {11, -6}, {14, -6}, {15, -6}, {16, -4.8}, {17, -6}, {80, -6}}, 50);
  const ScreenScene scene(facets, std::vector<std::uint16_t>(facets.size(), 0));
  constexpr double wavelength_m = 0.005;
  const History history = scene.history(0.05);
  const FresnelCells cells = scene.cells(history, wavelength_m);
  // The shadows end at x = 13.33 m and x = 20 m.
  for (const auto& [edge, x] :
       {std::pair(glm::dvec2(10, -4.5), 12.9), {{10, -4.5}, 13.2}, {{16, -4.8}, 19.5}})
    EXPECT_NEAR(decibels(weight_at(cells, {x, 0.0123, -6}, false)),
                decibels(two_way_knife_edge(parameter_behind(edge, {x, -6}, wavelength_m))), 0.5)
        << x;
}

// A deckhouse casts a shadow on its own deck.
TEST(FresnelCells, FillTheShadowOfAnObjectOnItself) {
  auto facets = extruded({{-50, -6}, {80, -6}}, 50);
  std::vector<std::uint16_t> components(facets.size(), 0);
  for (const auto& facet :
       extruded({{8, -5}, {9.9, -5}, {9.9, -4}, {10, -4}, {10, -5}, {20, -5}, {20, -5.5}, {8, -5.5}, {8, -5}},
                3)) {
    facets.push_back(facet);
    components.push_back(1);
  }
  const ScreenScene scene(facets, components);
  constexpr double wavelength_m = 0.005;
  const History history = scene.history(0.05);
  const FresnelCells cells = scene.cells(history, wavelength_m);
  // The shadow on the deck ends at x = 12.5 m.
  for (const double x : {11.9, 12.2, 12.4})
    EXPECT_NEAR(decibels(weight_at(cells, {x, 0.0123, -5}, false)),
                decibels(two_way_knife_edge(parameter_behind({10, -4}, {x, -5}, wavelength_m))), 0.5)
        << x;
  // The seabed below the deck receives nothing.
  EXPECT_EQ(weight_at(cells, {14.7, 0.0123, -6}, false), 0);
}

// Each visible place beyond a thin post has the weight of the nearer edge alone.
TEST(FresnelCells, KeepVisiblePlacesBeyondAThinPost) {
  constexpr double half_width_m = 0.05, wavelength_m = 0.01, x = 15;
  const ScreenScene scene(2, half_width_m);
  const History history = scene.history(0.3);
  const FresnelCells cells = scene.cells(history, wavelength_m);
  for (double y = 0.09; y < 0.6; y += 0.0371) {
    // The edge is vertical. Its plane with the apex is vertical, too.
    const double d1 = std::hypot(screen_range_m, half_width_m),
                 h = (half_width_m * x - screen_range_m * y) / d1,
                 along = (screen_range_m * x + half_width_m * y) / d1,
                 slant = std::hypot(along, seabed_below_m);
    const double nu = h * std::sqrt(2 * d1 / (wavelength_m * (along - d1) * slant));
    for (const double side : {-1.0, 1.0})
      EXPECT_NEAR(weight_at(cells, {x, side * y, -seabed_below_m}, true), two_way_knife_edge(nu), 0.06) << y;
  }
}

TEST(FresnelCells, DoNotDependOnTheSizeOfBlocks) {
  const ScreenScene scene(screen_top_m, 0.8, 0.1);
  const History history = scene.history(0.1, 2);
  const FresnelCells whole = scene.cells(history, 0.01);
  const VisibilityOptions options;
  std::vector<double> factors;
  std::size_t blocks = 0;
  fresnel_cells(
      {scene.mesh, *scene.tree, options, 0x1p-20, [](std::uint16_t component) { return component == 0; }},
      history, shadow_edges(scene.mesh, history), 0.01,
      {[&](const FresnelCells& block) {
         ++blocks;
         EXPECT_LE(block.facet.size(), 100u);
         EXPECT_EQ(block.history.footprints.footprints.size(), block.facet.size());
         factors.insert(factors.end(), block.factor.begin(), block.factor.end());
       },
       100});
  EXPECT_GT(blocks, 10u);
  EXPECT_EQ(factors, whole.factor);
}

TEST(FresnelCells, StopOnRequest) {
  const ScreenScene scene;
  const History history = scene.history();
  const std::atomic<bool> stop{true};
  stop_requested_of_thread = &stop;
  EXPECT_THROW(scene.cells(history, 0.01), Interrupted);
  stop_requested_of_thread = nullptr;
}

TEST(FresnelCells, AreAbsentWithoutShadows) {
  ScreenScene scene;
  for (const FacetId wall : {2, 3}) scene.mesh.facets[wall] = {0, 0, 0};
  const SceneTree tree(scene.mesh);
  VisibilityOptions options;
  options.corner_names = true;
  AngularGrid grid{{-0.1, 0.1}, {-0.9, -0.2}};
  TubeSet set;
  set.reach = 60 * 0x1p20;
  append_tubes(set, grid);
  EXPECT_TRUE(shadow_edges(scene.mesh, TubeEngine(scene.mesh, tree, 0x1p-20, options).trace(set)).empty());
}

TEST(FresnelZones, SplitKeepsTheAreaOfAPolygon) {
  const std::uint32_t seed = 7;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  const auto area = [](const FresnelPolygon& polygon) {
    double sum = 0;
    for (std::size_t k = 2; k < polygon.size(); ++k)
      sum += glm::length(glm::cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0])) / 2;
    return sum;
  };
  const FresnelPolygon polygon{{2, 0, 0}, {3, 0, 1}, {3, 1, 2}, {2, 1, 1}};
  for (int trial = 0; trial < 200; ++trial) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(value(random), value(random), value(random)));
    FresnelPolygon inside, outside;
    const CutPlane plane{normal, glm::dot(normal, glm::dvec3(2.5, 0.5, 1)) + value(random)};
    split(polygon, plane, inside, outside);
    EXPECT_NEAR(area(inside) + area(outside), area(polygon), 1e-12) << "seed " << seed << ", " << trial;
    for (const glm::dvec3& corner : inside) EXPECT_GE(plane.side(corner), -1e-11);
    for (const glm::dvec3& corner : outside) EXPECT_LE(plane.side(corner), 1e-11);
  }
}

}  // namespace
}  // namespace tubefoot
