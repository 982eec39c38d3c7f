// SPDX-License-Identifier: GPL-3.0-or-later
// What two receivers on a staff hear with proven bounds: against the ordinary integrals, and what must hold
// of it.
#include "engine/certified/staff_reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fixtures/geometry/metre_meshes.hpp"

namespace tubefoot {
namespace {

const std::vector<double> material_mu{0.003};

/// A bed of random heights with a wall on it, looked at sideways.
struct StaffScene {
  explicit StaffScene(std::uint64_t seed)
      : grid(20, glm::dvec3(0)), mesh(test::mesh_of(facets(seed), grid)), tree(mesh) {}

  static std::vector<std::array<glm::dvec3, 3>> facets(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> height(-0.3, 0.3);
    double z[5][3];
    for (auto& row : z)
      for (double& one : row) one = height(random);
    const auto at = [&](int i, int j) { return glm::dvec3(3 * i + 1, 3 * j - 3, z[i][j] - 6); };
    std::vector<std::array<glm::dvec3, 3>> all;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 2; ++j) {
        all.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        all.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    all.push_back({glm::dvec3(6, -0.5, -6.5), {6, 0.5, -6.5}, {6, 0, -5}});
    return all;
  }

  struct Result {
    StaffEcho ordinary;
    CertifiedEcho certified;
    std::vector<double> rows() const {
      std::vector<double> all;
      for (const auto* row :
           {&ordinary.upper_j, &ordinary.lower_j, &ordinary.cross_real_j, &ordinary.cross_imag_j})
        all.insert(all.end(), row->begin(), row->end());
      return all;
    }
  };
  Result run(const Fringe& staff, double tolerance, const Directivity& transmit = {},
             const Directivity& receive = {}) const {
    TubeSet tubes;
    tubes.apex = grid.snap(glm::dvec3(0));
    tubes.reach = 100 / grid.unit_m();
    test::add_pyramid(tubes, {glm::dvec3(1, -0.1, -3), {1, -0.1, -0.2}, {1, 0.15, -0.2}, {1, 0.15, -3}});
    const StaffHistory history = trace_staff(mesh, tree, grid.unit_m(), {}, tubes, tubes, staff);
    const BeamPatterns patterns{{transmit}, {receive}, {0}, {{0, 1}}, {staff}};
    const EchoLaw law{material_mu, mesh.material, 0.05, &patterns};
    const RangeSamples samples{6, 0.5, 14};
    Result result{integrate_staff_echo(history, staff, 0, 0, samples, law), {}};
    result.certified = certify_staff_echo(mesh, history, grid.unit_m(), staff, 0, 0, samples, law,
                                          result.ordinary, tolerance);
    return result;
  }

  WorldGrid grid;
  FacetMesh mesh;
  SceneTree tree;
};

Fringe staff_of(double baseline, double wavelength) {
  return {glm::normalize(glm::dvec3(0.5, 0.1, 0.8)), baseline, 2 * 3.141592653589793 / wavelength};
}

void expect_holds(const StaffScene::Result& result, double tolerance, double ordinary_error = 1e-7) {
  const std::vector<double> ordinary = result.rows();
  const std::size_t row = ordinary.size() / 4;
  const auto& bound = result.certified.bound;
  EXPECT_EQ(result.certified.bins_over, 0u) << result.certified.worst_ratio;
  const double most = *std::max_element(ordinary.begin(), ordinary.begin() + std::ptrdiff_t(row));
  EXPECT_GT(most, 0);
  for (std::size_t bin = 0; bin < ordinary.size(); ++bin) {
    const std::size_t k = bin % row;
    const double size = std::max(ordinary[k], ordinary[row + k]);
    EXPECT_LE(std::abs(ordinary[bin] - result.certified.echo.energy[bin]),
              bound[bin] + ordinary_error * size + 1e-13 * most)
        << "channel " << bin / row << " sample " << k;
    EXPECT_LE(bound[bin], tolerance * std::max(size, 1e-6 * most) * 1.01) << bin;
    // And not for what was moved by twice that.
    const double moved = ordinary[bin] + 2.1 * bound[bin] + 2 * ordinary_error * size;
    if (bound[bin] > 0) {
      EXPECT_GT(std::abs(moved - result.certified.echo.energy[bin]), bound[bin]) << bin;
    }
  }
}

TEST(StaffReference, OrdinaryEnergiesAndProductsLieWithin) {
  const StaffScene scene(11);
  for (const auto& [baseline, wavelength] : {std::pair{0.06, 0.015}, {0.4, 0.03}}) {
    const auto result = scene.run(staff_of(baseline, wavelength), 1e-4);
    expect_holds(result, 1e-4);
    double turned = 0;
    for (std::size_t k = 0; k < 14; ++k) turned = std::max(turned, std::abs(result.ordinary.cross_imag_j[k]));
    EXPECT_GT(turned, 0);
  }
}

TEST(StaffReference, SwappedReceiversAreConjugateAndNoBaselineIsOneReceiver) {
  const StaffScene scene(12);
  Fringe staff = staff_of(0.1, 0.02);
  const auto there = scene.run(staff, 1e-4);
  staff.axis = -staff.axis;
  const auto back = scene.run(staff, 1e-4);
  const auto near = [&](const CertifiedEcho& a, std::size_t x, const CertifiedEcho& b, std::size_t y,
                        double sign) {
    for (std::size_t k = 0; k < 14; ++k)
      EXPECT_LE(std::abs(a.echo.energy[14 * x + k] - sign * b.echo.energy[14 * y + k]),
                a.bound[14 * x + k] + b.bound[14 * y + k])
          << x << ' ' << y << ' ' << k;
  };
  near(there.certified, 0, back.certified, 1, 1);
  near(there.certified, 1, back.certified, 0, 1);
  near(there.certified, 2, back.certified, 2, 1);
  near(there.certified, 3, back.certified, 3, -1);
  const auto one = scene.run(staff_of(0, 0.02), 1e-4);
  near(one.certified, 0, one.certified, 1, 1);
  near(one.certified, 0, one.certified, 2, 1);
  near(one.certified, 3, one.certified, 3, -1);
  EXPECT_EQ(one.certified.bins_over, 0u);
}

TEST(StaffReference, PatternsOfAllAreHeld) {
  const StaffScene scene(13);
  Directivity line{Directivity::Kind::line, glm::normalize(glm::dvec3(0.5, 0.1, 0.8))},
      gauss{Directivity::Kind::gaussian, {0.8, 0, -0.6}, true};
  line.size = 0.9;  // zeros would have corners
  gauss.size = 0.7;
  const auto result = scene.run(staff_of(0.06, 0.02), 1e-3, gauss, line);
  expect_holds(result, 1e-3, 1e-6);
}

}  // namespace
}  // namespace tubefoot
