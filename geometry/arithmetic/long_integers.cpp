// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/long_integers.hpp"

#include <cmath>

#include "geometry/steps/long_call.hpp"

namespace tubefoot {
namespace {

/// Below this number of bits an operation takes less than some hundredths of a second.
constexpr std::size_t long_bits = std::size_t{1} << 20;

std::size_t bits_of(const Integer& a) { return mpz_sizeinbase(a.backend().data(), 2); }

Fraction sum_of(const std::vector<Fraction>& terms, std::size_t begin, std::size_t end) {
  if (begin == end) return {};
  if (end - begin == 1) return terms[begin];
  stop_if_wanted();
  const std::size_t middle = begin + (end - begin) / 2;
  const Fraction a = sum_of(terms, begin, middle), b = sum_of(terms, middle, end);
  if (a.denominator == b.denominator) return {a.numerator + b.numerator, a.denominator};
  return {product(a.numerator, b.denominator) + product(b.numerator, a.denominator),
          product(a.denominator, b.denominator)};
}

Fraction reduced_now(const Fraction& fraction) {
  const Integer common = gcd(fraction.numerator, fraction.denominator);
  Fraction result{fraction.numerator / common, fraction.denominator / common};
  if (result.denominator < 0) {
    result.numerator = -result.numerator;
    result.denominator = -result.denominator;
  }
  return result;
}

std::optional<Fraction> sum_within(std::size_t begin, std::size_t end,
                                   const std::function<Fraction(std::size_t)>& term, std::size_t bits) {
  if (begin == end) return Fraction{};
  if (end - begin == 1) return term(begin);
  stop_if_wanted();
  const std::size_t middle = begin + (end - begin) / 2;
  const auto a = sum_within(begin, middle, term, bits);
  if (!a) return std::nullopt;
  const auto b = sum_within(middle, end, term, bits);
  if (!b) return std::nullopt;
  // Fractions of structured scenes stay short if they are reduced. Reducing the shortest ones saves no time.
  constexpr std::size_t short_bits = 4096;
  Fraction both = sum_of({*a, *b}, 0, 2);
  if (bits_of(both.denominator) > short_bits) both = reduced_now(both);
  if (bits_of(both.denominator) > bits) return std::nullopt;
  return both;
}

}  // namespace

std::optional<Fraction> sum_within(std::size_t count, const std::function<Fraction(std::size_t)>& term,
                                   std::size_t bits) {
  return sum_within(0, count, term, bits);
}

Integer product(const Integer& a, const Integer& b) {
  if (bits_of(a) + bits_of(b) < long_bits) return a * b;
  return long_call([a, b] { return Integer(a * b); });
}

Fraction sum(const std::vector<Fraction>& terms) { return sum_of(terms, 0, terms.size()); }

bool equal(const Fraction& a, const Fraction& b) {
  return product(a.numerator, b.denominator) == product(b.numerator, a.denominator);
}

Fraction reduced(const Fraction& fraction) {
  if (bits_of(fraction.denominator) < long_bits) return reduced_now(fraction);
  return long_call([fraction] { return reduced_now(fraction); });
}

double ratio(const Integer& numerator, const Integer& denominator) {
  long top = 0, bottom = 0;
  const double n = mpz_get_d_2exp(&top, numerator.backend().data());
  const double d = mpz_get_d_2exp(&bottom, denominator.backend().data());
  return std::ldexp(n / d, static_cast<int>(top - bottom));
}

std::string digits_of(const Integer& a) {
  if (bits_of(a) < long_bits) return a.str();
  return long_call([a] { return a.str(); });
}

}  // namespace tubefoot
