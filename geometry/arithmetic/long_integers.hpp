// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// Integers of any length and fractions of them. One operation on millions of digits takes many seconds. The
// operations of this file can be stopped while they run (geometry/steps/long_call.hpp). This header is
// expensive to compile: include it only in .cpp files.
namespace tubefoot {

using Integer = boost::multiprecision::mpz_int;

/// A fraction that is not reduced. The sum of many fractions therefore needs products but no greatest common
/// divisors.
struct Fraction {
  Integer numerator = 0, denominator = 1;
};

Integer product(const Integer& a, const Integer& b);
/// Adds the terms as a balanced tree.
Fraction sum(const std::vector<Fraction>& terms);
/// Adds `count` terms as a balanced tree. Returns nothing if the denominator of a part of the sum has more
/// than `bits` bits.
std::optional<Fraction> sum_within(std::size_t count, const std::function<Fraction(std::size_t)>& term,
                                   std::size_t bits);
bool equal(const Fraction& a, const Fraction& b);
/// Returns the fraction with a denominator above 0 and without a common divisor.
Fraction reduced(const Fraction& fraction);
/// Returns the quotient as a double. Numerator and denominator are first scaled to the range of a double.
double ratio(const Integer& numerator, const Integer& denominator);
/// Returns the decimal digits of a.
std::string digits_of(const Integer& a);

}  // namespace tubefoot
