// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluates the predicate sign det(n1, n2, n3) on planes of a scene in all arithmetics and tiers, and
// checks the laws of a determinant.

#include "prove/plane_signs.hpp"

#include <array>

#include "geometry/arithmetic/arithmetic_filtered.hpp"
#include "geometry/arithmetic/arithmetic_fixed.hpp"
#include "geometry/arithmetic/arithmetic_rational.hpp"

namespace tubefoot::prove {
namespace {

/// A plane that each arithmetic can construct: through two points, or the depth plane of two facets.
struct PlaneOf {
  GridPoint a, b;
  const FacetCone *i = nullptr, *j = nullptr;
  PlaneOf turned() const { return {b, a, j, i}; }
};

struct Question {
  std::array<PlaneOf, 3> planes;
  std::array<GridPoint, 2> points;
  const FacetCone* facet = nullptr;  ///< null if no facet faces the apex
};

template <class A>
void make(const A& arithmetic, const PlaneOf& of, typename A::Plane& plane) {
  if (!of.i) return arithmetic.through(plane, of.a, of.b);
  typename A::Facet i, j;
  arithmetic.facet(i, *of.i);
  arithmetic.facet(j, *of.j);
  arithmetic.depth(plane, i, j);
}

/// The last tier of an arithmetic, which decides each time.
template <class A>
struct LastTier : A {
  int side(const auto& what, const typename A::Plane& plane) const { return A::exact_side(what, plane); }
  int nearer(const typename A::Facet& f, GridPoint p) const { return A::exact_nearer(f, p); }
};

/// Index of each sign in the result.
enum : std::size_t { pqr, qrp, rpq, qpr, prq, rqp, negated, p_turned, r_turned, on_p, on_q, points_from };

template <class A>
void answer(const Question& question, std::vector<int>& signs) {
  const A arithmetic{};
  std::array<typename A::Plane, 3> plane;
  for (std::size_t k = 0; k < 3; ++k) make(arithmetic, question.planes[k], plane[k]);
  typename A::Plane p_back, r_back;
  make(arithmetic, question.planes[0].turned(), p_back);
  make(arithmetic, question.planes[2].turned(), r_back);
  const auto& [p, q, r] = plane;
  const auto side = [&](const typename A::Plane& a, const typename A::Plane& b, const typename A::Plane& c,
                        int sign = 1) {
    typename A::Corner corner;
    arithmetic.meet(corner, a, b, sign);
    return arithmetic.side(corner, c);
  };
  signs = {side(p, q, r),      side(q, r, p), side(r, p, q),     side(q, p, r),
           side(p, r, q),      side(r, q, p), side(p, q, r, -1), side(p_back, q, r),
           side(p, q, r_back), side(p, q, p), side(p, q, q)};
  for (const GridPoint& d : question.points) {
    typename A::Corner corner;
    arithmetic.point(corner, d);
    for (const auto* of : {&p, &q, &r}) {
      signs.push_back(arithmetic.side(d, *of));
      signs.push_back(arithmetic.side(corner, *of));
    }
  }
  if (!question.facet) return;
  typename A::Facet facet;
  arithmetic.facet(facet, *question.facet);
  for (const GridPoint& d : question.points) signs.push_back(arithmetic.nearer(facet, d));
  for (const GridPoint& d : question.facet->point) signs.push_back(arithmetic.nearer(facet, d));
}

bool lawful(const std::vector<int>& s, bool has_facet) {
  bool holds = s[qrp] == s[pqr] && s[rpq] == s[pqr];
  holds = holds && s[qpr] == -s[pqr] && s[prq] == -s[pqr] && s[rqp] == -s[pqr];
  holds = holds && s[negated] == -s[pqr] && s[p_turned] == -s[pqr] && s[r_turned] == -s[pqr];
  holds = holds && s[on_p] == 0 && s[on_q] == 0;
  for (std::size_t k = points_from; k < points_from + 12; k += 2) holds = holds && s[k] == s[k + 1];
  // The vertices of a facet lie in its plane.
  for (std::size_t k = s.size() - 3; has_facet && k < s.size(); ++k) holds = holds && s[k] == 0;
  return holds;
}

}  // namespace

bool PlaneSigns::obey_laws(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, Random& random) {
  cones_.clear();
  points_.clear();
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    FacetCone cone;
    if (FacetCone::make(mesh, f, tubes.apex, cone)) cones_.push_back(cone);
  }
  for (const GridPoint& p : mesh.vertices) points_.push_back(p - tubes.apex);
  const Tube& rays = tubes.tubes[tube];
  const auto any_plane = [&]() -> PlaneOf {
    const std::size_t k = random.index(4);
    if (cones_.empty() || random.one_in(4))
      return {tubes.rays[rays[k]], tubes.rays[rays[(k + 1) % 4]], nullptr, nullptr};
    const FacetCone &i = cones_[random.index(cones_.size())], &j = cones_[random.index(cones_.size())];
    if (random.one_in(3)) return {{}, {}, &i, &j};
    return {i.point[k % 3], i.point[(k + 1) % 3], nullptr, nullptr};
  };
  const auto any_point = [&] {
    return random.one_in(3) ? tubes.rays[rays[random.index(4)]] : points_[random.index(points_.size())];
  };
  constexpr int questions = 4;
  for (int k = 0; k < questions; ++k) {
    Question question;
    for (PlaneOf& plane : question.planes) plane = any_plane();
    for (GridPoint& point : question.points) point = any_point();
    if (!cones_.empty()) question.facet = &cones_[random.index(cones_.size())];
    answer<RationalArithmetic>(question, expected_);
    if (!lawful(expected_, question.facet != nullptr)) return false;
    const auto agrees = [&]<class A>(const A&) {
      answer<A>(question, signs_);
      return signs_ == expected_;
    };
    if (!agrees(FixedArithmetic{}) || !agrees(LastTier<FixedArithmetic>{})) return false;
    const FilteredArithmetic::Guard guard;
    if (!agrees(FilteredArithmetic{}) || !agrees(LastTier<FilteredArithmetic>{})) return false;
  }
  return true;
}

}  // namespace tubefoot::prove
