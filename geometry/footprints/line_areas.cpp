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

namespace {

struct Coefficients {
  Integer a, b, c;
};

/// Corner k is L_k-1 x L_k, so that corner k x corner k+1 = L_k det(L_k-1, L_k, L_k+1). Twice the area is the
/// sum of c det / (w w'), with the third coefficient c of L_k and third coordinates w of corners.
Fraction double_area(const std::vector<Coefficients>& line) {
  const std::size_t n = line.size();
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

Residue residue_of(const Integer& x) {
  static const Integer prime(residue_prime);
  const Integer rest = x % prime;
  return static_cast<Residue>(rest < 0 ? Integer(rest + prime) : rest);
}

}  // namespace

Fraction double_area(const LinePolygon& polygon) {
  std::vector<Coefficients> line;
  for (const PlaneLine* l : polygon) line.push_back({integer(l->a), integer(l->b), integer(l->c)});
  return double_area(line);
}

Fraction double_area(const LineTable& table, std::span<const DirectedLine> polygon) {
  std::vector<Coefficients> line;
  for (const auto& [number, opposite] : polygon) {
    auto [a, b, c] = table.integers(number);
    if (opposite)
      line.push_back({Integer(-a), Integer(-b), Integer(-c)});
    else
      line.push_back({std::move(a), std::move(b), std::move(c)});
  }
  return double_area(line);
}

Residue double_area_residue(const LineTable& table, std::span<const DirectedLine> polygon) {
  const std::size_t n = polygon.size();
  const auto product = [](Residue a, Residue b) { return residue_product(a, b); };
  const auto minor = [&](Residue a, Residue b, Residue c, Residue d) {  // a b - c d
    return residue_difference(product(a, b), product(c, d));
  };
  thread_local std::vector<std::array<Residue, 3>> line;
  thread_local std::vector<Residue> weight, others;
  line.resize(n);
  weight.resize(n);
  others.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    line[k] = table.residues(polygon[k].line);
    if (polygon[k].opposite)
      for (Residue& x : line[k]) x = residue_difference(0, x);
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto &p = line[k == 0 ? n - 1 : k - 1], &q = line[k];
    weight[k] = minor(p[0], q[1], p[1], q[0]);
    if (weight[k] == 0) {
      const Fraction area = reduced(double_area(table, polygon));
      return product(residue_of(area.numerator), residue_inverse(residue_of(area.denominator)));
    }
  }
  // One inverse serves all weights. `others` has the products of the weights before each.
  Residue all = 1;
  for (std::size_t k = 0; k < n; ++k) {
    others[k] = all;
    all = product(all, weight[k]);
  }
  Residue inverse = residue_inverse(all);
  for (std::size_t k = n; k-- > 0;) {
    others[k] = product(others[k], inverse);  // now the inverse of the weight
    inverse = product(inverse, weight[k]);
  }
  Residue sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = k + 1 == n ? 0 : k + 1;
    const auto &p = line[k == 0 ? n - 1 : k - 1], &q = line[k], &r = line[next];
    const Residue det =
        residue_sum(residue_sum(product(weight[k], r[2]), product(minor(p[1], q[2], p[2], q[1]), r[0])),
                    product(minor(p[2], q[0], p[0], q[2]), r[1]));
    sum = residue_sum(sum, product(product(q[2], det), product(others[k], others[next])));
  }
  return sum;
}

ExactShare share_of(const Fraction& area, const Integer& whole) {
  const auto [p, q] = reduced({area.numerator, product(area.denominator, whole)});
  return {ratio(p, q), q == 1 ? digits_of(p) : digits_of(p) + "/" + digits_of(q)};
}

}  // namespace tubefoot
