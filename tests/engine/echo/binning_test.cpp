// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "engine/echo/echo.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/measure.hpp"

// Tests fast binning, which evaluates the scattering model once per footprint. Totals and range bins are
// correct, and the error falls with the square of the footprint size.
namespace tubefoot {
namespace {

using test::flat_seabed;
using test::on_plane;
using test::Polygon2;

constexpr double height_m = 10, mu = 0.002;
const std::vector<double> material_mu{mu};
const std::vector<std::uint16_t> material{0};
const std::vector<std::uint32_t> beam_of_tube{0};

/// A rectangle on the seabed, x0 .. x1 by -half .. half, as n x n footprints.
History seabed(double x0, double x1, double half, int n) {
  History history;
  FootprintSet& set = history.footprints;
  const FacetPlane plane = flat_seabed(height_m);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto x = [&](int k) { return x0 + (x1 - x0) * k / n; };
      const auto y = [&](int k) { return -half + 2 * half * k / n; };
      Footprint footprint;
      footprint.plane_normal = plane.normal;
      footprint.plane_distance_m = plane.distance_m;
      footprint.first_piece = std::uint32_t(set.pieces.size());
      footprint.piece_count = 1;
      const Polygon2 corners{{x(i), y(j)}, {x(i + 1), y(j)}, {x(i + 1), y(j + 1)}, {x(i), y(j + 1)}};
      set.pieces.push_back({std::uint32_t(set.corners_m.size()), 4});
      for (const glm::dvec3& corner : on_plane(plane, corners)) set.corners_m.push_back(corner);
      set.footprints.push_back(footprint);
    }
  measure(set);
  return history;
}

std::vector<double> energies(const History& history, const RangeSamples& samples, Binning binning) {
  EchoModel model;
  model.material_mu = material_mu;
  model.material = material;
  model.absorption_db_per_m = 0.05;
  return integrate_echo(history, {1, beam_of_tube}, samples, model, binning).energy;
}

double total(const std::vector<double>& energy) { return std::accumulate(energy.begin(), energy.end(), 0.0); }

TEST(FastBinning, TheLawAtTheCentroidInItsSample) {
  const History history = seabed(20, 20.02, 0.01, 1);
  const double r = std::hypot(20.01, height_m), beta = 2 * 0.05 * std::log(10.0) / 10;
  const double expected = mu * std::pow(height_m / r, 2) * 0.02 * 0.02 / std::pow(r, 4) * std::exp(-beta * r);
  const RangeSamples samples{20, 0.5, 10};
  for (const Binning binning : {Binning::centroid, Binning::spread}) {
    const std::vector<double> energy = energies(history, samples, binning);
    const auto sample = std::size_t((r - 20) / 0.5);
    EXPECT_NEAR(energy[sample] / expected, 1, 1e-9);
    EXPECT_EQ(total(energy), energy[sample]);
  }
}

TEST(FastBinning, SpreadsEvenlyOverTheRangesOfAFootprint) {
  const History history = seabed(20, 21, 0.5, 1);
  const Footprint& footprint = history.footprints.footprints.front();
  const double near = footprint.slant_range_min_m, far = footprint.slant_range_max_m;
  const RangeSamples samples{20, 0.125, 80};
  const std::vector<double> energy = energies(history, samples, Binning::spread);
  const double all = total(energies(history, samples, Binning::centroid));
  EXPECT_NEAR(total(energy) / all, 1, 1e-12);
  for (int k = 0; k < samples.count; ++k) {
    const double lo = samples.first_m + k * samples.step_m, hi = lo + samples.step_m;
    const double overlap = std::max(0.0, std::min(hi, far) - std::max(lo, near));
    EXPECT_NEAR(energy[std::size_t(k)], all * overlap / (far - near), 1e-12 * all) << k;
  }
  // Range bins that begin or end within the footprint get only their share of the energy.
  const RangeSamples part{near + 0.25 * (far - near), 0.25 * (far - near), 2};
  EXPECT_NEAR(total(energies(history, part, Binning::spread)) / all, 0.5, 1e-12);
}

TEST(FastBinning, TotalsConvergeAtSecondOrder) {
  const RangeSamples samples{20, 0.05, 200};
  for (const Binning binning : {Binning::centroid, Binning::spread}) {
    std::vector<double> errors;
    for (const int n : {4, 8, 16}) {
      const History history = seabed(20, 24, 1, n);
      const double exact = total(energies(history, samples, Binning::exact));
      errors.push_back(std::abs(total(energies(history, samples, binning)) / exact - 1));
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.2);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.2);
  }
}

TEST(FastBinning, SamplesConvergeAndSpreadIsTheBetterOne) {
  const RangeSamples samples{22, 0.1, 40};
  const auto l1 = [&](int n, Binning binning) {
    const History history = seabed(20, 24, 1, n);
    const std::vector<double> exact = energies(history, samples, Binning::exact),
                              fast = energies(history, samples, binning);
    double difference = 0;
    for (std::size_t k = 0; k < exact.size(); ++k) difference += std::abs(exact[k] - fast[k]);
    return difference / total(exact);
  };
  EXPECT_LT(l1(64, Binning::centroid), 0.5 * l1(8, Binning::centroid));
  EXPECT_LT(l1(32, Binning::spread), 0.1 * l1(4, Binning::spread));
  EXPECT_LT(l1(16, Binning::spread), l1(16, Binning::centroid));
}

/// Returns the same footprints for a receiver at another position.
BistaticHistory received_from(const History& history, glm::dvec3 receiver_m) {
  BistaticHistory both;
  both.transmit.tubes.resize(1);
  both.receive.tubes.resize(1);
  both.shared.receiver_m = receiver_m;
  both.shared.corners_m = history.footprints.corners_m;
  for (const Footprint& f : history.footprints.footprints) {
    SharedFacet facet;
    facet.first_piece = f.first_piece;
    facet.piece_count = f.piece_count;
    facet.plane_normal = f.plane_normal;
    facet.transmit_distance_m = f.plane_distance_m;
    facet.receive_distance_m = f.plane_distance_m + glm::dot(f.plane_normal, receiver_m);
    both.shared.facets.push_back(facet);
  }
  for (const Piece& piece : history.footprints.pieces)
    both.shared.pieces.push_back({0, 0, piece.first, piece.count});
  return both;
}

std::vector<double> energies(const BistaticHistory& history, const RangeSamples& samples, Binning binning,
                             const BeamPatterns* patterns = nullptr) {
  EchoModel model{material_mu, material, 0.05, patterns};
  return integrate_echo(history, {1, beam_of_tube}, samples, model, binning).energy;
}

TEST(FastBinningApart, InOnePlaceItIsThatOfOneApex) {
  const History history = seabed(20, 24, 1, 6);
  const RangeSamples samples{20, 0.3, 30};
  for (const Binning binning : {Binning::centroid, Binning::spread}) {
    const std::vector<double> alone = energies(history, samples, binning),
                              same = energies(received_from(history, glm::dvec3(0)), samples, binning);
    for (std::size_t k = 0; k < alone.size(); ++k) EXPECT_NEAR(same[k], alone[k], 1e-12 * total(alone)) << k;
  }
}

TEST(FastBinningApart, TheLawAtTheCentroidOfBothWays) {
  const glm::dvec3 receiver(7, -3, -2), at = on_plane(flat_seabed(height_m), {{20.01, 0}})[0];
  const double tx = glm::length(at), rx = glm::distance(at, receiver), half = (tx + rx) / 2,
               beta = 0.05 * std::log(10.0) / 10;
  const double expected = mu * height_m / tx * (height_m - 2) / rx * 0.02 * 0.02 / std::pow(tx * rx, 2) *
                          std::exp(-beta * (tx + rx));
  const Directivity sent{Directivity::Kind::line, glm::normalize(glm::dvec3(1, 2, 0.5)), false, 0.1, 6},
      received{Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0.3, 1, -1)), true, 0, 2.5};
  const BeamPatterns patterns{{sent}, {received}, {0}, {{0, 1}}};
  const double gain = sent.gain(at / tx) * received.gain((at - receiver) / rx);
  const BistaticHistory history = received_from(seabed(20, 20.02, 0.01, 1), receiver);
  const RangeSamples samples{15, 0.5, 20};
  const auto sample = std::size_t((half - 15) / 0.5);
  for (const Binning binning : {Binning::centroid, Binning::spread}) {
    const std::vector<double> energy = energies(history, samples, binning),
                              weighed = energies(history, samples, binning, &patterns);
    EXPECT_NEAR(energy[sample] / expected, 1, 1e-9);
    EXPECT_EQ(total(energy), energy[sample]);
    EXPECT_NEAR(weighed[sample] / (gain * expected), 1, 1e-9);
  }
}

TEST(FastBinningApart, ConvergesAtSecondOrderAndAnExchangeChangesNothing) {
  const glm::dvec3 receiver(7, -3, -2);
  const RangeSamples samples{14, 0.1, 240};
  for (const Binning binning : {Binning::centroid, Binning::spread}) {
    std::vector<double> errors, bins;
    for (const int n : {4, 8, 16}) {
      const BistaticHistory history = received_from(seabed(20, 24, 1, n), receiver);
      BistaticHistory swapped = history;
      swapped.shared = exchanged(history.shared);
      const std::vector<double> exact = energies(history, samples, Binning::exact),
                                fast = energies(history, samples, binning),
                                back = energies(swapped, samples, binning);
      errors.push_back(std::abs(total(fast) / total(exact) - 1));
      double difference = 0;
      for (std::size_t k = 0; k < exact.size(); ++k) {
        difference += std::abs(exact[k] - fast[k]);
        EXPECT_NEAR(back[k], fast[k], 1e-12 * total(fast));
      }
      bins.push_back(difference / total(exact));
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.2);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.2);
    EXPECT_LT(bins[2], 0.6 * bins[0]);
  }
}

TEST(FastBinning, KnowsItsNames) {
  EXPECT_EQ(binning_from_name("exact"), Binning::exact);
  EXPECT_EQ(binning_from_name("spread"), Binning::spread);
  EXPECT_EQ(binning_from_name("centroid"), Binning::centroid);
  EXPECT_THROW(binning_from_name("fast"), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
