// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the BeTSSi models of scenes/betssi: their meshes, their Kirchhoff target strengths against
// integrals over the smooth bodies, and the differences from boundary elements.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fixtures/test_folder.hpp"
#include "scene/meshes/primitives.hpp"
#include "strength/strength_comparison.hpp"
#include "strength/strength_table.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Length = std::complex<double>;
constexpr double betssi_pi = std::numbers::pi, cylinder_radius_m = 0.3, cylinder_length_m = 4.8;

fs::path betssi_folder() { return fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/betssi"; }
ComponentMesh betssi_mesh(const std::string& model, const fs::path& folder = betssi_folder()) {
  return strength_mesh(folder / (model + ".obj"), std::nullopt, std::nullopt);
}

StrengthTable betssi_strength(const ComponentMesh& mesh, const std::vector<double>& azimuths_deg,
                              const std::vector<double>& frequencies_hz) {
  return strength_of(mesh, "model", {azimuths_deg, {0}, frequencies_hz, 1500, {}, "rigid"}, true);
}

double wave_number(double hertz) { return 2 * betssi_pi * hertz / 1500; }
glm::dvec3 level_direction(double azimuth_deg) {
  return {std::cos(azimuth_deg * betssi_pi / 180), std::sin(azimuth_deg * betssi_pi / 180), 0};
}

std::vector<double> every(double step_deg, double last_deg) {
  std::vector<double> azimuths;
  for (int k = 0; k * step_deg <= last_deg + 1e-9; ++k) azimuths.push_back(k * step_deg);
  return azimuths;
}

/// Adds the Kirchhoff integrand over points of a surface of revolution about x between two positions.
/// `radius_at` returns the radius and its slope. Only points that face the sonar count, as on a convex body.
template <class Radius>
Length over_revolution(double from_m, double to_m, int steps, int turns, Radius radius_at, glm::dvec3 towards,
                       double k) {
  Length sum = 0;
  const double step = (to_m - from_m) / steps, turn = 2 * betssi_pi / turns;
  for (int i = 0; i < steps; ++i) {
    const double x = from_m + (i + 0.5) * step;
    const auto [r, slope] = radius_at(x);
    for (int j = 0; j < turns; ++j) {
      const double c = std::cos((j + 0.5) * turn), s = std::sin((j + 0.5) * turn);
      // The normal times the area element is (-slope, c, s) r dx dphi.
      const double facing = glm::dot(glm::dvec3(-slope, c, s), towards);
      if (facing > 0)
        sum += std::polar(facing * r * step * turn, -2 * k * glm::dot(glm::dvec3(x, r * c, r * s), towards));
    }
  }
  return sum;
}

/// Kirchhoff's integral over the smooth M3, by points. Half spheres use the polar angle, at which the area
/// element stays finite at the pole.
Length m3_by_points(double azimuth_deg, double hertz) {
  const glm::dvec3 towards = level_direction(azimuth_deg);
  const double k = wave_number(hertz);
  Length sum = over_revolution(
      -19.5, 21.5, 1200, 600, [](double x) { return std::pair(5 - 2 * (x + 19.5) / 41, -2.0 / 41); }, towards,
      k);
  const auto half_sphere = [&](double centre, double radius, double sign) {
    constexpr int rings = 200, turns = 600;
    const double polar_step = betssi_pi / 2 / rings, turn = 2 * betssi_pi / turns;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < turns; ++j) {
        const double angle = (i + 0.5) * polar_step, phi = (j + 0.5) * turn;
        const glm::dvec3 normal(sign * std::cos(angle), std::sin(angle) * std::cos(phi),
                                std::sin(angle) * std::sin(phi));
        const double facing = glm::dot(normal, towards);
        if (facing > 0)
          sum += std::polar(facing * radius * radius * std::sin(angle) * polar_step * turn,
                            -2 * k * (centre * towards.x + radius * facing));
      }
  };
  half_sphere(21.5, 3, 1);
  half_sphere(-19.5, 5, -1);
  return Length(0, -k / (2 * betssi_pi)) * sum;
}

/// The integral of cos(a) exp(-2i k r cos(a)) over the arc that faces the sonar, which is 2 radii wide.
template <class Visible>
Length over_arc(double k_projected, Length phase, Visible visible) {
  constexpr int steps = 20000;
  Length sum = 0;
  for (int j = 0; j < steps; ++j) {
    const double angle = ((j + 0.5) / steps - 0.5) * betssi_pi;
    if (visible(cylinder_radius_m * std::sin(angle)))
      sum += std::polar(std::cos(angle), -2 * k_projected * cylinder_radius_m * std::cos(angle));
  }
  return phase * sum * (betssi_pi / steps * cylinder_radius_m);
}

/// Kirchhoff's integral over both cylinders of M5A, which hide nothing of each other. Along the axis, the
/// side has a closed form. The disc has one with Bessel's function.
Length m5a_in_closed_form(double azimuth_deg, double hertz) {
  const double k = wave_number(hertz), along = std::abs(level_direction(azimuth_deg).x),
               across = level_direction(azimuth_deg).y, x = k * cylinder_length_m * along,
               y = 2 * k * cylinder_radius_m * across;
  const Length arc = over_arc(k * across, 1, [](double) { return true; });
  const Length side = across * cylinder_length_m * (x > 1e-9 ? std::sin(x) / x : 1.0) * arc;
  const Length disc = along * betssi_pi * cylinder_radius_m * cylinder_radius_m *
                      (y > 1e-9 ? 2 * std::cyl_bessel_j(1, y) / y : 1.0) * std::polar(1.0, -x);
  return Length(0, -k / betssi_pi) * (side + disc);
}

/// Kirchhoff's integral over both cylinders of M5B. The nearer cylinder hides a strip of the other.
Length m5b_by_arcs(double azimuth_deg, double hertz) {
  const double k = wave_number(hertz);
  const glm::dvec3 towards = level_direction(azimuth_deg);
  Length sum = 0;
  for (const double centre : {-0.5, 0.5}) {
    const bool rear = centre * towards.x < -1e-12;
    // Offsets across the line of sight: of a point from its axis, and of the other axis from this one.
    const double other = 2 * centre * towards.y;
    sum += over_arc(k, std::polar(1.0, -2 * k * centre * towards.x),
                    [&](double offset) { return !rear || std::abs(offset - other) > cylinder_radius_m; });
  }
  return Length(0, -k / (2 * betssi_pi)) * cylinder_length_m * sum;
}

/// Compares lengths with those of an integral. The tolerance is relative to the largest length of the same
/// frequency, because facets change the depth of nulls.
template <class Integral>
void expect_equals(const StrengthTable& table, Integral integral, double tolerance) {
  const auto& azimuths = table.request.azimuths_deg;
  for (std::size_t f = 0; f < table.request.frequencies_hz.size(); ++f) {
    double largest = 0, off = 0, worst_deg = 0;
    for (std::size_t a = 0; a < azimuths.size(); ++a) {
      const Length expected = integral(azimuths[a], table.request.frequencies_hz[f]);
      largest = std::max(largest, std::abs(expected));
      if (const double error = std::abs(table.at(0, a, f) - expected); error > off) {
        off = error;
        worst_deg = azimuths[a];
      }
    }
    EXPECT_LT(off, tolerance * largest)
        << table.request.frequencies_hz[f] << " Hz, azimuth " << worst_deg << ", largest " << largest;
  }
}

TEST(Betssi, MeshesAreClosedAndHaveTheVolumeOfTheModels) {
  struct Row {
    const char* model;
    double volume_m3, tolerance, fine_enough_hz;
    glm::dvec3 half_size_m;
  };
  const double cylinders = 2 * betssi_pi * cylinder_radius_m * cylinder_radius_m * cylinder_length_m;
  for (const Row& row :
       {Row{"m3", betssi_pi * (41.0 * (9 + 15 + 25) / 3 + 2.0 * (27 + 125) / 3), 1e-5, 3e3, {24.5, 5, 5}},
        Row{"m5a", cylinders, 2e-6, 10e3, {2.4, 0.3, 0.8}},
        Row{"m5b", cylinders, 2e-6, 10e3, {0.8, 0.3, 2.4}}}) {
    const ComponentMesh mesh = betssi_mesh(row.model);
    EXPECT_THAT(warnings_of(mesh, row.fine_enough_hz, 1500), testing::IsEmpty()) << row.model;
    double volume = 0;
    glm::dvec3 reach(0);
    for (const auto& [a, b, c] : mesh.triangles)
      volume += glm::dot(mesh.points_m[a], glm::cross(mesh.points_m[b], mesh.points_m[c])) / 6;
    for (const glm::dvec3& p : mesh.points_m) reach = glm::max(reach, glm::abs(p));
    EXPECT_NEAR(volume / row.volume_m3, 1, row.tolerance) << row.model;
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(reach[axis], row.half_size_m[axis], 2e-3) << row.model;
  }
}

// In dB: phases of the mesh differ by up to 0.02 rad, and magnitudes less.
TEST(Betssi, M3EqualsPointsOfTheSmoothBody) {
  const std::vector<double> azimuths{0, 15, 30, 45, 60, 75, 87.2, 90, 105, 120, 135, 150, 165, 180};
  const StrengthTable table = betssi_strength(betssi_mesh("m3"), azimuths, {1e3});
  for (std::size_t a = 0; a < azimuths.size(); ++a)
    EXPECT_NEAR(20 * std::log10(std::abs(table.at(0, a, 0) / m3_by_points(azimuths[a], 1e3))), 0, 0.08)
        << azimuths[a];
}

TEST(Betssi, M5AEqualsItsClosedForm) {
  expect_equals(betssi_strength(betssi_mesh("m5a"), every(7.5, 180), {1e3, 3e3, 10e3}), m5a_in_closed_form,
                2e-3);
}

// The cylinders hide parts of each other below 36.9 degrees, where 1 m times the sine is two radii.
TEST(Betssi, M5BEqualsArcsWithTheShadowOfTheNearerCylinder) {
  const std::vector<double> azimuths{0, 5, 12.5, 20, 30, 36, 37.5, 45, 60, 75, 90, 101, 150, 175, 180};
  expect_equals(betssi_strength(betssi_mesh("m5b"), azimuths, {1e3, 3e3, 10e3}), m5b_by_arcs, 2e-3);
}

// Mirrored directions see mirrored bodies. Only M3 differs between bow and stern.
TEST(Betssi, TargetStrengthIsSymmetric) {
  const std::vector<double> half{11, 37, 62.5, 88}, left{-88, -62.5, -37, -11}, rear{92, 117.5, 143, 169};
  for (const char* model : {"m3", "m5a", "m5b"}) {
    const ComponentMesh mesh = betssi_mesh(model);
    const StrengthTable right = betssi_strength(mesh, half, {1e3, 3e3}),
                        mirrored = betssi_strength(mesh, left, {1e3, 3e3}),
                        behind = betssi_strength(mesh, rear, {1e3, 3e3});
    for (std::size_t a = 0; a < half.size(); ++a)
      for (std::size_t f = 0; f < 2; ++f) {
        const Length length = right.at(0, a, f);
        EXPECT_LT(std::abs(length - mirrored.at(0, 3 - a, f)), 1e-5) << model << ' ' << half[a];
        const double turned = std::abs(length - behind.at(0, 3 - a, f));
        if (model == std::string("m3"))
          EXPECT_GT(turned, 0.05) << half[a];
        else
          EXPECT_LT(turned, 1e-5) << model << ' ' << half[a];
      }
  }
}

// A finer mesh is nearer to the smooth body: the error is at most proportional to the chord error.
TEST(Betssi, ErrorOfFacetsFallsWithTheChordError) {
  const TestFolder folder;
  const auto error = [&](const std::string& refine) {
    const std::string command = "python3 '" + (betssi_folder() / "make_models.py").string() + "' -o '" +
                                (folder / refine).string() + "' --refine " + refine;
    if (std::system(command.c_str()) != 0) return std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> azimuths{50, 70, 80, 85, 90};
    const StrengthTable table = betssi_strength(betssi_mesh("m5a", folder / refine), azimuths, {10e3});
    double worst = 0;
    for (std::size_t a = 0; a < azimuths.size(); ++a)
      worst = std::max(worst, std::abs(table.at(0, a, 0) - m5a_in_closed_form(azimuths[a], 10e3)));
    return worst;
  };
  const double coarse = error("0.1");
  if (std::isnan(coarse)) GTEST_SKIP() << "python3 is not installed";
  const double middle = error("0.2"), fine = error("0.4");
  EXPECT_GT(coarse, 0);
  EXPECT_LT(middle, 0.55 * coarse);
  EXPECT_LT(fine, 0.55 * middle);
}

/// Backscattering length of a rigid cylinder at broadside, from the series of an infinite cylinder.
double by_series(double hertz) {
  const double x = wave_number(hertz) * cylinder_radius_m;
  Length sum = 0;
  for (int n = 0; n < x + 25; ++n) {
    const auto slope = [&](auto bessel) {
      return n == 0 ? -bessel(1.0, x) : (bessel(n - 1.0, x) - bessel(n + 1.0, x)) / 2;
    };
    const double j = slope([](double order, double at) { return std::cyl_bessel_j(order, at); }),
                 y = slope([](double order, double at) { return std::cyl_neumann(order, at); });
    sum += (n == 0 ? 1.0 : 2.0) * (n % 2 == 0 ? 1.0 : -1.0) * j / Length(j, y);
  }
  return cylinder_length_m / betssi_pi * std::abs(sum);
}

// Kirchhoff's error of one cylinder is small from 3 kHz. The rest of the differences of M5 at broadside
// comes from sound between the cylinders.
TEST(Betssi, OneCylinderDiffersLessFromItsSeriesThanBothFromBoundaryElements) {
  const ComponentMesh one = cylinder_facets({cylinder_radius_m, cylinder_length_m}, 1e-4, {});
  const std::vector<double> frequencies{1e3, 3e3, 10e3};
  const StrengthTable table = betssi_strength(one, {0}, frequencies);
  const std::vector<double> kirchhoff_minus_series{2.38, 0.48, -0.03};
  for (std::size_t f = 0; f < 3; ++f)
    EXPECT_NEAR(20 * std::log10(std::abs(table.at(0, 0, f)) / by_series(frequencies[f])),
                kirchhoff_minus_series[f], 0.02);
  const StrengthComparison both =
      read_comparison(betssi_folder() / "m5a.csv", {{90}, {0}, frequencies, 1500, {}, "rigid"});
  const std::vector<double> interaction{-0.66, -2.33, 2.69};
  for (std::size_t f = 0; f < 3; ++f)
    EXPECT_NEAR(both.strength_db[f] - 20 * std::log10(2 * by_series(frequencies[f])), interaction[f], 0.01);
}

StrengthTable compared_with_boundary_elements(const std::string& model,
                                              const std::vector<double>& azimuths_deg,
                                              const std::vector<double>& frequencies_hz) {
  StrengthTable table = betssi_strength(betssi_mesh(model), azimuths_deg, frequencies_hz);
  table.comparison = read_comparison(betssi_folder() / (model + ".csv"), table.request);
  return table;
}

// Published values at three aspects, to 0.001 dB.
TEST(Betssi, TablesHoldThePublishedValues) {
  const StrengthComparison m5b =
      read_comparison(betssi_folder() / "m5b.csv", {{0, 45, 90}, {0}, {3e3}, 1500, {}, "rigid"});
  EXPECT_NEAR(m5b.strength_db[0], 6.884, 5.1e-4);
  EXPECT_NEAR(m5b.strength_db[1], 12.764, 5.1e-4);
  EXPECT_NEAR(m5b.strength_db[2], 11.357, 5.1e-4);
  for (const auto& [model, frequencies, missing] : {std::tuple("m3", std::vector<double>{1e3}, 0),
                                                    std::tuple("m5a", std::vector<double>{1e3, 3e3, 10e3}, 0),
                                                    std::tuple("m5b", std::vector<double>{1e3, 3e3}, 0),
                                                    std::tuple("m5b", std::vector<double>{10e3}, 900)}) {
    const StrengthComparison table = read_comparison(betssi_folder() / (std::string(model) + ".csv"),
                                                     {every(0.2, 180), {0}, frequencies, 1500, {}, "rigid"});
    EXPECT_EQ(table.strength_db.size(), 901 * frequencies.size()) << model;
    EXPECT_EQ(std::ranges::count_if(table.strength_db, [](double db) { return std::isnan(db); }), missing)
        << model;
  }
}

// Limits of validation/target-strength.md.
TEST(Betssi, M3DiffersFromBoundaryElementsByLessThanHalfADecibel) {
  const StrengthTable table = compared_with_boundary_elements("m3", every(15, 180), {1e3});
  for (std::size_t a = 0; a < 13; ++a)
    EXPECT_LT(std::abs(difference_db(table, 0, a, 0)), 0.43) << table.request.azimuths_deg[a];
}

TEST(Betssi, M5DiffersFromBoundaryElementsWithinLimits) {
  struct Row {
    const char* model;
    double hertz, azimuth_deg, difference_db;
  };
  for (const Row& row : {Row{"m5a", 1e3, 0, -1.53}, Row{"m5a", 1e3, 90, 3.04}, Row{"m5a", 3e3, 0, -0.26},
                         Row{"m5a", 3e3, 90, 2.80}, Row{"m5a", 10e3, 0, -0.07}, Row{"m5a", 10e3, 90, -2.72},
                         Row{"m5b", 1e3, 0, 16.82}, Row{"m5b", 1e3, 90, 3.04}, Row{"m5b", 3e3, 0, 1.26},
                         Row{"m5b", 3e3, 45, 0.07}, Row{"m5b", 3e3, 90, 2.80}, Row{"m5b", 10e3, 60, 1.00}}) {
    const StrengthTable table = compared_with_boundary_elements(row.model, {row.azimuth_deg}, {row.hertz});
    EXPECT_NEAR(difference_db(table, 0, 0, 0), row.difference_db, 0.02)
        << row.model << ' ' << row.hertz << " Hz, azimuth " << row.azimuth_deg;
  }
}

}  // namespace
}  // namespace tubefoot
