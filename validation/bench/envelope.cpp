// SPDX-License-Identifier: GPL-3.0-or-later
#include "envelope.hpp"

// An assertion of CGAL 5.5.1 in Envelope_3 is ambiguous in C++20; some preconditions need the assertions.
#ifndef CGAL_NO_ASSERTIONS
#define CGAL_NO_ASSERTIONS
#endif
#define CGAL_NO_PRECONDITIONS
#include <CGAL/Env_surface_data_traits_3.h>
#include <CGAL/Env_triangle_traits_3.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/envelope_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/visibility/visibility.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

// The lazy exact kernel does not accelerate Envelope_3 here: 0.37 s compared with 0.36 s for 295 facets.
using Kernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Number = Kernel::FT;
using Traits = CGAL::Env_surface_data_traits_3<CGAL::Env_triangle_traits_3<Kernel>, FacetId>;

FacetMesh facets_near(FacetMesh mesh, const TubeSet& tubes, std::uint32_t tube) {
  std::erase_if(mesh.facets, [&](const std::array<VertexId, 3>& facet) {
    for (int k = 0; k < 4; ++k) {
      const Vec64 wall = cross(tubes.rays[tubes.tubes[tube][k]], tubes.rays[tubes.tubes[tube][(k + 1) % 4]]);
      if (std::none_of(facet.begin(), facet.end(),
                       [&](VertexId v) { return dot(wall, mesh.vertices[v] - tubes.apex) > 0; }))
        return true;
    }
    return false;
  });
  mesh.material.resize(mesh.facets.size());
  mesh.component.resize(mesh.facets.size());
  return mesh;
}

std::vector<Traits::Surface_3> mapped_triangles(const FacetMesh& mesh, GridPoint apex) {
  const auto mapped = [&](VertexId v) {
    const GridPoint p = mesh.vertices[v] - apex;
    if (p.y <= 0) throw std::invalid_argument("a facet of the view is not completely ahead of the apex");
    const Number x = p.x, y = p.y, z = p.z;
    return Kernel::Point_3(z / y, x / y, -1 / y);
  };
  std::vector<Traits::Surface_3> triangles;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    const auto& [a, b, c] = mesh.facets[f];
    triangles.emplace_back(Kernel::Triangle_3(mapped(a), mapped(b), mapped(c)), f);
  }
  return triangles;
}

template <class Work>
double wall_seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

double envelope_over_fixed(const FacetMesh& whole, const TubeSet& tubes, std::uint32_t tube) {
  const FacetMesh mesh = facets_near(whole, tubes, tube);
  const SceneTree tree(mesh);
  const auto triangles = mapped_triangles(mesh, tubes.apex);
  VisibilityScratch scratch;
  TubeVisibility seen;
  std::vector<double> ratios, fixed_times, envelope_times;
  for (int repeat = 0; repeat < 5; ++repeat) {
    std::vector<double> looks;
    for (int k = 0; k < 101; ++k)
      looks.push_back(
          wall_seconds([&] { see(mesh, tree, tubes, tube, VisibilityOptions{}, scratch, seen); }));
    fixed_times.push_back(median(looks));
    envelope_times.push_back(wall_seconds([&] {
      CGAL::Envelope_diagram_2<Traits> diagram;
      CGAL::lower_envelope_3(triangles.begin(), triangles.end(), diagram);
    }));
    ratios.push_back(envelope_times.back() / fixed_times.back());
  }
  fmt::print("  {} facets in view: fixed {:.3g} ms, Envelope_3 {:.3g} s\n", mesh.facets.size(),
             median(fixed_times) * 1e3, median(envelope_times));
  return median(ratios);
}

}  // namespace tubefoot
