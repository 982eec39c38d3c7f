// SPDX-License-Identifier: GPL-3.0-or-later
// Tests integers of 128 and 192 bits: products, sums and dot products equal those of big integers, and
// conversions to doubles are accurate.

#include "geometry/numbers/wide_int.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <limits>
#include <random>
#include <vector>

namespace tubefoot {
namespace {

using Big = boost::multiprecision::cpp_int;
using Random = std::mt19937_64;

Big big(const Int192& x) { return (Big(x.high) << 128) + (Big(x.mid) << 64) + x.low; }

/// Two's complement of any integer of up to 191 bits and sign.
Int192 narrow(Big x) {
  if (x < 0) x += Big(1) << 192;
  const auto limb = [&](int k) { return static_cast<std::uint64_t>((x >> (64 * k)) & ~std::uint64_t{0}); };
  return {limb(0), limb(1), static_cast<std::int64_t>(limb(2))};
}

/// Log-uniform integer of up to `bits` bits with any sign, with runs of zeros and ones, near powers of two.
Big number(Random& random, int bits) {
  const int top = static_cast<int>(random() % (bits + 1));
  Big x = 0;
  for (int k = 0; k < 4; ++k) x = (x << 64) + random();
  x &= (Big(1) << top) - 1;
  switch (random() % 4) {
    case 0:
      x = (Big(1) << top) - 1;
      break;
    case 1:
      x = top < bits ? Big(1) << top : Big((Big(1) << top) - 1);
      break;
    default:
      break;
  }
  return random() % 2 ? Big(-x) : x;
}

// Law W3.
TEST(WideInt, ProductsEqualBigIntegers) {
  Random random(1);
  for (int k = 0; k < 200000; ++k) {
    const Big a = number(random, 126), b = number(random, 63);
    const Int192 product = multiply(a.convert_to<Int128>(), b.convert_to<std::int64_t>());
    ASSERT_EQ(big(product), a * b) << "seed 1, case " << k;
    ASSERT_EQ(product.sign(), Big(a * b).sign()) << a << " * " << b;
  }
}

// Law W3.
TEST(WideInt, SumsEqualBigIntegers) {
  Random random(2);
  for (int k = 0; k < 200000; ++k) {
    const Big a = number(random, 190), b = k % 8 == 0   ? Big(-a)
                                           : k % 8 == 1 ? Big(1 - a)
                                                        : number(random, 190);
    Int192 sum = narrow(a);
    ASSERT_EQ(big(sum), a);
    sum += narrow(b);
    ASSERT_EQ(big(sum), a + b) << "seed 2, case " << k;
    ASSERT_EQ(sum.sign(), Big(a + b).sign()) << a << " + " << b;
  }
}

TEST(WideInt, DotProductsOfTheLargestVectorsFit) {
  // |n1 x n2| < 2^123 and a facet normal <= 2^62: the largest sum that the kernel computes.
  const Int128 v = (Int128(1) << 123) - 1;
  const std::int64_t n = std::int64_t{1} << 62;
  for (const int signs : {0, 1, 2, 3, 4, 5, 6, 7}) {
    Int192 sum{};
    Big expected = 0;
    for (int k = 0; k < 3; ++k) {
      const int sign = signs >> k & 1 ? -1 : 1;
      sum += multiply(sign * v, n);
      expected += sign * ((Big(1) << 123) - 1) * n;
    }
    EXPECT_EQ(big(sum), expected);
    EXPECT_EQ(sum.sign(), expected.sign());
  }
}

// Law W3.
TEST(WideInt, DoublesAreWithinTwoUnitsInTheLastPlace) {
  Random random(3);
  for (int k = 0; k < 200000; ++k) {
    const Big a = number(random, 190);
    const double expected = a.convert_to<double>(), got = narrow(a).to_double();
    ASSERT_LE(std::abs(got - expected), 2 * std::numeric_limits<double>::epsilon() * std::abs(expected))
        << "seed 3, case " << k << ": " << a;
  }
}

TEST(WideInt, WideningKeepsTheNumber) {
  Random random(4);
  for (int k = 0; k < 100000; ++k) {
    const Big a = number(random, 127);
    ASSERT_EQ(Big(widen(a.convert_to<Int128>())), a) << "seed 4, case " << k;
    ASSERT_EQ(sign(a.convert_to<Int128>()), a.sign());
  }
}

}  // namespace
}  // namespace tubefoot
