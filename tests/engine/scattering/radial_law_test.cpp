// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the range-dependent factors of a Lambert echo. They are computed once for the range bins of a
// sensor and shared. Stored values equal new ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/scattering/density.hpp"
#include "engine/scattering/echo_model.hpp"
#include "engine/scattering/radial_model.hpp"

namespace tubefoot {
namespace {

RadialIntegral made_anew(const RangeSamples& samples, double absorption_db_per_m) {
  const double beta = absorption_per_m(absorption_db_per_m);
  return RadialIntegral(sample_borders_m(samples),
                        [beta](double r) { return lambert_density(TwoWayRange<double>::of(r), beta); });
}

void expect_same(const RadialIntegral& a, const RadialIntegral& b) {
  ASSERT_EQ(a.samples(), b.samples());
  ASSERT_EQ(a.cells().size(), b.cells().size());
  for (std::size_t k = 0; k < a.cells().size(); ++k) {
    const RadialIntegral::Cell &p = a.cells()[k], &q = b.cells()[k];
    EXPECT_EQ(p.lo, q.lo);
    EXPECT_EQ(p.hi, q.hi);
    EXPECT_EQ(p.sample, q.sample);
    EXPECT_EQ(p.degree, q.degree);
    EXPECT_EQ(std::memcmp(&p.primitive, &q.primitive, sizeof p.primitive), 0) << k;
    EXPECT_EQ(std::memcmp(&p.whole, &q.whole, sizeof p.whole), 0) << k;
  }
}

TEST(RadialModel, IsMadeOnceAndIsWhatWouldBeMadeAnew) {
  const RangeSamples samples{1.5, 0.04, 700};
  const auto first = lambert_radial_integral(samples, 0.06);
  EXPECT_EQ(lambert_radial_integral(samples, 0.06), first);
  expect_same(*first, made_anew(samples, 0.06));
}

// The key contains each input of the computation, to the last bit.
TEST(RadialModel, IsThatOfItsOwnSamplesAndAbsorption) {
  const RangeSamples samples{2, 0.05, 300};
  const auto one = lambert_radial_integral(samples, 0.06);
  const RangeSamples later{std::nextafter(samples.first_m, 3), samples.step_m, samples.count},
      longer{samples.first_m, std::nextafter(samples.step_m, 1), samples.count},
      fewer{samples.first_m, samples.step_m, samples.count - 1};
  for (const RangeSamples& other : {later, longer, fewer}) {
    const auto found = lambert_radial_integral(other, 0.06);
    EXPECT_NE(found, one);
    expect_same(*found, made_anew(other, 0.06));
  }
  const double more = std::nextafter(0.06, 1);
  expect_same(*lambert_radial_integral(samples, more), made_anew(samples, more));
  EXPECT_EQ(lambert_radial_integral(samples, 0.06), one);
}

TEST(RadialModel, IsForgottenWhenManyOthersHaveBeenRequested) {
  const RangeSamples samples{3, 0.05, 500}, large{20, 0.001, 50000};
  const std::weak_ptr<const RadialIntegral> kept = lambert_radial_integral(samples, 0.01);
  EXPECT_FALSE(kept.expired());
  for (int k = 1; k <= 4; ++k) {
    SCOPED_TRACE(k);
    const auto other = lambert_radial_integral(large, 0.01 * k);
    if (k == 1) {
      EXPECT_FALSE(kept.expired());
    }
  }
  EXPECT_TRUE(kept.expired()) << "four of 50000 samples are more than " << most_cells_kept;
  expect_same(*lambert_radial_integral(samples, 0.01), made_anew(samples, 0.01));
}

TEST(RadialModel, IsKeptWhereOneAloneIsMoreThanIsKept) {
  const RangeSamples huge{100, 0.001, static_cast<int>(most_cells_kept) + 1};
  const auto one = lambert_radial_integral(huge, 0.02);
  EXPECT_EQ(lambert_radial_integral(huge, 0.02), one);
}

TEST(RadialModel, RefusesWhatHasNoExtentEachTime) {
  for (int k = 0; k < 2; ++k) {
    EXPECT_THROW(lambert_radial_integral({1, 0, 5}, 0), std::invalid_argument);
    EXPECT_THROW(lambert_radial_integral({1, 1, 0}, 0), std::invalid_argument);
    EXPECT_THROW(lambert_radial_integral({-1, 1, 5}, 0), std::invalid_argument);
  }
}

TEST(RadialModel, IsTheSameForThreadsThatAskAtOnce) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([t] {
      for (int k = 0; k < 40; ++k) {
        const RangeSamples samples{1 + (k + t) % 5 * 0.5, 0.1, 60};
        expect_same(*lambert_radial_integral(samples, 0.03), made_anew(samples, 0.03));
      }
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace tubefoot
