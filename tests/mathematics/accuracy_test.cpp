// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the error of the mathematical functions that all computations use (cmake/mathematics.cmake),
// relative to MPFR.
#include <gtest/gtest.h>
#include <mpfr.h>

#include <cmath>
#include <random>

extern "C" double exp10(double);

namespace {

// Proofs assume 8 (geometry/numbers/interval.hpp, docs/notes/certified-energies.md).
constexpr double units_allowed = 4;
constexpr int trials = 5000;

class Wide {
 public:
  explicit Wide(double value) {
    mpfr_init2(value_, 200);
    mpfr_set_d(value_, value, MPFR_RNDN);
  }
  ~Wide() { mpfr_clear(value_); }
  Wide(const Wide&) = delete;
  Wide& operator=(const Wide&) = delete;
  operator mpfr_ptr() { return value_; }

 private:
  mpfr_t value_;
};

/// Error in units in the last place of the double nearest to the exact value.
double units_off(Wide& truth, double value) {
  const double nearest = mpfr_get_d(truth, MPFR_RNDN);
  if (!std::isfinite(nearest) || !std::isfinite(value))
    return nearest == value || (std::isnan(nearest) && std::isnan(value)) ? 0 : INFINITY;
  const double unit = std::max(std::ldexp(1, std::ilogb(nearest) - 52), std::ldexp(1, -1074));
  mpfr_sub_d(truth, truth, value, MPFR_RNDN);
  return std::abs(mpfr_get_d(truth, MPFR_RNDN)) / unit;
}

struct Range {
  double lo, hi;
  bool of_all_sizes = false;
};

template <class Random>
double drawn(const Range& range, Random& random) {
  if (!range.of_all_sizes) return std::uniform_real_distribution<double>(range.lo, range.hi)(random);
  return std::exp2(std::uniform_real_distribution<double>(std::log2(range.lo), std::log2(range.hi))(random));
}

using Function = double (*)(double);
using True = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);

void expect_near(const char* name, Function function, True truth, std::initializer_list<Range> ranges) {
  std::mt19937_64 random(1);
  double worst = 0;
  for (const Range& range : ranges)
    for (int trial = 0; trial < trials; ++trial) {
      const double x = drawn(range, random);
      Wide wide(x);
      truth(wide, wide, MPFR_RNDN);
      worst = std::max(worst, units_off(wide, function(x)));
    }
  EXPECT_LE(worst, units_allowed) << name;
}

using Function2 = double (*)(double, double);
using True2 = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

void expect_near(const char* name, Function2 function, True2 truth, const Range& of_x, const Range& of_y) {
  std::mt19937_64 random(1);
  double worst = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const double x = drawn(of_x, random), y = drawn(of_y, random);
    Wide wide(x), other(y);
    truth(wide, wide, other, MPFR_RNDN);
    worst = std::max(worst, units_off(wide, function(x, y)));
  }
  EXPECT_LE(worst, units_allowed) << name;
}

constexpr Range turn{-3.2, 3.2}, far{-1e5, 1e5}, sine{-1, 1}, little{-0.7, 0.7}, any{1e-30, 1e30, true},
    exponent{-700, 700};

TEST(MathematicalFunctions, AreNearTheTruth) {
  expect_near("sin", std::sin, mpfr_sin, {turn, far, {1e5, 1e300, true}});
  expect_near("cos", std::cos, mpfr_cos, {turn, far, {1e5, 1e300, true}});
  expect_near("tan", std::tan, mpfr_tan, {turn, far});
  expect_near("asin", std::asin, mpfr_asin, {sine, {1e-9, 1, true}});
  expect_near("acos", std::acos, mpfr_acos, {sine, {1e-9, 1, true}});
  expect_near("atan", std::atan, mpfr_atan, {turn, far});
  expect_near("sinh", std::sinh, mpfr_sinh, {turn, exponent});
  expect_near("cosh", std::cosh, mpfr_cosh, {turn, exponent});
  expect_near("tanh", std::tanh, mpfr_tanh, {turn, {-20, 20}});
  expect_near("asinh", std::asinh, mpfr_asinh, {turn, far});
  expect_near("acosh", std::acosh, mpfr_acosh, {{1, 100}});
  expect_near("atanh", std::atanh, mpfr_atanh, {sine});
  expect_near("exp", std::exp, mpfr_exp, {little, exponent, {-745, -700}});
  expect_near("exp2", std::exp2, mpfr_exp2, {little, exponent});
  expect_near("exp10", ::exp10, mpfr_exp10, {little, {-300, 300}});
  expect_near("expm1", std::expm1, mpfr_expm1, {little, exponent, {1e-20, 1, true}});
  expect_near("log", std::log, mpfr_log, {{0.5, 2}, any});
  expect_near("log2", std::log2, mpfr_log2, {{0.5, 2}, any});
  expect_near("log10", std::log10, mpfr_log10, {{0.5, 2}, any});
  expect_near("log1p", std::log1p, mpfr_log1p, {little, any});
  expect_near("cbrt", std::cbrt, mpfr_cbrt, {far, any});
  expect_near("erf", std::erf, mpfr_erf, {turn});
  expect_near("erfc", std::erfc, mpfr_erfc, {turn});
  expect_near("atan2", std::atan2, mpfr_atan2, far, far);
  expect_near("pow", std::pow, mpfr_pow, {1e-3, 1e3, true}, {-20, 20});
  expect_near("hypot", std::hypot, mpfr_hypot, far, any);
}

// The compiler may combine a sine and a cosine of one angle into one call.
TEST(MathematicalFunctions, GiveTheSameInPairs) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < trials; ++trial) {
    const double x = drawn(far, random);
    double sine_of_pair = 0, cosine_of_pair = 0;
    sincos(x, &sine_of_pair, &cosine_of_pair);
    EXPECT_EQ(sine_of_pair, std::sin(x));
    EXPECT_EQ(cosine_of_pair, std::cos(x));
  }
}

}  // namespace
