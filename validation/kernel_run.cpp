// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/kernel_run.hpp"

#include <array>
#include <cmath>
#include <span>

#include "geometry/visibility/visibility_solver.hpp"
#include "validation/absolute_double.hpp"

namespace tubefoot::atlas {
namespace {

double unit_m(const Case& scene) { return std::ldexp(1.0, -scene.grid_exponent); }

/// Computes visibility in the coordinates of an engine that subtracts no origin.
void see_absolutely(const Case& scene, const SceneTree& tree, std::uint32_t tube,
                    const VisibilityOptions& options, CandidateFacets& candidate_facets,
                    VisibilitySolver<AbsoluteDouble>& solver, TubeVisibility& out) {
  const std::array<GridPoint, 4> rays = rays_of(scene.tubes, tube);
  AbsoluteDouble arithmetic;
  arithmetic.tolerance = options.tolerance;
  arithmetic.unit_m = unit_m(scene);
  const GridPoint apex = scene.tubes.apex;
  candidate_facets.gather(scene.mesh, tree, apex, scene.tubes.reach, rays, !options.open_water);
  arithmetic.apex_m = scene.origin_m + arithmetic.unit_m * glm::dvec3(apex.x, apex.y, apex.z);
  solver.begin(scene.mesh, apex, candidate_facets);
  solver.run(arithmetic, options, {rays, std::span(&rays, 1)}, std::span(&out, 1));
}

}  // namespace

CommonVisibility look(const Case& scene, Arithmetic arithmetic, double tolerance, Audit audited) {
  VisibilityOptions options;
  options.arithmetic = arithmetic;
  options.tolerance = tolerance;
  options.open_water = audited == Audit::yes;
  const bool absolute = arithmetic == Arithmetic::plain_double && scene.origin_m != glm::dvec3(0);
  // An engine in doubles does not prove height fields.
  const SceneTree tree =
      absolute ? SceneTree(scene.mesh, SceneTree::HeightFieldSearch::ignored) : SceneTree(scene.mesh);
  VisibilityScratch scratch;
  CandidateFacets candidate_facets;
  VisibilitySolver<AbsoluteDouble> absolute_solver;
  TubeVisibility seen;
  CommonVisibility visibility;
  for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
    if (absolute)
      see_absolutely(scene, tree, t, options, candidate_facets, absolute_solver, seen);
    else
      see(scene.mesh, tree, scene.tubes, t, options, scratch, seen);
    CommonVisibility::OfTube& tube = visibility.tubes.emplace_back();
    const Chart chart(scene.tubes, t);
    const NameContext context{scene.mesh, scene.tubes.apex, seen.rays};
    for (const NamedPiece& piece : seen.pieces) {
      Chart::Polygon polygon;
      if (!chart.polygon(context, seen, piece, polygon)) continue;
      tube.areas[piece.facet] += polygon.area;
      tube.polygons.push_back(std::move(polygon));
    }
    visibility.pieces += seen.pieces.size();
    visibility.facets += tube.areas.size();
    if (audited == Audit::no) continue;
    const TubeAudit verdict = audit(scene.mesh, scene.tubes, t, seen, t);
    visibility.hash += verdict.hash;
    visibility.unclosed += !verdict.closes;
  }
  return visibility;
}

double error_of(const CommonVisibility& found, const CommonVisibility& truth) {
  double sum = 0;
  for (std::size_t t = 0; t < truth.tubes.size(); ++t) {
    const Areas &a = found.tubes[t].areas, &b = truth.tubes[t].areas;
    const auto add = [&](const CGAL::Exact_rational& difference) {
      sum += std::abs(difference.convert_to<double>());
    };
    for (const auto& [facet, area] : a) {
      const auto other = b.find(facet);
      if (other == b.end())
        add(area);
      else if (area != other->second)
        add(CGAL::Exact_rational(area - other->second));
    }
    for (const auto& [facet, area] : b)
      if (!a.contains(facet)) add(area);
  }
  return sum / double(truth.tubes.size());
}

std::vector<Tolerance> sweep(const Case& scene, const CommonVisibility& truth) {
  std::vector<Tolerance> tried;
  for (int exponent = -17; exponent <= -3; ++exponent) {
    const double value = std::pow(10.0, exponent);
    tried.push_back({value, error_of(look(scene, Arithmetic::plain_double, value, Audit::no), truth)});
  }
  return tried;
}

}  // namespace tubefoot::atlas
