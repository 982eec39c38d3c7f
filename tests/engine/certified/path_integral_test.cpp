// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the certified bistatic integrals of two apexes in doubles. It compares them with the same integrals
// in ball arithmetic of 128 bits.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "engine/certified/certified_path_energy.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"

namespace tubefoot {
namespace {

/// Hides the evaluation in intervals of an integrand, so that an integrator uses its evaluation in balls.
class InBalls : public CertifiedIntegrand {
 public:
  explicit InBalls(CertifiedIntegrand& own) : own_(own) {}
  std::size_t values() const override { return own_.values(); }
  double scale_m(const PlanePlace<Ball>& place) const override { return own_.scale_m(place); }
  void at(const PlanePlace<Ball>& place, std::vector<Ball>& values) const override { own_.at(place, values); }
  bool take(const PlanePlace<Ball>& box, std::vector<double>& off) override { return own_.take(box, off); }
  void take_whole() override { own_.take_whole(); }
  void log_bounds(const PlanePlace<ComplexBall>& place, std::vector<double>& bounds) const override {
    own_.log_bounds(place, bounds);
  }

 private:
  CertifiedIntegrand& own_;
};

/// A triangle 5 m below two apexes, in coordinates about the foot point of the first apex.
struct TriangleSeabed {
  TriangleSeabed() {
    plane.distance = Ball(5);
    plane.u = {Ball(1), Ball(0), Ball(0)};
    plane.v = {Ball(0), Ball(1), Ball(0)};
    plane.away = {Ball(0), Ball(0), Ball(-1)};
    polygon = part_of(plane, {{Ball(1.5), Ball(-0.5)}, {Ball(4), Ball(0.25)}, {Ball(2), Ball(1.75)}});
    const auto axis = [](double x, double y, double z) { return glm::normalize(glm::dvec3(x, y, z)); };
    using Kind = Directivity::Kind;
    patterns.emplace_back();
    for (const double centre : {-0.9, -0.3, 0.0, 0.4})
      patterns.push_back({Kind::line, axis(1, 0.1, 0.05), false, centre, 12});
    patterns.push_back({Kind::gaussian, axis(0.3, 0.1, -1), true, 0, 0.4});
    patterns.push_back({Kind::gaussian, axis(1, -0.2, 0.1), false, 0.35, 0.5});
    patterns.push_back({Kind::piston, axis(0.2, 0.3, -1), true, 0, 6});
    patterns.push_back({Kind::line, axis(1, 0.1, 0.05), false, 0.2, 12, 0.6});
    patterns.push_back({Kind::table, axis(0.3, 0.1, -1), true, 0, 0, 0,
                        std::make_shared<PatternTable>(std::vector<double>{0, 0.2, 0.5, 1.2},
                                                       std::vector<double>{0, -3, -14, -22})});
    transmit.beams = {patterns[1], patterns[5]};
    echo.path.tx.loss = {0.5, {axis(0.1, 0, 1)}, 1.5, 0};
    echo.path.rx.emplace();
    echo.path.rx->loss = {0.8, {axis(0, 0.1, 1), axis(0, 0, 1)}, 0.5, 0.05};
  }
  CertifiedPathIntegrand integrand(const ScatteringModel* model) const {
    const SurfaceProperties seabed{1, 0.01, model};
    const CertifiedPathEnergy energy(polygon, rx_m, echo, seabed, Ball(0.01));
    return {energy, {energy.tx(), energy.rx(), transmit, patterns}, nullptr};
  }

  CertifiedPolygon plane, polygon;
  std::array<Ball, 3> rx_m{Ball(1.25), Ball(-0.5), Ball(0.75)};
  std::vector<Directivity> patterns;
  TransmitPattern transmit;
  std::vector<double> mu{0.01};
  std::vector<std::uint16_t> material{0};
  EchoModel echo{mu, material, 0.04, nullptr};
};

std::vector<ScatteringModel> path_models() {
  return {ScatteringModel::gsab({0.1, 0.2, 0.02, 1.7, 0.01, 0.6}),
          ScatteringModel::table(std::vector<double>{20, 50, 80}, std::vector<double>{-30, -22, -12})};
}

TEST(PathIntegral, IntervalsHoldWhatBallsSayOfEveryPlace) {
  std::mt19937_64 random(27);
  std::uniform_real_distribution<double> x(-3, 6), y(-4, 4), part(0, 1), decades(-12, 0);
  const TriangleSeabed seabed;
  std::vector<ScatteringModel> all = path_models();
  for (const ScatteringModel* model : std::vector<const ScatteringModel*>{nullptr, &all[0], &all[1]}) {
    CertifiedPathIntegrand integrand = seabed.integrand(model);
    integrand.take_whole();
    std::vector<Interval> held;
    std::vector<Ball> there;
    for (int trial = 0; trial < 300; ++trial) {
      const double from_x = x(random), from_y = y(random), size = std::pow(10, decades(random));
      ASSERT_TRUE(integrand.at({Interval(from_x, from_x + size), Interval(from_y, from_y + size)}, held));
      for (int inner = 0; inner < 3; ++inner) {
        integrand.at({Ball(from_x + part(random) * size), Ball(from_y + part(random) * size)}, there);
        for (std::size_t v = 0; v < there.size(); ++v) {
          EXPECT_LE(held[v].lo, there[v].hi()) << "seed 27, trial " << trial << ", value " << v;
          EXPECT_GE(held[v].hi, there[v].lo()) << "seed 27, trial " << trial << ", value " << v;
        }
      }
    }
    // At single points the intervals are no wider than the rounding errors.
    for (int trial = 0; trial < 100; ++trial) {
      const double at_x = x(random), at_y = y(random);
      integrand.at({Interval(at_x), Interval(at_y)}, held);
      for (const Interval& value : held) EXPECT_LE(value.width(), 1e-10 * std::abs(value.hi) + 1e-17);
    }
  }
}

TEST(PathIntegral, DoublesMeetBallsAndKeepWhatIsRequested) {
  TriangleSeabed seabed;
  // the integrand is not analytic where the cubics of the table meet: the integrator bisects to the work
  // limit
  seabed.patterns.pop_back();
  std::vector<ScatteringModel> all = path_models();
  const std::vector<double> borders{5.5, 5.75, 6};
  for (const ScatteringModel* model : std::vector<const ScatteringModel*>{nullptr, &all[0]})
    for (const double tolerance : {1e-3, 1e-8}) {
      if (model != nullptr && tolerance < 1e-3) continue;
      CertifiedPathIntegrand integrand = seabed.integrand(model);
      InBalls in_balls(integrand);
      const ApexOverPlane tx{Ball(5), Ball(0), Ball(0)}, rx = apex_over(seabed.polygon, seabed.rx_m);
      const auto integrate = [&](CertifiedIntegrand& what) {
        CertifiedPathIntegrator integrator(borders);
        std::vector<std::vector<Interval>> found(borders.size() - 1);
        integrator.add(seabed.polygon, tx, {&rx, 1}, what,
                       {tolerance, [](std::size_t, std::size_t) { return 1e-18; }},
                       [&](std::size_t sample, std::span<const Interval> values) {
                         found[sample].assign(values.begin(), values.end());
                       });
        return found;
      };
      const auto fast = integrate(integrand), sure = integrate(in_balls);
      int lit = 0;
      for (std::size_t k = 0; k < fast.size(); ++k) {
        ASSERT_EQ(fast[k].size(), sure[k].size());
        for (std::size_t v = 0; v < fast[k].size(); ++v) {
          const Interval &a = fast[k][v], &b = sure[k][v];
          EXPECT_LE(std::max(a.lo, b.lo), std::min(a.hi, b.hi)) << k << ' ' << v << ' ' << tolerance;
          EXPECT_LE(a.width(), 2.1 * tolerance * a.hi + 1e-15 * a.hi + 1e-17) << k << ' ' << v;
          if (!(a.hi > 1e-12)) continue;
          ++lit;
          // The interval does not contain a value that is moved by twice the bound.
          EXPECT_GT(std::abs(b.middle() - a.middle() - 1.05 * (a.width() + b.width())),
                    (a.width() + b.width()) / 2);
        }
      }
      EXPECT_GT(lit, 10);
    }
}

}  // namespace
}  // namespace tubefoot
