// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/line_table.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/footprints/line_areas.hpp"

// Lines are found again by a hash of their coefficients up to a factor: the residues of a/b and c/b. Products
// of integers confirm that two lines of one hash are equal.

namespace tubefoot {
namespace {

template <class Limb>
Residue residue_of_limbs(const Limb* limbs, std::size_t size, bool negative) {
  Residue sum = 0;
  for (std::size_t k = size; k-- > 0;) {
    // 2^64 is 8 modulo the prime.
    const Residue low = (limbs[k] & residue_prime) + (limbs[k] >> 61);
    sum = residue_sum(residue_product(sum, 8), low < residue_prime ? low : low - residue_prime);
  }
  return negative ? residue_difference(0, sum) : sum;
}

}  // namespace

Residue residue_product(Residue a, Residue b) {
  const auto product = static_cast<UInt128>(a) * b;
  const Residue sum = (static_cast<Residue>(product) & residue_prime) + static_cast<Residue>(product >> 61);
  return sum < residue_prime ? sum : sum - residue_prime;
}

Residue residue_inverse(Residue a) {
  Residue power = 1;
  for (int bit = 60; bit >= 0; --bit) {
    power = residue_product(power, power);
    if ((residue_prime - 2) >> bit & 1) power = residue_product(power, a);
  }
  return power;
}

Residue residue_of(const HugeInt& x) {
  const auto& limbs = x.backend();
  return residue_of_limbs(limbs.limbs(), limbs.size(), limbs.sign());
}

LineTable::Line LineTable::stored(const PlaneLine& line) {
  Line kept;
  kept.near = {line.a_near, line.b_near, line.c_near};
  const std::array coefficients{&line.a, &line.b, &line.c};
  std::size_t count = 0;
  for (const HugeInt* x : coefficients) count += x->backend().size();
  constexpr std::size_t block = 4096;
  if (limbs_.empty() || limbs_.back().size() + count > limbs_.back().capacity()) {
    limbs_.emplace_back();
    limbs_.back().reserve(std::max(block, count));
  }
  std::vector<std::uint64_t>& to = limbs_.back();
  kept.limbs = to.data() + to.size();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& limbs = coefficients[k]->backend();
    kept.size[k] = static_cast<std::uint8_t>(limbs.size());
    kept.negative[k] = limbs.sign();
    to.insert(to.end(), limbs.limbs(), limbs.limbs() + limbs.size());
    kept.residues[k] = residue_of(*coefficients[k]);
  }
  return kept;
}

HugeInt LineTable::coefficient(const Line& line, std::size_t k) const {
  const std::uint64_t* from = line.limbs;
  for (std::size_t i = 0; i < k; ++i) from += line.size[i];
  HugeInt x;
  auto& limbs = x.backend();
  limbs.resize(line.size[k], line.size[k]);
  std::copy_n(from, line.size[k], limbs.limbs());
  limbs.sign(line.negative[k]);
  limbs.normalize();
  return x;
}

bool LineTable::same(const Line& known, const PlaneLine& line, bool& opposite) const {
  const HugeInt a = coefficient(known, 0), b = coefficient(known, 1), c = coefficient(known, 2);
  opposite = a != 0 ? (a < 0) != (line.a < 0) : (b < 0) != (line.b < 0);
  if (opposite ? (a == -line.a && b == -line.b && c == -line.c) : (a == line.a && b == line.b && c == line.c))
    return true;
  return HugeInt(a * line.b) == HugeInt(b * line.a) && HugeInt(a * line.c) == HugeInt(c * line.a) &&
         HugeInt(b * line.c) == HugeInt(c * line.b);
}

DirectedLine LineTable::keep(const PlaneLine& line) {
  const Residue a = residue_of(line.a), b = residue_of(line.b), c = residue_of(line.c);
  const Residue scale = b != 0 ? residue_inverse(b) : a != 0 ? residue_inverse(a) : 1;
  const std::uint64_t hash = residue_product(a, scale) * 0x9e3779b97f4a7c15u ^ residue_product(c, scale);
  const auto found = by_hash_.find(hash);
  LineId next = 0;
  if (found != by_hash_.end()) {
    next = found->second + 1;
    bool opposite = false;
    for (LineId at = next; at != 0; at = lines_[at - 1].next)
      if (same(lines_[at - 1], line, opposite)) return {at - 1, opposite};
  }
  const std::scoped_lock lock(adding_);
  Line kept = stored(line);
  kept.next = next;
  const auto number = static_cast<LineId>(lines_.push_back(kept) - lines_.begin());
  by_hash_[hash] = number;
  return {number, false};
}

LineId LineTable::add_grid_line(bool across_v, std::int64_t place) {
  const PlaneLine line = PlaneLine::of(across_v ? 0 : 1, across_v ? 1 : 0, -HugeInt(place));
  const std::scoped_lock lock(adding_);
  return static_cast<LineId>(lines_.push_back(stored(line)) - lines_.begin());
}

PlaneLine LineTable::exact(LineId number) const {
  const Line& line = lines_[number];
  return {coefficient(line, 0), coefficient(line, 1), coefficient(line, 2),
          line.near.a,          line.near.b,          line.near.c};
}

std::array<Integer, 3> LineTable::integers(LineId number) const {
  const Line& line = lines_[number];
  return {integer(coefficient(line, 0)), integer(coefficient(line, 1)), integer(coefficient(line, 2))};
}

int LineTable::turn(LineId p, LineId q) const {
  if (p == q) return 0;
  const Line &first = lines_[p], &second = lines_[q];
  const double x = first.near.a * second.near.b, y = first.near.b * second.near.a;
  if (std::abs(x - y) > 1e-14 * (std::abs(x) + std::abs(y))) return x > y ? 1 : -1;
  return HugeInt(coefficient(first, 0) * coefficient(second, 1) -
                 coefficient(first, 1) * coefficient(second, 0))
      .sign();
}

LineCorner LineTable::corner(LineId p, LineId q) const {
  if (turn(p, q) < 0) std::swap(p, q);
  return {p, q, meeting_point(exact(p), exact(q))};
}

LineCorner LineTable::corner(DirectedLine arriving, DirectedLine leaving) const {
  LineId p = arriving.line, q = leaving.line;
  if (arriving.opposite != leaving.opposite) std::swap(p, q);
  return {p, q, meeting_point(exact(p), exact(q))};
}

int LineTable::determinant(LineId p, LineId q, LineId r) const {
  return tubefoot::side(exact(p), exact(q), exact(r));
}

int LineTable::side(const LineCorner& corner, LineId line) const {
  if (corner.p == line || corner.q == line) return 0;
  // The relative error of the coordinates is below 1e-15, and that of the coefficients is 2^-52.
  const Near& of = near(line);
  const double x = of.a * corner.near.x, y = of.b * corner.near.y, value = x + y + of.c;
  if (std::abs(value) > 1e-14 * (std::abs(x) + std::abs(y) + std::abs(of.c))) return value > 0 ? 1 : -1;
  return determinant(corner.p, corner.q, line);
}

/// The value of a line M at a corner (L, M') is the distance along L from M, times the turn from M to L.
int LineTable::order(LineId line, const LineCorner& first, const LineCorner& second) const {
  const LineId m = first.p == line ? first.q : first.p, n = second.p == line ? second.q : second.p;
  if (m == n) return 0;
  const Near& of = near(line);
  const double x = of.b * first.near.x, y = of.a * first.near.y, z = of.b * second.near.x,
               w = of.a * second.near.y;
  const double value = (x - y) - (z - w);
  if (std::abs(value) > 1e-14 * (std::abs(x) + std::abs(y) + std::abs(z) + std::abs(w)))
    return value > 0 ? 1 : -1;
  return -determinant(first.p, first.q, n) * turn(line, n);
}

}  // namespace tubefoot
