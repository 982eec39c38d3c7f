// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <string>
#include <vector>

// Integers of any length and fractions of them. One operation on millions of digits takes many seconds: those
// of this file can be stopped in their middle (geometry/steps/long_call.hpp). Heavy: include only in .cpp
// files.
namespace tubefoot {

using Integer = boost::multiprecision::mpz_int;

/// Not reduced: a sum of many costs products, not greatest common divisors.
struct Fraction {
  Integer numerator = 0, denominator = 1;
};

Integer product(const Integer& a, const Integer& b);
/// As a balanced tree.
Fraction sum(const std::vector<Fraction>& terms);
bool equal(const Fraction& a, const Fraction& b);
/// With a denominator above 0 and no common divisor.
Fraction reduced(const Fraction& fraction);
/// Numerator and denominator scaled to what a double holds.
double ratio(const Integer& numerator, const Integer& denominator);
/// Its decimal digits.
std::string digits_of(const Integer& a);

}  // namespace tubefoot
