// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies and products of a receiver pair. The comparisons are the ordinary integrals,
// bistatic references, and laws of covariances.
#include "engine/certified/receiver_pair_reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fixtures/geometry/metre_meshes.hpp"

namespace tubefoot {
namespace {

const std::vector<double> pair_material_mu{0.003};

/// A seabed of random heights with a wall on it, which the sonar views sideways.
struct ReceiverPairScene {
  explicit ReceiverPairScene(std::uint64_t seed)
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
    ReceiverPairEcho ordinary;
    CertifiedEcho certified;
    std::vector<double> rows() const {
      std::vector<double> all;
      for (const auto* row :
           {&ordinary.upper_j, &ordinary.lower_j, &ordinary.cross_real_j, &ordinary.cross_imag_j})
        all.insert(all.end(), row->begin(), row->end());
      return all;
    }
  };
  /// `middle_m`: middle of the receiver pair; the transmitter is at the origin
  Result run(const ReceiverBaseline& receiver_pair, double tolerance, const Directivity& transmit = {},
             const Directivity& receive = {}, glm::dvec3 middle_m = glm::dvec3(0)) const {
    const ReceiverPairHistory history = trace_receiver_pair(
        mesh, tree, grid.unit_m(), {}, tubes_from(glm::dvec3(0)), tubes_from(middle_m), receiver_pair);
    const BeamPatterns patterns{{transmit}, {receive}, {0}, {{0, 1}}, {receiver_pair}};
    const EchoModel model{pair_material_mu, mesh.material, 0.05, &patterns};
    Result result{integrate_receiver_pair_echo(history, receiver_pair, 0, 0, samples, model), {}};
    result.certified = certify_receiver_pair_echo(mesh, history, grid.unit_m(), receiver_pair, samples, model,
                                                  result.ordinary, tolerance);
    return result;
  }

  /// Energies of one receiver at a position.
  CertifiedEcho run_apart(glm::dvec3 at_m, double tolerance) const {
    const BistaticHistory history =
        trace_bistatic(mesh, tree, grid.unit_m(), {}, tubes_from(glm::dvec3(0)), tubes_from(at_m));
    const EchoModel model{pair_material_mu, mesh.material, 0.05};
    const std::vector<std::uint32_t> beam{0};
    const Echo ordinary = integrate_echo(history, {1, beam}, samples, model);
    return certify_echo(mesh, history, {1, beam}, samples, model, ordinary, tolerance);
  }
  TubeSet tubes_from(glm::dvec3 at_m) const {
    TubeSet set;
    set.apex = grid.snap(at_m);
    set.reach = 100 / grid.unit_m();
    test::add_pyramid(set, {glm::dvec3(1, -0.1, -3), {1, -0.1, -0.2}, {1, 0.15, -0.2}, {1, 0.15, -3}});
    return set;
  }

  WorldGrid grid;
  FacetMesh mesh;
  SceneTree tree;
  const RangeSamples samples{6, 0.5, 14};
};

ReceiverBaseline receiver_pair_of(double baseline, double wavelength) {
  return {glm::normalize(glm::dvec3(0.5, 0.1, 0.8)), baseline, 2 * 3.141592653589793 / wavelength};
}

void expect_holds(const ReceiverPairScene::Result& result, double tolerance, double ordinary_error = 1e-7) {
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
    // The bound does not contain a value that is moved by twice the bound.
    const double moved = ordinary[bin] + 2.1 * bound[bin] + 2 * ordinary_error * size;
    if (bound[bin] > 0) {
      EXPECT_GT(std::abs(moved - result.certified.echo.energy[bin]), bound[bin]) << bin;
    }
  }
}

TEST(ReceiverPairReference, OrdinaryEnergiesAndProductsLieWithin) {
  const ReceiverPairScene scene(11);
  for (const auto& [baseline, wavelength] : {std::pair{0.06, 0.015}, {0.4, 0.03}}) {
    const auto result = scene.run(receiver_pair_of(baseline, wavelength), 1e-4);
    expect_holds(result, 1e-4);
    double turned = 0;
    for (std::size_t k = 0; k < 14; ++k) turned = std::max(turned, std::abs(result.ordinary.cross_imag_j[k]));
    EXPECT_GT(turned, 0);
  }
}

TEST(ReceiverPairReference, SwappedReceiversAreConjugateAndNoBaselineIsOneReceiver) {
  const ReceiverPairScene scene(12);
  ReceiverBaseline receiver_pair = receiver_pair_of(0.1, 0.02);
  const auto there = scene.run(receiver_pair, 1e-4);
  receiver_pair.axis = -receiver_pair.axis;
  const auto back = scene.run(receiver_pair, 1e-4);
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
  const auto one = scene.run(receiver_pair_of(0, 0.02), 1e-4);
  near(one.certified, 0, one.certified, 1, 1);
  near(one.certified, 0, one.certified, 2, 1);
  near(one.certified, 3, one.certified, 3, -1);
  EXPECT_EQ(one.certified.bins_over, 0u);
}

// The pair lies above and below the transmitter, before and behind it, with a seabed and a wall.
TEST(ReceiverPairReference, TheReceiversMayBeElsewhere) {
  const ReceiverPairScene scene(14);
  for (const glm::dvec3 middle : {glm::dvec3(-0.5, 0.2, 0.4), {1, -0.1, -0.75}, {0, 0.02, 3}}) {
    SCOPED_TRACE(testing::Message() << middle.x << ' ' << middle.y << ' ' << middle.z);
    ReceiverBaseline receiver_pair = receiver_pair_of(0.2, 0.02);
    const auto there = scene.run(receiver_pair, 1e-4, {}, {}, middle);
    expect_holds(there, 1e-4);
    receiver_pair.axis = -receiver_pair.axis;
    const auto back = scene.run(receiver_pair, 1e-4, {}, {}, middle);
    double turned = 0;
    for (std::size_t k = 0; k < 14; ++k) {
      const auto &a = there.certified, &b = back.certified;
      EXPECT_LE(std::abs(a.echo.energy[28 + k] - b.echo.energy[28 + k]), a.bound[28 + k] + b.bound[28 + k]);
      EXPECT_LE(std::abs(a.echo.energy[42 + k] + b.echo.energy[42 + k]), a.bound[42 + k] + b.bound[42 + k]);
      turned = std::max(turned, std::abs(a.echo.energy[42 + k]) / (a.echo.energy[k] + 1e-300));
    }
    EXPECT_GT(turned, 0.01);
  }
}

// Without a baseline, all four rows are those of two apexes. Another integral encloses these rows.
TEST(ReceiverPairReference, AReceiverPairWithoutLengthElsewhereIsOneSeparateReceiver) {
  const ReceiverPairScene scene(15);
  const glm::dvec3 middle(-0.5, 0.2, 0.4);
  const auto receiver_pair = scene.run(receiver_pair_of(0, 0.02), 1e-6, {}, {}, middle);
  const auto one = scene.run_apart(middle, 1e-6);
  for (std::size_t k = 0; k < 14; ++k)
    for (const std::size_t row : {0, 1, 2})
      EXPECT_LE(std::abs(receiver_pair.certified.echo.energy[14 * row + k] - one.echo.energy[k]),
                receiver_pair.certified.bound[14 * row + k] + one.bound[k])
          << row << ' ' << k;
  EXPECT_EQ(receiver_pair.certified.bins_over, 0u);
}

TEST(ReceiverPairReference, FortyDigitsFromOutsideTheProgram) {
  // From path_reference_digits.py: rows of the upper receiver, the lower receiver, and the real and
  // imaginary part.
  const std::vector<double> digits{
      0.00000666012425293253596666488624802893750327,    0.000006167856021495902909254603098731560623421,
      0.000000164592499092036986988484788737796891502,   0.000007706051348520519798172863409024587428806,
      0.000005530068410075845214735066832541483081006,   0.0000001250366851792834059682301021512599793383,
      -0.0000006916300099756907544980649113220096457017, -0.0000009936903047636408748842979198846412613424,
      -0.0000001122511993452694828429110503265188122579, 0.000000653138973239284906440881506024662745716,
      -0.000001920546079778582251393902410851624979373,  -0.00000002966185011251154520927865360661772302668};
  const WorldGrid grid(20, glm::dvec3(0));
  const FacetMesh mesh = test::mesh_of({{glm::dvec3(1, -1, 0.25), {5, 1, 1.25}, {2, 3, 0.5}}}, grid);
  const SceneTree tree(mesh);
  const auto down = [&](glm::dvec3 at_m) {
    TubeSet set;
    set.apex = grid.snap(at_m);
    set.reach = 100 / grid.unit_m();
    test::add_pyramid(set, {glm::dvec3(-1, -1, -0.1), {1, -1, -0.1}, {1, 1, -0.1}, {-1, 1, -0.1}});
    return set;
  };
  const ReceiverBaseline receiver_pair{{0, 0.6, 0.8}, 0.25, 64};
  const ReceiverPairHistory history = trace_receiver_pair(mesh, tree, grid.unit_m(), {}, down({-1, 0.5, 6}),
                                                          down({1.5, -1, 4}), receiver_pair);
  const BeamPatterns patterns{{Directivity()}, {Directivity()}, {0}, {{0, 1}}, {receiver_pair}};
  const std::vector<double> bright{0x1p-9};
  const EchoModel model{bright, mesh.material, 0.0625, &patterns};
  const RangeSamples samples{4.5, 0.75, 3};
  const ReceiverPairEcho ordinary =
      integrate_receiver_pair_echo(history, receiver_pair, 0, 0, samples, model);
  for (const double tolerance : {1e-2, 1e-8}) {
    const CertifiedEcho found = certify_receiver_pair_echo(mesh, history, grid.unit_m(), receiver_pair,
                                                           samples, model, ordinary, tolerance);
    EXPECT_EQ(found.bins_over, 0u) << found.worst_ratio;
    for (std::size_t k = 0; k < digits.size(); ++k) {
      EXPECT_LE(std::abs(found.echo.energy[k] - digits[k]), found.bound[k] + 1e-15 * std::abs(digits[k]))
          << k << ' ' << tolerance;
      EXPECT_GT(std::abs(found.echo.energy[k] - digits[k] - 2.1 * found.bound[k]), found.bound[k]) << k;
    }
  }
}

TEST(ReceiverPairReference, RefusesFacetsThatAreSeenElsewhere) {
  ReceiverPairHistory history;
  history.bistatic_upper.resize(1);
  const EchoModel model{pair_material_mu, {}, 0};
  EXPECT_THROW(certify_receiver_pair_echo({}, history, 1, {}, {1, 1, 1}, model, {}, 1e-3),
               std::invalid_argument);
}

TEST(ReceiverPairReference, PatternsOfAllAreHeld) {
  const ReceiverPairScene scene(13);
  Directivity line{Directivity::Kind::line, glm::normalize(glm::dvec3(0.5, 0.1, 0.8))},
      gauss{Directivity::Kind::gaussian, {0.8, 0, -0.6}, true};
  line.size = 0.9;  // zeros of the pattern would be corners
  gauss.size = 0.7;
  const auto result = scene.run(receiver_pair_of(0.06, 0.02), 1e-3, gauss, line);
  expect_holds(result, 1e-3, 1e-6);
  expect_holds(scene.run(receiver_pair_of(0.06, 0.02), 1e-3, gauss, line, {0.5, 0.1, 0.3}), 1e-3, 1e-6);
}

}  // namespace
}  // namespace tubefoot
