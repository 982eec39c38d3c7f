// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies of paths over mirrors in stratified water. The comparisons are closed forms of
// one gradient, the certified paths of isovelocity water, ordinary energies, and reciprocity.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "engine/certified/reference.hpp"
#include "fixtures/world/refracted_rays.hpp"

namespace tubefoot {
namespace {

using namespace test;

PathEcho certified(const PathWater& water, Setting s, double tolerance,
                   const BeamPatterns* patterns = nullptr) {
  s.paths.reference_tolerance = tolerance;
  return through(water, s, patterns);
}

struct Both {
  double energies = 0, bounds = 0;
};
/// Sums of one order.
Both sums_of(const PathEcho& found, std::size_t order) {
  Both sums;
  for (std::size_t k = 0; k < found.by_order[order].energy.size(); ++k) {
    sums.energies += found.by_order[order].energy[k];
    sums.bounds += found.bound_by_order[order][k];
  }
  return sums;
}

/// Two references of the same value must agree within their bounds.
void expect_agree(const PathEcho& a, const PathEcho& b, double scale = 1, double rounding = 1e-9) {
  ASSERT_EQ(a.by_order.size(), b.by_order.size());
  for (std::size_t order = 0; order < a.by_order.size(); ++order) {
    const double all = sums_of(a, order).energies;
    for (std::size_t k = 0; k < a.by_order[order].energy.size(); ++k)
      EXPECT_LE(std::abs(a.by_order[order].energy[k] - scale * b.by_order[order].energy[k]),
                a.bound_by_order[order][k] + scale * b.bound_by_order[order][k] + rounding * all)
          << "order " << order << " sample " << k;
  }
}

/// furnished() with few range bins and tubes: a plate that is a mirror and a wall. The loose facets are
/// absent. One of them rises above the depth of the sonar, so that no ray to it is proven.
Setting few(bool apart) {
  Setting s = furnished(apart);
  constexpr std::size_t conservative = 2;
  s.mesh.facets.resize(s.mesh.facets.size() - conservative);
  s.mesh.material.resize(s.mesh.facets.size());
  s.mesh.component.resize(s.mesh.facets.size());
  s.transmit = around({0, 0, -5}, -86, 86, 2, 90);
  s.receive = apart ? around({2, -3, -7}, -86, 86, 2, 90) : s.transmit;
  s.samples = {1, 4, 8};
  s.paths.mirrors.surface->roughness = 0.8;
  return s;
}

// Rings of a flat seabed: an energy that moves by twice the bound lies outside the bound.
TEST(RefractedPathBounds, HoldTheSurfaceMultiplesOfOneGradient) {
  for (const auto& [g, roughness, widest] : {std::tuple(-0.6, 0.0, 0.08), std::tuple(0.5, 2.5, 0.35)}) {
    SCOPED_TRACE(fmt::format("g {} roughness {}", g, roughness));
    Setting s = under_surface(3);
    s.mesh = square_seabed(-20, 60);
    s.paths.mirrors.surface->roughness = roughness;
    s.samples = {27, 4, 4};
    const WaterColumn column = gradient(g, 1510);
    const PathEcho found = certified(water_of(column, 2e-2), s, 1e-2);
    const SurfaceMultiples rings{{1510, g}, roughness};
    double closest = 0;
    for (std::size_t order = 2; order < 4; ++order)
      for (int k = 0; k < 4; ++k) {
        const double from = 27 + 4 * k,
                     truth = order == 2 ? rings.once(from, from + 4) : rings.twice(from, from + 4),
                     energy = found.by_order[order].at(0, k), bound = found.bound_by_order[order][k];
        EXPECT_LE(std::abs(energy - truth), bound + 1e-8 * truth) << order << ' ' << k;
        EXPECT_GT(std::abs(energy + 2 * bound - truth), bound - 1e-8 * truth) << order << ' ' << k;
        EXPECT_LT(bound, widest * truth) << order << ' ' << k;
        closest = std::max(closest, std::abs(energy - truth) / bound);
      }
    EXPECT_GT(closest, 0.02);
  }
}

// The energies of two complementary sets of tubes add up to those of all tubes.
TEST(RefractedPathBounds, WhatTubesHearAddsUp) {
  const WaterColumn column = gradient(-0.7, 1510);
  Setting s = under_surface(2);
  s.mesh = square_seabed(-20, 40);
  s.transmit = s.receive = around({0, 0, -5}, -88, 88, 2, 90);
  s.samples = {24, 5, 3};
  const PathEcho all = certified(water_of(column, 3e-2), s, 1e-2);
  std::vector<double> energy(3), bound(3);
  for (const int rest : {0, 1}) {
    Setting part = s;  // every second tube
    part.receive.tubes.clear();
    for (std::size_t tube = std::size_t(rest); tube < s.receive.tubes.size(); tube += 2)
      part.receive.tubes.push_back(s.receive.tubes[tube]);
    const PathEcho own = certified(water_of(column, 3e-2), part, 1e-2);
    for (std::size_t k = 0; k < 3; ++k) {
      energy[k] += own.by_order[2].energy[k];
      bound[k] += own.bound_by_order[2][k];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LE(std::abs(all.by_order[2].energy[k] - energy[k]), all.bound_by_order[2][k] + bound[k]) << k;
    EXPECT_LT(bound[k], 0.5 * energy[k]) << k;
  }
}

// In isovelocity water the references equal those of isovelocity water, with images by planes.
TEST(RefractedPathBounds, IsovelocityWaterIsTheStraightReference) {
  const WaterColumn even{SoundSpeedProfile({{0, c_ref}, {60, c_ref}}), {1e-5, 1e-5, 1e-5}};
  for (const bool apart : {false, true}) {
    SCOPED_TRACE(apart);
    Setting s = few(apart);
    s.absorption_db_per_m = 1e-5;
    const PathEcho refracted = certified(water_of(even, 1), s, 1e-3);
    s.paths.reference_tolerance = 1e-5;
    const PathEcho straight = s.run();
    EXPECT_EQ(refracted.arrivals, straight.arrivals);
    expect_agree(refracted, straight, 1, 3e-6);
    for (const std::size_t order : {2, 3}) {
      EXPECT_GT(sums_of(refracted, order).energies, 0);
      EXPECT_LT(sums_of(refracted, order).bounds, 0.02 * sums_of(refracted, order).energies) << order;
    }
  }
}

// The deviation from those references is of first order in the gradient, and bounds shrink with it.
TEST(RefractedPathBounds, AGradientThatGoesToZeroLeavesTheImageSeries) {
  Setting s = under_surface(3);
  s.mesh = FacetMesh();
  for (double x = -60; x < 60; x += 10)
    for (double y = -60; y < 60; y += 10)
      add_quad(s.mesh, {x, y, -20}, {x + 10, y, -20}, {x + 10, y + 10, -20}, {x, y + 10, -20});
  s.transmit = s.receive = around({0, 0, -5}, -88, 88, 2, 90);
  s.samples = {27, 4, 4};
  const auto at = [&](double g) {
    const WaterColumn column = gradient(g, 1500 - 5 * g);  // 1500 m/s at the sonar
    return certified(water_of(column, 1), s, 1e-4);
  };
  s.paths.reference_tolerance = 1e-7;
  const PathEcho straight = s.run(), whole = at(4e-2), half = at(2e-2), least = at(2e-5);
  for (const std::size_t order : {2, 3}) {
    EXPECT_LT(sums_of(least, order).bounds, 1e-3 * sums_of(least, order).energies) << order;
    EXPECT_LT(sums_of(half, order).bounds, 0.6 * sums_of(whole, order).bounds) << order;
    for (int k = 0; k < 4; ++k) {
      const double even = straight.by_order[order].at(0, k);
      const auto moved = [&](const PathEcho& refracted) { return refracted.by_order[order].at(0, k) - even; };
      EXPECT_LE(std::abs(moved(least)), least.bound_by_order[order][k] + 2e-5 * even);
      EXPECT_LE(std::abs(moved(whole) - 2 * moved(half)),
                whole.bound_by_order[order][k] + 2 * half.bound_by_order[order][k] + 1e-6 * even)
          << order << ' ' << k;
    }
  }
}

// The scene has walls and a plate that is a mirror. Bounds of a coarse apparent map contain the ordinary
// energies of a fine map, also after an exchange of transmitter and receiver.
TEST(RefractedPathBounds, HoldOrdinaryEnergiesAndThoseOfExchangedEnds) {
  const WaterColumn column = gradient(-0.7, 1510, 0.02);
  Setting s = few(true);
  s.absorption_db_per_m = 0.02;
  const PathEcho ordinary = through(water_of(column, 2e-4), s),
                 found = certified(water_of(column, 3e-2), s, 1e-2);
  EXPECT_EQ(found.arrivals, ordinary.arrivals);
  for (std::size_t order = 0; order < ordinary.by_order.size(); ++order) {
    const Both sums = sums_of(found, order);
    EXPECT_TRUE(std::isfinite(sums.bounds)) << order;
    for (std::size_t k = 0; k < ordinary.by_order[order].energy.size(); ++k) {
      const double plain = ordinary.by_order[order].energy[k], energy = found.by_order[order].energy[k],
                   bound = found.bound_by_order[order][k], off = 1e-3 * plain + 1e-9 * sums.energies;
      EXPECT_LE(std::abs(energy - plain), bound + off) << order << ' ' << k;
      if (energy > 0) {
        EXPECT_GT(std::abs(energy + 2 * bound - plain), bound - off) << order << ' ' << k;
      }
    }
  }
  Setting back = s;
  std::swap(back.transmit, back.receive);
  expect_agree(found, certified(water_of(column, 3e-2), back, 1e-2),
               std::pow((1510 - 0.7 * 5) / (1510 - 0.7 * 7), 2));
}

// Patterns of both ends act in the directions in which rays start and arrive.
TEST(RefractedPathBounds, HoldOrdinaryEnergiesOfPatterns) {
  const WaterColumn column = gradient(-0.7, 1510);
  Setting s = under_surface(2);
  s.mesh = square_seabed(-20, 24);
  s.transmit = s.receive = around({0, 0, -5}, -88, 88, 2, 90);
  s.samples = {24, 6, 1};
  BeamPatterns patterns;
  patterns.transmit = {TransmitPattern({.kind = Directivity::Kind::line, .axis = {0, 0, 1}, .size = 2})};
  patterns.receive = {{Directivity::Kind::gaussian, {0.6, 0, -0.8}, true, 0, 0.8}};
  patterns.fan_of_tube.assign(s.receive.tubes.size(), 0);
  patterns.beams_of_tube.assign(s.receive.tubes.size(), {0, 1});
  const PathEcho ordinary = through(water_of(column, 2e-4), s, &patterns),
                 found = certified(water_of(column, 3e-2), s, 1e-2, &patterns);
  EXPECT_LT(sums_of(found, 2).bounds, sums_of(found, 2).energies);
  EXPECT_LE(std::abs(found.by_order[2].at(0, 0) - ordinary.by_order[2].at(0, 0)),
            found.bound_by_order[2][0] + 1e-3 * ordinary.by_order[2].at(0, 0));
}

}  // namespace
}  // namespace tubefoot
