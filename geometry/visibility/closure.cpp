// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/closure.hpp"

#include <CGAL/Exact_rational.h>
#include <fmt/format.h>

#include <vector>

#include "geometry/steps/stop.hpp"
#include "geometry/visibility/exact_direction.hpp"
#include "geometry/visibility/topology_hasher.hpp"

namespace tubefoot {
namespace {

using Rational = CGAL::Exact_rational;
using Integer = boost::multiprecision::mpz_int;

/// A sum of many fractions whose denominators have nothing in common would spend its time in greatest common
/// divisors. As a balanced tree of unreduced fractions it costs only products.
struct Fraction {
  Integer numerator, denominator;
};

Fraction sum(const std::vector<Rational>& terms, std::size_t begin, std::size_t end) {
  if (begin == end) return {0, 1};
  if (end - begin == 1) return {numerator(terms[begin]), denominator(terms[begin])};
  stop_if_wanted();
  const std::size_t middle = begin + (end - begin) / 2;
  const Fraction a = sum(terms, begin, middle), b = sum(terms, middle, end);
  return {a.numerator * b.denominator + b.numerator * a.denominator, a.denominator * b.denominator};
}

TopologyHash hash_of(const FacetMesh& mesh, GridPoint apex, FacetId facet, const Rational& area,
                     std::uint64_t label) {
  TopologyHasher hasher;
  hasher.add(label);
  hasher.add(mesh, facet, apex);
  hasher.add(Integer(numerator(area)));
  hasher.add(Integer(denominator(area)));
  return hasher.get();
}

}  // namespace

std::string TopologyHash::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

TubeAudit audit(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, const TubeVisibility& seen,
                std::uint64_t label) {
  const NameContext context{mesh, tubes.apex, seen.rays};
  const ExactVector axis = gnomonic_axis(tubes, tube);
  std::vector<ExactVector> walls;
  for (const std::uint32_t ray : tubes.tubes.at(tube)) walls.push_back(exact(tubes.rays[ray]));
  const Rational whole = gnomonic_area(axis, walls);
  bool cones = true;
  const auto area_of = [&](const NamedPiece& piece) {
    stop_if_wanted();
    const std::vector<ExactVector> directions = exact_directions(context, seen.corners, piece);
    if (in_front(axis, directions)) return gnomonic_area(axis, directions);
    cones = false;  // no exact arithmetic comes here
    return Rational(0);
  };

  TubeAudit result;
  result.pieces = seen.pieces.size();
  std::vector<Rational> areas;
  for (std::size_t k = 0; k < seen.pieces.size();) {
    const FacetId facet = seen.pieces[k].facet;
    Rational area = 0;
    for (; k < seen.pieces.size() && seen.pieces[k].facet == facet; ++k) area += area_of(seen.pieces[k]);
    result.hash += hash_of(mesh, tubes.apex, facet, area, label);
    areas.push_back(std::move(area));
    ++result.facets;
  }
  const std::size_t visible = areas.size();
  for (const NamedPiece& piece : seen.open) areas.push_back(area_of(piece));

  const Fraction total = sum(areas, 0, areas.size());
  const Integer left = total.numerator * denominator(whole), right = numerator(whole) * total.denominator;
  result.closes = cones && left == right;
  result.defect = left == right ? 0 : Rational(Rational(left - right) / Rational(right)).convert_to<double>();
  for (std::size_t k = 0; k < visible; ++k)
    result.covered_fraction += Rational(areas[k] / whole).convert_to<double>();
  return result;
}

}  // namespace tubefoot
