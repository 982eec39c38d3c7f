// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/closure.hpp"

#include <CGAL/Exact_rational.h>
#include <fmt/format.h>

#include <vector>

#include "geometry/arithmetic/long_integers.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/visibility/exact_direction.hpp"
#include "geometry/visibility/topology_hasher.hpp"

namespace tubefoot {
namespace {

using Rational = CGAL::Exact_rational;
Fraction fraction_of(const Rational& x) { return {numerator(x), denominator(x)}; }

TopologyHash hash_of(const FacetMesh& mesh, GridPoint apex, FacetId facet, const Fraction& area,
                     std::uint64_t label) {
  TopologyHasher hasher;
  hasher.add(label);
  hasher.add(mesh, facet, apex);
  hasher.add(area.numerator);
  hasher.add(area.denominator);
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
    cones = false;  // unreachable with an exact arithmetic
    return Rational(0);
  };

  TubeAudit result;
  result.pieces = seen.pieces.size();
  // A reduced sum of many fractions with coprime denominators would spend its time in greatest common
  // divisors. A balanced tree of unreduced fractions needs only products.
  std::vector<Fraction> areas, of_facet;
  for (std::size_t k = 0; k < seen.pieces.size();) {
    const FacetId facet = seen.pieces[k].facet;
    of_facet.clear();
    for (; k < seen.pieces.size() && seen.pieces[k].facet == facet; ++k)
      of_facet.push_back(fraction_of(area_of(seen.pieces[k])));
    areas.push_back(of_facet.size() == 1 ? of_facet.front() : reduced(sum(of_facet)));
    result.hash += hash_of(mesh, tubes.apex, facet, areas.back(), label);
    ++result.facets;
  }
  const std::size_t visible = areas.size();
  for (const NamedPiece& piece : seen.open) areas.push_back(fraction_of(area_of(piece)));

  const Fraction total = sum(areas);
  const Integer left = product(total.numerator, denominator(whole)),
                right = product(numerator(whole), total.denominator);
  result.closes = cones && left == right;
  result.defect = left == right ? 0 : ratio(left - right, right);
  for (std::size_t k = 0; k < visible; ++k)
    result.covered_fraction += ratio(product(areas[k].numerator, denominator(whole)),
                                     product(areas[k].denominator, numerator(whole)));
  return result;
}

}  // namespace tubefoot
