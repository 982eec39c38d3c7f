// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/mixed_eigenrays.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "engine/surface/facet_flattening.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "geometry/steps/stop.hpp"

// Computes mixed-eigenray returns by intersecting the images of a part in two eigenray branches. Branches of
// opposite orientation are compared in a mirrored copy of the mesh.

namespace tubefoot {
namespace {

GridPoint mirrored(GridPoint p) { return {p.x, -p.y, p.z}; }

TubeSet mirrored(TubeSet tubes) {
  tubes.apex = mirrored(tubes.apex);
  for (GridPoint& ray : tubes.rays) ray = mirrored(ray);
  for (Tube& tube : tubes.tubes) std::swap(tube[1], tube[3]);
  return tubes;
}

FacetMesh mirrored(FacetMesh mesh) {
  for (GridPoint& vertex : mesh.vertices) vertex = mirrored(vertex);
  return mesh;
}

/// Rays of one rank that have all crossed their neighbours (Eigenray::crossed), or of which none has.
using Family = std::pair<std::uint32_t, bool>;

/// The visible pieces of the branches, in the mesh or in its mirror image.
struct View {
  TubeSet tubes;
  FacetMesh mesh;
  std::vector<TubeVisibility> seen;

  /// Returns the visible pieces of the wanted facets.
  std::vector<TubeVisibility> part(const std::vector<char>& wanted) const {
    std::vector<TubeVisibility> some;
    for (const TubeVisibility& all : seen) {
      TubeVisibility& one = some.emplace_back();
      one.corners = all.corners;
      one.rays = all.rays;
      for (const NamedPiece& piece : all.pieces)
        if (wanted[piece.facet]) one.pieces.push_back(piece);
    }
    return some;
  }
};

/// Returns the mean over a part of the product of the two rays' gains. Near a caustic, tubes widen as the
/// square root of the distance from it. Therefore 1 / gain^2 of each ray is a linear function over the seabed
/// there. Elsewhere this holds to second order.
double mean_gain(const RayOfPart& sent, const RayOfPart& received) {
  constexpr int n = 8;
  const auto inverse_square = [](const RayOfPart& ray, double u, double v) {
    const std::array<double, 3> weight{1 - u - v, u, v};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += weight[k] / (ray.corners[k].gain * ray.corners[k].gain);
    return sum;
  };
  double sum = 0;
  const auto add = [&](double u, double v) {
    sum += 1 / std::sqrt(inverse_square(sent, u, v) * inverse_square(received, u, v));
  };
  // Centroids of uniform triangles of both orientations.
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      add((i + 1 / 3.) / n, (j + 1 / 3.) / n);
      if (i + j + 1 < n) add((i + 2 / 3.) / n, (j + 2 / 3.) / n);
    }
  return sum / (n * n);
}

/// The images of the parts in one family of rays.
struct Sheet {
  std::vector<char> is_own;            ///< per apparent facet
  std::vector<const RayOfPart*> rays;  ///< per part; null: no such ray
};

}  // namespace

void trace_mixed_eigenrays(const ApparentSurface& surface_mesh, const SceneTree& tree, const WorldGrid& grid,
                           const VisibilityOptions& options, const TubeSet& tubes,
                           const std::function<void(const BistaticHistory&)>& take) {
  std::set<Family> families;
  for (const RayOfPart& ray : surface_mesh.several) families.emplace(ray.rank, ray.crossed);
  if (families.size() < 2) return;
  const FacetMesh& mesh = surface_mesh.refined.mesh;
  const glm::dvec3 apex = grid.to_metres(tubes.apex);
  std::vector<FacetId> part_of(mesh.facets.size(), 0);
  for (const RayOfPart& ray : surface_mesh.several) part_of[ray.seen] = ray.part;
  const View straight{tubes, mesh, look(mesh, tree, tubes, options)};
  std::optional<View> mirror;
  const auto in_mirror = [&]() -> const View& {
    if (!mirror) {
      mirror.emplace(View{mirrored(tubes), mirrored(mesh), {}});
      mirror->seen = look(mirror->mesh, SceneTree(mirror->mesh, SceneTree::HeightFieldSearch::ignored),
                          mirror->tubes, options);
    }
    return *mirror;
  };
  const auto sheet_of = [&](const Family& family) {
    Sheet sheet{std::vector<char>(mesh.facets.size(), 0),
                std::vector<const RayOfPart*>(surface_mesh.part_material.size(), nullptr)};
    for (const RayOfPart& ray : surface_mesh.several)
      if (Family(ray.rank, ray.crossed) == family) {
        sheet.is_own[ray.seen] = 1;
        sheet.rays[ray.part] = &ray;
      }
    return sheet;
  };
  const auto add_bistatic = [&](BistaticHistory& history, const Sheet& tx, const Sheet& rx) {
    for (const SharedFacet& shared : history.shared.facets) {
      const RayOfPart &sent = *tx.rays[shared.facet], &received = *rx.rays[shared.facet];
      std::array<std::size_t, 3> corner{0, 1, 2};
      glm::dvec3 from_t[3], from_r[3], lies[3];
      const auto place = [&] {
        for (std::size_t k = 0; k < 3; ++k) {
          const VertexId t = mesh.facets[sent.seen][corner[k]], r = mesh.facets[received.seen][corner[k]];
          from_t[k] = grid.to_metres(mesh.vertices[t]) - apex;
          from_r[k] = grid.to_metres(mesh.vertices[r]) - apex;
          lies[k] = surface_mesh.truth[t];
        }
      };
      place();
      // The order in which pieces turn.
      if (glm::dot(glm::cross(from_t[1] - from_t[0], from_t[2] - from_t[0]), shared.plane_normal) > 0) {
        std::swap(corner[1], corner[2]);
        place();
      }
      FlattenedFacet flattened = flatten_between(from_t, from_r, lies);
      const double gain = mean_gain(sent, received);
      for (std::size_t k = 0; k < 3; ++k) {
        const RayOfPart::Corner &there = sent.corners[corner[k]], &back = received.corners[corner[k]];
        BistaticFacet::Corner& at = flattened.facet.corners[k];
        at.transmit_lies = there.sine;
        at.receive_lies = back.sine;
        const double ranges = flattened.there_m[k] * flattened.back_m[k] / (there.range_m * back.range_m);
        at.gain *= gain * ranges * ranges;
      }
      history.bistatic.push_back(flattened.facet);
    }
  };
  const auto share_a_part = [](const Sheet& a, const Sheet& b) {
    for (std::size_t p = 0; p < a.rays.size(); ++p)
      if (a.rays[p] != nullptr && b.rays[p] != nullptr) return true;
    return false;
  };
  std::vector<std::pair<Family, Sheet>> sheets;
  for (const Family& family : families) sheets.emplace_back(family, sheet_of(family));
  for (const auto& [tx, sent] : sheets) {
    const std::vector<TubeVisibility> seen_tx = straight.part(sent.is_own);
    for (const auto& [rx, received] : sheets) {
      stop_if_wanted();
      if (tx.first == rx.first || !share_a_part(sent, received)) continue;
      const View& view = tx.second == rx.second ? straight : in_mirror();
      const std::vector<TubeVisibility> seen_rx = view.part(received.is_own);
      BistaticHistory history{tubes, tubes, grid.unit_m(), {}};
      history.shared = FootprintSharer({straight.tubes, seen_tx, &straight.mesh, part_of},
                                       {view.tubes, seen_rx, &view.mesh, part_of}, grid.unit_m())
                           .all();
      history.shared.receiver_m = glm::dvec3(0);
      if (history.shared.pieces.empty()) continue;
      add_bistatic(history, sent, received);
      take(history);
    }
  }
}

}  // namespace tubefoot
