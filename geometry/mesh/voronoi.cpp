// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/voronoi.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <utility>

namespace tubefoot {
namespace {

using Signs = CGAL::Exact_predicates_inexact_constructions_kernel;
using SiteVertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Signs>;
using Delaunay = CGAL::Delaunay_triangulation_2<Signs, CGAL::Triangulation_data_structure_2<SiteVertex>>;

glm::dvec2 circumcentre(std::span<const glm::dvec2> sites, const Delaunay::Face_handle& face) {
  std::array<std::uint32_t, 3> corner{face->vertex(0)->info(), face->vertex(1)->info(),
                                      face->vertex(2)->info()};
  std::ranges::sort(corner);  // independent of the corner at which the triangulation starts
  const glm::dvec2 origin = sites[corner[0]], u = sites[corner[1]] - origin, v = sites[corner[2]] - origin;
  const double uu = u.x * u.x + u.y * u.y, vv = v.x * v.x + v.y * v.y, twice = 2 * (u.x * v.y - u.y * v.x);
  return origin + glm::dvec2((v.y * uu - u.y * vv) / twice, (u.x * vv - v.x * uu) / twice);
}

}  // namespace

std::vector<VoronoiEdge> voronoi_edges(std::span<const glm::dvec2> sites) {
  std::vector<std::pair<Signs::Point_2, std::uint32_t>> points;
  for (std::uint32_t k = 0; k < sites.size(); ++k)
    points.emplace_back(Signs::Point_2(sites[k].x, sites[k].y), k);
  const Delaunay delaunay(points.begin(), points.end());
  std::vector<VoronoiEdge> edges;
  for (auto e = delaunay.finite_edges_begin(); e != delaunay.finite_edges_end(); ++e) {
    const auto face = e->first, other = face->neighbor(e->second);
    if (delaunay.is_infinite(face) || delaunay.is_infinite(other)) continue;
    const glm::dvec2 a = circumcentre(sites, face), b = circumcentre(sites, other);
    if (a == b) continue;
    edges.push_back({face->vertex(Delaunay::ccw(e->second))->info(),
                     face->vertex(Delaunay::cw(e->second))->info(), a, b});
  }
  return edges;
}

}  // namespace tubefoot
