// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/line_areas.hpp"

#include <cmath>

namespace tubefoot {
namespace {

Fraction sum_of(const std::vector<Fraction>& terms, std::size_t begin, std::size_t end) {
  if (begin == end) return {};
  if (end - begin == 1) return terms[begin];
  const std::size_t middle = begin + (end - begin) / 2;
  const Fraction a = sum_of(terms, begin, middle), b = sum_of(terms, middle, end);
  if (a.denominator == b.denominator) return {a.numerator + b.numerator, a.denominator};
  return {a.numerator * b.denominator + b.numerator * a.denominator, a.denominator * b.denominator};
}

/// Numerator and denominator scaled to what a double holds.
double ratio(const Integer& numerator, const Integer& denominator) {
  long top = 0, bottom = 0;
  const double n = mpz_get_d_2exp(&top, numerator.backend().data());
  const double d = mpz_get_d_2exp(&bottom, denominator.backend().data());
  return std::ldexp(n / d, static_cast<int>(top - bottom));
}

}  // namespace

Fraction sum(const std::vector<Fraction>& terms) { return sum_of(terms, 0, terms.size()); }

bool equal(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator == b.numerator * a.denominator;
}

Integer integer(const HugeInt& x) {
  Integer z;
  const auto& limbs = x.backend();
  mpz_import(z.backend().data(), limbs.size(), -1, sizeof(*limbs.limbs()), 0, 0, limbs.limbs());
  return limbs.sign() ? Integer(-z) : z;
}

/// Corner k is L_k-1 x L_k, so that corner k x corner k+1 = L_k det(L_k-1, L_k, L_k+1): with c the third
/// coefficient of L_k and w the third of a corner, the sum of c det / (w w').
Fraction double_area(const LinePolygon& polygon) {
  const std::size_t n = polygon.size();
  struct Coefficients {
    Integer a, b, c;
  };
  std::vector<Coefficients> line;
  for (const PlaneLine* l : polygon) line.push_back({integer(l->a), integer(l->b), integer(l->c)});
  std::vector<Integer> weight(n);  // of the corner in which line k begins
  for (std::size_t k = 0; k < n; ++k) {
    const Coefficients &p = line[(k + n - 1) % n], &q = line[k];
    weight[k] = p.a * q.b - p.b * q.a;
  }
  std::vector<Fraction> terms;
  for (std::size_t k = 0; k < n; ++k) {
    const Coefficients &p = line[(k + n - 1) % n], &q = line[k], &r = line[(k + 1) % n];
    if (q.c == 0) continue;
    const Integer det = weight[k] * r.c + (p.b * q.c - p.c * q.b) * r.a + (p.c * q.a - p.a * q.c) * r.b;
    terms.push_back({q.c * det, weight[k] * weight[(k + 1) % n]});
  }
  return sum(terms);
}

ExactShare share_of(const Fraction& area, const Integer& whole) {
  Integer p = area.numerator, q = area.denominator * whole;
  if (q < 0) {
    p = -p;
    q = -q;
  }
  const Integer common = gcd(p, q);
  p /= common;
  q /= common;
  return {ratio(p, q), q == 1 ? p.str() : p.str() + "/" + q.str()};
}

}  // namespace tubefoot
