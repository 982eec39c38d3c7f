// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/line_areas.hpp"

#include <utility>
#include <vector>

namespace tubefoot {
Integer integer(const HugeInt& x) {
  Integer z;
  const auto& limbs = x.backend();
  mpz_import(z.backend().data(), limbs.size(), -1, sizeof(*limbs.limbs()), 0, 0, limbs.limbs());
  return limbs.sign() ? Integer(-z) : z;
}

/// Corner k is L_k-1 x L_k, so that corner k x corner k+1 = L_k det(L_k-1, L_k, L_k+1). With c the third
/// coefficient of L_k and w the third coordinate of a corner, twice the area is the sum of c det / (w w').
Fraction double_area(const LinePolygon& polygon) {
  const std::size_t n = polygon.size();
  struct Coefficients {
    Integer a, b, c;
  };
  std::vector<Coefficients> line;
  for (const PlaneLine* l : polygon) line.push_back({integer(l->a), integer(l->b), integer(l->c)});
  std::vector<Integer> weight(n);  // of the corner at which line k begins
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
  const auto [p, q] = reduced({area.numerator, product(area.denominator, whole)});
  return {ratio(p, q), q == 1 ? digits_of(p) : digits_of(p) + "/" + digits_of(q)};
}

}  // namespace tubefoot
