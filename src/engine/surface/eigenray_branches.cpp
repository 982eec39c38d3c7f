// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/eigenray_branches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/surface/grazing_sine.hpp"
#include "geometry/numbers/int128.hpp"

// Cuts facets with several eigenrays along caustics and limits of the followed rays, and adds one apparent
// facet per family of rays and part. Next to a caustic the facet factor contains the mean of 1 / sqrt(w^2 +
// w_c^2) over the launch directions. Here w is the ray-tube width and w_c the Airy width. See
// docs/notes/refraction.md.
namespace tubefoot {
namespace {

/// Accuracy to which borders are located, in metres.
constexpr double border_m = 1e-8;

/// Returns whether three grid points do not lie on one line.
bool is_triangle(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const std::array<Int128, 3> u{Int128(b.x) - a.x, Int128(b.y) - a.y, Int128(b.z) - a.z},
      v{Int128(c.x) - a.x, Int128(c.y) - a.y, Int128(c.z) - a.z};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3;
    if (u[k] * v[l] != u[l] * v[k]) return true;
  }
  return false;
}

/// Computes facet_factor() next to a caustic per launch direction. The area of the ray tube on the transmit
/// leg then has no singularity, because the transmitted energy insonifies the seabed. The quantity 1 /
/// spreading is linear. `seen_m` is relative to the apex.
double factor_beside_caustic(const glm::dvec3 (&lies_m)[3], const glm::dvec3 (&seen_m)[3],
                             const std::array<const SeenPoint*, 3>& rays, double absorption_db_per_m,
                             const ScatteringModel* model) {
  const glm::dvec3 lies = normal_of(lies_m), seen = normal_of(seen_m);
  double refracted = 0, straight = 0, caustic = 0;
  std::array<double, 3> width;
  for (std::size_t k = 0; k < 3; ++k) {
    const double there = grazing_sine(lies, rays[k]->returned.arrival), here = grazing_sine(seen, seen_m[k]),
                 r2 = glm::dot(seen_m[k], seen_m[k]),
                 rest = std::exp(-absorption_db_per_m * std::sqrt(r2) * std::numbers::ln10 / 5) / (r2 * r2);
    if (there > 0) refracted += sigma_of(model, there) / there * here * rest;
    straight += sigma_of(model, here) * rest;
    width[k] = rays[k]->width;
    caustic += rays[k]->caustic_width / 3;
  }
  return straight > 0 ? refracted / straight * mean_inverse_width(width, caustic) : 0;
}

}  // namespace

double mean_inverse_width(const std::array<double, 3>& width, double least) {
  std::array<double, 3> w{std::abs(width[0]), std::abs(width[1]), std::abs(width[2])};
  std::ranges::sort(w);
  least = std::max(least, 1e-6 * w[2]);
  if (!(least > 0) || !std::isfinite(w[2])) return 0;
  const auto slope = [=](double v) { return std::asinh(v / least); };
  const auto value = [=](double v) { return v * std::asinh(v / least) - std::hypot(v, least); };
  const auto between = [&](double a, double b) {  // mean slope
    return b - a > 1e-7 * (b + least) ? (value(b) - value(a)) / (b - a) : slope((a + b) / 2);
  };
  // For nearly equal widths, divided differences are less accurate than the value at the mean.
  if (w[2] - w[0] < 1e-3 * (w[2] + least)) return 1 / std::hypot((w[0] + w[1] + w[2]) / 3, least);
  return 2 * (between(w[1], w[2]) - between(w[0], w[1])) / (w[2] - w[0]);
}

EigenrayBranches::EigenrayBranches(const FineFacets& fine, const Images& images, const WorldGrid& grid,
                                   std::span<const std::shared_ptr<const ScatteringModel>> models,
                                   ApparentSurface& surface_mesh)
    : fine_(fine), images_(images), grid_(grid), models_(models), surface_mesh_(surface_mesh) {}

VertexId EigenrayBranches::add_vertex(const SeenPoint& seen, const glm::dvec3& lies_m) {
  std::vector<GridPoint>& vertices = surface_mesh_.refined.mesh.vertices;
  vertices.push_back(grid_.snap(seen.at_m));
  truth_.push_back(lies_m);
  return VertexId(vertices.size() - 1);
}

const EigenrayBranches::Place& EigenrayBranches::place_of(VertexId vertex) {
  const auto [entry, is_new] = places_.try_emplace(vertex);
  Place& place = entry->second;
  if (!is_new) return place;
  const ApparentImage& image = fine_.image[vertex];
  place.at_m = fine_.at_m[vertex];
  place.rays = image.several;
  for (const SeenPoint& ray : place.rays) place.vertices.push_back(add_vertex(ray, place.at_m));
  if (place.rays.empty() && image.seen()) {
    place.rays.push_back(image);
    place.vertices.push_back(vertex);
  }
  return place;
}

const EigenrayBranches::Border* EigenrayBranches::border_on(VertexId a, VertexId b) {
  const auto [low, high] = std::minmax(a, b);
  const auto [entry, is_new] = borders_.try_emplace(std::uint64_t{low} << 32 | high);
  if (is_new) {
    const std::size_t at_low = place_of(low).rays.size(), at_high = place_of(high).rays.size();
    if (at_low != at_high) entry->second = at_low > at_high ? find_border(low, high) : find_border(high, low);
  }
  return entry->second ? &*entry->second : nullptr;
}

std::optional<EigenrayBranches::Border> EigenrayBranches::find_border(VertexId richer, VertexId poorer) {
  const Place &from = place_of(richer), &to = place_of(poorer);
  Border border;
  border.richer = richer;
  std::vector<SeenPoint> inside = from.rays, outside = to.rays;
  double lo = 0, hi = 1;
  const double length = glm::distance(from.at_m, to.at_m);
  while ((hi - lo) * length > border_m && hi - lo > 1e-15) {
    const double middle = (lo + hi) / 2;
    const ApparentImage image = images_.make(from.at_m + middle * (to.at_m - from.at_m));
    std::vector<SeenPoint> rays = image.several;
    if (rays.empty() && image.seen()) rays.push_back(image);
    const bool is_inside = are_alike(rays, inside);
    (is_inside ? lo : hi) = middle;
    (is_inside ? inside : outside) = std::move(rays);
  }
  const std::vector<std::size_t> stay = same_rays(inside, outside);
  // The edge has more than one border, or one ray vanishes where another appears.
  if (stay.size() != outside.size() || !are_alike(outside, to.rays) || outside.size() >= inside.size())
    return std::nullopt;
  border.part = lo;
  Place &more = border.more, &fewer = border.fewer;
  more.at_m = fewer.at_m = from.at_m + lo * (to.at_m - from.at_m);
  more.rays = std::move(inside);
  const auto stays = [&](std::size_t k) { return std::ranges::find(stay, k) != stay.end(); };
  for (std::size_t k = 0; k < more.rays.size(); ++k) {
    // Two images that meet on a caustic become one there, because both have the same distance from it.
    const bool meet = k + 1 < more.rays.size() && !stays(k) && !stays(k + 1) &&
                      more.rays[k].crossed() != more.rays[k + 1].crossed();
    if (meet) more.rays[k].at_m = more.rays[k + 1].at_m = (more.rays[k].at_m + more.rays[k + 1].at_m) / 2.0;
    more.vertices.push_back(add_vertex(more.rays[k], more.at_m));
    if (meet) more.vertices.push_back(more.vertices[k++]);
  }
  for (const std::size_t k : stay) {
    fewer.rays.push_back(more.rays[k]);
    fewer.vertices.push_back(more.vertices[k]);
  }
  return border;
}

void EigenrayBranches::add(FacetId facet) {
  ++surface_mesh_.facets_of_several;
  const std::array<VertexId, 3>& corner = fine_.mesh.mesh.facets[facet];
  const PartWeights weights = fine_.mesh.weights.empty() ? all_of_it : fine_.mesh.weights[facet];
  std::array<const Border*, 3> border;  // opposite to each corner
  int borders = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    border[k] = border_on(corner[(k + 1) % 3], corner[(k + 2) % 3]);
    borders += border[k] != nullptr;
  }
  const auto at_corner = [&](std::size_t k) { return Corner{&place_of(corner[k]), weights[k]}; };
  // Returns the border on the edge opposite to a corner, as seen from one end of this edge. The weights are
  // always counted from the end with more rays.
  const auto at_border = [&](std::size_t opposite, const Place& side) {
    const Border& on = *border[opposite];
    const std::size_t one = (opposite + 1) % 3, two = (opposite + 2) % 3,
                      from = corner[one] == on.richer ? one : two, to = one + two - from;
    Corner c{&side, weights[from]};
    for (std::size_t i = 0; i < 2; ++i)
      c.weights[i] += std::llround(on.part * double(weights[to][i] - weights[from][i]));
    return c;
  };
  const auto towards = [&](std::size_t opposite, std::size_t end) {
    return at_border(opposite, border[opposite]->towards(corner[end]));
  };
  if (borders == 0) {
    add_part(facet, {at_corner(0), at_corner(1), at_corner(2)});
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    if (borders == 1 && border[k] != nullptr) {
      add_part(facet, {at_corner(k), at_corner(next), towards(k, next)});
      add_part(facet, {at_corner(k), towards(k, last), at_corner(last)});
    } else if (borders == 2 && border[k] == nullptr) {
      // Both borders lie on the edges of corner k.
      add_part(facet, {at_corner(k), towards(last, k), towards(next, k)});
      add_part(facet, {towards(last, next), at_corner(next), at_corner(last)});
      add_part(facet, {towards(last, next), at_corner(last), towards(next, last)});
    } else if (borders == 3) {
      add_part(facet, {at_corner(k), towards(last, k), towards(next, k)});
    }
  }
  if (borders == 3)
    add_part(facet, {at_border(2, border[2]->fewer), at_border(0, border[0]->fewer),
                     at_border(1, border[1]->fewer)});
}

void EigenrayBranches::add_part(FacetId facet, const std::array<Corner, 3>& corners) {
  const glm::dvec3 lies[3] = {corners[0].place->at_m, corners[1].place->at_m, corners[2].place->at_m};
  const auto leave_out = [&] {
    ++surface_mesh_.facets_in_shadow;
    surface_mesh_.left_out_m.push_back({lies[0], lies[1], lies[2]});
  };
  std::size_t least = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (corners[k].place->rays.size() < corners[least].place->rays.size()) least = k;
  const std::vector<SeenPoint>& fewest = corners[least].place->rays;
  if (fewest.empty()) return leave_out();
  std::array<std::vector<std::size_t>, 3> same;
  for (std::size_t k = 0; k < 3; ++k) {
    same[k] = same_rays(corners[k].place->rays, fewest);
    if (same[k].empty()) return leave_out();
  }
  const ApparentImage middle = images_.make((lies[0] + lies[1] + lies[2]) / 3.0);
  std::vector<SeenPoint> centre = middle.several;
  if (centre.empty() && middle.seen()) centre.push_back(middle);
  const bool is_known = are_alike(centre, fewest);
  FacetMesh& mesh = surface_mesh_.refined.mesh;
  for (std::size_t ray = 0; ray < fewest.size(); ++ray) {
    const std::array<std::size_t, 3> rays{same[0][ray], same[1][ray], same[2][ray]};
    const std::size_t before = mesh.facets.size();
    add_seen(facet, corners, rays, is_known ? &centre[ray] : nullptr);
    if (fewest.size() == 1 || mesh.facets.size() == before) continue;
    RayOfPart& of = surface_mesh_.several.emplace_back();
    of.seen = FacetId(before);
    of.part = FacetId(surface_mesh_.part_material.size());
    of.rank = std::uint32_t(ray);
    of.crossed = fewest[ray].crossed();
    for (std::size_t k = 0; k < 3; ++k) {
      const SeenPoint& point = corners[k].place->rays[rays[k]];
      of.corners[k] = {grazing_sine(normal_of(lies), point.returned.arrival), point.gain(), point.range_m};
    }
  }
  if (fewest.size() > 1) surface_mesh_.part_material.push_back(fine_.mesh.mesh.material[facet]);
}

void EigenrayBranches::add_seen(FacetId facet, const std::array<Corner, 3>& corners,
                                const std::array<std::size_t, 3>& ray, const SeenPoint* centre) {
  FacetMesh& mesh = surface_mesh_.refined.mesh;
  const FacetMesh& from = fine_.mesh.mesh;
  glm::dvec3 lies[3], seen[3], towards{0};
  std::array<VertexId, 3> vertex;
  std::array<const SeenPoint*, 3> rays;
  CornerReturn returns[3];
  bool is_wide = true;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Place& place = *corners[k].place;
    lies[k] = place.at_m;
    vertex[k] = place.vertices[ray[k]];
    rays[k] = &place.rays[ray[k]];
    returns[k] = rays[k]->returned;
    towards += returns[k].arrival;
    is_wide = is_wide && rays[k]->is_wide();
  }
  const glm::dvec3 apex = images_.apparent_map().apex_m();
  for (std::size_t k = 0; k < 3; ++k) {
    seen[k] = grid_.to_metres(mesh.vertices[vertex[k]]) - apex;
    longest = std::max(longest, glm::distance(rays[k]->at_m, rays[(k + 1) % 3]->at_m));
  }
  if (!is_triangle(mesh.vertices[vertex[0]], mesh.vertices[vertex[1]], mesh.vertices[vertex[2]])) return;
  const glm::dvec3 middle = (seen[0] + seen[1] + seen[2]) / 3.0;
  if (!images_.may_show(middle + apex, longest)) return;
  // The rays to the three corners correspond to each other, so the ray to the centre must lie between them.
  if (centre != nullptr && glm::distance(centre->at_m - apex, middle) > longest) {
    ++surface_mesh_.facets_in_shadow;
    surface_mesh_.left_out_m.push_back({lies[0], lies[1], lies[2]});
    return;
  }
  const std::uint16_t material = from.material[facet];
  const ScatteringModel* model = models_.empty() ? nullptr : models_[material].get();
  const double absorption = images_.reference_absorption_db_per_m();
  mesh.facets.push_back(vertex);
  mesh.material.push_back(material);
  mesh.component.push_back(from.component[facet]);
  surface_mesh_.refined.parent.push_back(fine_.mesh.parent[facet]);
  if (!fine_.mesh.weights.empty())
    surface_mesh_.refined.weights.push_back({corners[0].weights, corners[1].weights, corners[2].weights});
  surface_mesh_.facets_folded += glm::dot(normal_of(lies), towards) * glm::dot(normal_of(seen), middle) < 0;
  surface_mesh_.factor_rule.push_back(FactorRule::branch);
  surface_mesh_.facet_factor.push_back(
      is_wide ? facet_factor(lies, seen, returns, centre != nullptr ? &centre->returned : nullptr, absorption,
                             [model](double sine) { return sigma_of(model, sine); })
              : factor_beside_caustic(lies, seen, rays, absorption, model));
}

}  // namespace tubefoot
