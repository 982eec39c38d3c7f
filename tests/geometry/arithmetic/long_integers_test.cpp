// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/long_integers.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

struct LongIntegers : testing::Test {
  ~LongIntegers() override { stop_requested = false; }
};

/// Returns 2^bits - 1.
Integer ones(unsigned bits) { return (Integer(1) << bits) - 1; }

TEST_F(LongIntegers, AreThoseOfShortOperations) {
  for (const unsigned bits : {10u, 3'000'000u}) {
    const Integer a = ones(bits), b = ones(bits / 2) * 3;
    EXPECT_TRUE(product(a, b) == a * b);
    EXPECT_TRUE(product(-a, b) == -(a * b));
    const Fraction half = reduced({a * 7, a * -14});
    EXPECT_EQ(half.numerator, -1);
    EXPECT_EQ(half.denominator, 2);
    EXPECT_TRUE(equal({a, a * 2}, {1, 2}));
    const Fraction all = sum({{a, a * 4}, {1, 4}, {a * 2, a * 4}});
    EXPECT_TRUE(all.numerator == all.denominator);
    EXPECT_EQ(ratio(a, a * 8), 0.125);
  }
  EXPECT_EQ(digits_of(Integer(-120)), "-120");
  EXPECT_TRUE(sum({}).numerator == 0);
  EXPECT_EQ(reduced({0, -5}).denominator, 1);
}

// The greatest common divisor of random numbers of 200 million bits takes minutes. That of quotients of
// powers of two takes a few steps.
TEST_F(LongIntegers, CanBeStoppedInTheMiddleOfAnOperation) {
  gmp_randstate_t random;
  gmp_randinit_mt(random);
  gmp_randseed_ui(random, 20261128);
  Integer a, b;
  for (Integer* number : {&a, &b}) mpz_urandomb(number->backend().data(), random, 200'000'000);
  gmp_randclear(random);
  std::thread asks([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop_requested = true;
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(reduced({a, b}), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  asks.join();
}

}  // namespace
}  // namespace tubefoot
