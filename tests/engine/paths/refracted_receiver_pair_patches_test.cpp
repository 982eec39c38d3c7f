// SPDX-License-Identifier: GPL-3.0-or-later
// Tests paths with more than one scattering to a receiver pair in stratified water, with energies and
// coherence. The comparisons are sums over points with arcs in closed form to both receivers, isovelocity
// water, one receiver, and laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "fixtures/world/receiver_pairs.hpp"
#include "fixtures/world/refracted_rays.hpp"

namespace tubefoot {
namespace {

using namespace test;

/// The sonar lies over the plates, with the fin between. Patches are large where both sides of a comparison
/// use the same patches.
Setting scattered(int times, double patch_m = 0.5) {
  Setting s = plates(true);
  s.paths.order = s.paths.scatterings = times;
  s.paths.patch_m = patch_m;
  return s;
}

const ReceiverBaseline receiver_pair{slanting_axis, 0.12, 60};

ReceiverPairPathEcho received_through(const WaterColumn& column, const Setting& s,
                                      const ReceiverBaseline& by = receiver_pair,
                                      double travel_path_error_m = 1e-2) {
  const PathWater water = through_water(column, travel_path_error_m);
  return received_by_receiver_pair(s, by, &water);
}

/// The tolerances are relative to the energy of the upper receiver, in total and in each bin.
void expect_sums(const ReceiverPairEcho& echo, const ReceiverPairSums& sums, double of_total, double of_bin,
                 const char* what) {
  double upper = 0, lower = 0, energy = 0, turned = 0;
  for (std::size_t k = 0; k < sums.upper.size(); ++k) {
    energy += sums.upper[k];
    upper += echo.upper_j[k] - sums.upper[k];
    lower += echo.lower_j[k] - sums.lower[k];
  }
  EXPECT_GT(energy, 0) << what;
  EXPECT_NEAR(upper, 0, of_total * energy) << what;
  EXPECT_NEAR(lower, 0, of_total * energy) << what;
  for (std::size_t k = 0; k < sums.upper.size(); ++k) {
    SCOPED_TRACE(testing::Message() << what << ", sample " << k);
    EXPECT_NEAR(echo.upper_j[k], sums.upper[k], of_bin * energy);
    EXPECT_NEAR(echo.lower_j[k], sums.lower[k], of_bin * energy);
    EXPECT_LT(std::abs(product(echo, k) - sums.cross[k]), of_bin * energy);
    turned = std::max(turned, std::abs(sums.cross[k].imag()));
  }
  EXPECT_GT(turned, 5 * of_bin * energy) << what;  // there is a phase to compare
}

TEST(RefractedReceiverPairPatches, TwoAndThreeScatteringsAgreeWithSumsOverPoints) {
  for (const double g : {-60.0, 60.0}) {
    SCOPED_TRACE(g);
    const Setting s = scattered(g < 0 ? 3 : 2, 0.25);
    const Arcs arcs{1500 - 3 * g, g, s.absorption_db_per_m};
    const ReceiverPairPathEcho paths = received_through(column_of(arcs), s, receiver_pair, 2e-3),
                               straight = received_by_receiver_pair(s, receiver_pair);
    const PointSum sum(s, 8, arcs, receiver_pair);
    const ReceiverPairSums two = sum.twice_by_receiver_pair();
    expect_sums(paths.by_order[2], two, 0.01, 0.01, "two");
    // Delays are stored in steps of a range bin. This blurs the ends of the bins, as in isovelocity water.
    if (g < 0) expect_sums(paths.by_order[3], sum.thrice_by_receiver_pair(), 0.015, 0.04, "three");
    // Refraction has an effect on this.
    double moved = 0, energy = 0;
    for (std::size_t k = 0; k < two.upper.size(); ++k) {
      moved = std::max(moved, std::abs(product(straight.by_order[2], k) - two.cross[k]));
      energy += two.upper[k];
    }
    EXPECT_GT(moved, 0.05 * energy);
  }
}

// Each path begins and ends at the surface. Its mirror image of the receiver pair is upside down.
TEST(RefractedReceiverPairPatches, MirrorScatterScatterMirrorAgreesWithSumsOverPoints) {
  Setting s = scattered(2, 0.25);
  s.transmit = around({-0.5, 0.25, -2}, 10, 89.99, 3, 60, 4);
  s.receive = around({0.8, -0.5, -1.75}, 10, 89.99, 3, 60, 4);
  s.samples = {5, 0.5, 14};
  s.paths.order = 4;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0};
  const double g = -50;
  const Arcs arcs{1700, g, s.absorption_db_per_m};
  const ArcsBySurface by_surface{{1700, g}, 0.7, s.absorption_db_per_m};
  const ReceiverPairPathEcho paths = received_through(column_of(arcs), s, receiver_pair, 2e-3);
  EXPECT_GT(paths.patches, 0u);
  EXPECT_GT(paths.seen_by_patches.facets, 0u);
  expect_sums(paths.by_order[4], PointSum(s, 12, arcs, by_surface, receiver_pair).twice_by_receiver_pair(),
              0.02, 0.02, "surface");
}

// Patches are cut differently than in isovelocity water, so that they agree to the error of patches.
TEST(RefractedReceiverPairPatches, IsovelocityWaterIsTheStraightEngine) {
  Setting s = scattered(3);
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0.4};
  const WaterColumn even{SoundSpeedProfile({{0, c_ref}, {8, c_ref}}), {0.3, 0.3, 0.3}};
  const ReceiverPairPathEcho straight = received_by_receiver_pair(s, receiver_pair),
                             refracted = received_through(even, s);
  EXPECT_EQ(refracted.seen_by_patches.in_shadow, 0u);
  EXPECT_EQ(refracted.seen_by_patches.folded, 0u);
  for (std::size_t order = 2; order < 4; ++order) {
    const ReceiverPairEcho &a = straight.by_order[order], &b = refracted.by_order[order];
    const double all = std::reduce(a.upper_j.begin(), a.upper_j.end());
    EXPECT_GT(all, 0);
    for (std::size_t k = 0; k < a.upper_j.size(); ++k) {
      EXPECT_NEAR(b.upper_j[k], a.upper_j[k], 2e-3 * all) << order << ' ' << k;
      EXPECT_NEAR(b.lower_j[k], a.lower_j[k], 2e-3 * all) << order << ' ' << k;
      EXPECT_LT(std::abs(product(b, k) - product(a, k)), 2e-3 * all) << order << ' ' << k;
    }
  }
}

// The deviation is of first order: half of the gradient moves energies and products half as far.
TEST(RefractedReceiverPairPatches, AGradientThatGoesToZeroLeavesIsovelocityWater) {
  Setting s = plates(false);
  s.samples = {1, 20, 1};
  const auto at = [&](double g) {
    return received_through(column_of({1500 - 4 * g, g, s.absorption_db_per_m}), s, receiver_pair, 1)
        .by_order[2];
  };
  const ReceiverPairEcho even = at(1e-9), whole = at(4), half = at(2);
  const auto expect_half = [](Complex none, Complex by_half, Complex by_whole) {
    const Complex moved = by_whole - none;
    EXPECT_GT(std::abs(moved), 1e-4 * std::abs(none));
    EXPECT_LT(std::abs(moved / (by_half - none) - 2.0), 0.1);
  };
  expect_half(even.upper_j[0], half.upper_j[0], whole.upper_j[0]);
  expect_half(even.lower_j[0], half.lower_j[0], whole.lower_j[0]);
  expect_half(product(even, 0), product(half, 0), product(whole, 0));
}

TEST(RefractedReceiverPairPatches, WithoutLengthAReceiverPairIsOneReceiver) {
  Setting s = scattered(3);
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0.4};
  const WaterColumn column = column_of({1500 + 180, -60, s.absorption_db_per_m});
  const PathEcho one = through(through_water(column, 1e-2), s);
  const ReceiverPairPathEcho both = received_through(column, s, {slanting_axis, 1e-8, 60});
  for (std::size_t order = 2; order <= 3; ++order) {
    const std::vector<double>& alone = one.by_order[order].energy;
    // If rounding cuts one more part, a range bin passes a small part of its energy to its neighbour.
    const double error = 1e-4 * *std::ranges::max_element(alone);
    EXPECT_GT(error, 0);
    for (std::size_t k = 0; k < alone.size(); ++k) {
      EXPECT_NEAR(both.by_order[order].upper_j[k], alone[k], error) << order << ' ' << k;
      EXPECT_NEAR(both.by_order[order].lower_j[k], alone[k], error) << order << ' ' << k;
      EXPECT_LT(std::abs(product(both.by_order[order], k) - alone[k]), error) << order << ' ' << k;
    }
  }
}

// A reversed receiver pair receives the same energies with the opposite phase.
TEST(RefractedReceiverPairPatches, ReceiversExchangePlaces) {
  const Setting s = scattered(3);
  const WaterColumn column = column_of({1500 - 180, 60, s.absorption_db_per_m});
  const ReceiverBaseline turned{-receiver_pair.axis, receiver_pair.baseline_m,
                                receiver_pair.wavenumber_rad_m};
  const ReceiverPairPathEcho there = received_through(column, s), back = received_through(column, s, turned);
  for (std::size_t order = 2; order <= 3; ++order) {
    const ReceiverPairEcho &a = there.by_order[order], &b = back.by_order[order];
    const double most = *std::ranges::max_element(a.upper_j);
    for (std::size_t k = 0; k < a.upper_j.size(); ++k) {
      EXPECT_NEAR(b.upper_j[k], a.lower_j[k], 1e-9 * most) << order << ' ' << k;
      EXPECT_NEAR(b.lower_j[k], a.upper_j[k], 1e-9 * most) << order << ' ' << k;
      // Both results are in the plane as the upper receiver sees it, and are cut into parts there.
      EXPECT_LT(std::abs(product(b, k) - std::conj(product(a, k))), 2e-3 * most) << order << ' ' << k;
    }
  }
}

// Each end receives the energy of a single receiver at its position, whose apparent seabed is computed from
// there. The difference is of the order of baseline times gradient over sound speed. After an exchange with
// the transmitter, energies differ by the square of the ratio of the sound speeds at the ends.
TEST(RefractedReceiverPairPatches, EitherEndIsAReceiverThereAndSoundComesBack) {
  Setting s = scattered(2, 0.3);
  s.receive = around({-0.25, -0.5, -3.5}, -89.99, 20, 3, 60, 4);
  const double g = -60;
  const Arcs arcs{1500 - 3 * g, g, s.absorption_db_per_m};
  const WaterColumn column = column_of(arcs);
  const ReceiverPairEcho both = received_through(column, s).by_order[2];
  const glm::dvec3 middle = metres(s.receive.apex);
  const double by_baseline = receiver_pair.baseline_m * -g / (arcs.c0 - middle.z * g);
  double received = 0, alone = 0;
  for (const double end : {1.0, -1.0}) {
    const glm::dvec3 place = middle + end * receiver_pair.baseline_m / 2 * receiver_pair.axis;
    const Echo by_end{1, s.samples.count, end > 0 ? both.upper_j : both.lower_j};
    Setting one = s;
    one.receive = around(place, -89.99, 20, 3, 60, 4);
    const Echo there = through(through_water(column, 1e-2), one).by_order[2];
    expect_near(by_end, there.energy, 1.5 * by_baseline, 1.5 * by_baseline, "alone");
    received += total(by_end);
    alone += total(there);
    std::swap(one.transmit, one.receive);
    const double speeds = std::pow((arcs.c0 + 2 * g) / (arcs.c0 - place.z * g), 2);
    std::vector<double> back = through(through_water(column, 1e-2), one).by_order[2].energy;
    for (double& energy : back) energy *= speeds;
    EXPECT_GT(speeds, 1.1);
    expect_near(by_end, back, 0.02, 0.02, "back");
  }
  EXPECT_NEAR(received, alone, 1e-3 * alone);
}

}  // namespace
}  // namespace tubefoot
