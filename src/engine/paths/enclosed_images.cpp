// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/enclosed_images.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/certified/refracted_bins.hpp"
#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Encloses rays, windows and visibility of images in refracting water. A window deviates from the true one by
// no more than the apparent facets at its border. Source: docs/notes/certified-energies.md, "Over level
// mirrors".

namespace tubefoot {
namespace {

constexpr double most_off_rad = 0.2;  // from here on every direction is ambiguous (UncertainEdges)
using State = FacetEnclosure::State;

/// Directions in which an image may see a facet.
struct Spread {
  glm::dvec3 axis{0};
  double spread_rad = 0, beyond_rad = 0;  ///< half-angle of the apparent facet's cone, and bound of its
                                          ///< error
};
Spread spread_of(const FacetEnclosure& facet) {
  Spread spread;
  const glm::dvec3 centre = (facet.seen[0] + facet.seen[1] + facet.seen[2]) / 3.0;
  double radius = 0;
  for (const glm::dvec3& c : facet.seen) radius = std::max(radius, glm::distance(c, centre));
  const double range = glm::length(centre);
  spread.axis = range > 0 ? centre / range : glm::dvec3(0, 0, 1);
  spread.spread_rad =
      radius < range ? std::asin(radius / range) * (1 + enclosure_slack) + enclosure_slack : infinite;
  spread.beyond_rad =
      facet.nearest_m > 0 ? 1.1 * facet.travel_path_error_m / facet.nearest_m + enclosure_slack : infinite;
  return spread;
}
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return 2 * std::asin(std::min(glm::distance(a, b) / 2, 1.0));  // of unit vectors
}

bool on(const PlaneName& plane, const CornerName& corner) {
  return corner.point != no_point ? plane.contains(corner.point) : plane == corner.p || plane == corner.q;
}
/// Planes that two neighbouring corners of a visible polygon have in common.
std::vector<PlaneName> between(const CornerName& c, const CornerName& d) {
  std::vector<PlaneName> planes;
  if (c.point != no_point && d.point != no_point)
    return {{std::min(c.point, d.point), std::max(c.point, d.point)}};
  const auto& [named, other] = c.point == no_point ? std::pair(c, d) : std::pair(d, c);
  for (const PlaneName& plane : {named.p, named.q})
    if (on(plane, other)) planes.push_back(plane);
  return planes;
}
bool is_wall(const PlaneName& plane) { return !plane.depth && ((plane.a | plane.b) & ray_bit) != 0; }

/// Distance between a direction and an arc.
double distance_rad(const glm::dvec3& direction, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 across = glm::cross(from, to);
  const double ends = std::min(angle_between(direction, from), angle_between(direction, to)),
               size = glm::length(across);
  if (!(size > 0)) return ends;
  const bool between =
      glm::dot(glm::cross(across, from), direction) >= 0 && glm::dot(glm::cross(to, across), direction) >= 0;
  return between ? std::abs(std::asin(std::clamp(glm::dot(across, direction) / size, -1.0, 1.0))) : ends;
}

}  // namespace

/// Enclosure of the surface that the images over one chain of mirrors see.
struct EnclosedImages::Seabed {
  Seabed(const BistaticSurface& seen, const EchoModel& model) : end(seen.tx) {
    const BistaticEnd nothing{end.surface_mesh, end.tree, {}, end.water, end.rays};
    all = std::move(
        enclose({seen.mesh, seen.parent, seen.base, seen.grid, end, nothing}, {}, {}, model).ends.front());
    for (const FacetEnclosure& facet : all.facets) spread.push_back(spread_of(facet));
  }
  /// Bound of the angular error of apparent facets that an image sees within a cone.
  double beyond_rad(const glm::dvec3& axis, double spread_rad) const {
    double most = 0;
    for (FacetId f = 0; f < spread.size(); ++f) {
      if (all.facets[f].state == State::unproven || spread[f].beyond_rad <= most) continue;
      if (angle_between(axis, spread[f].axis) <= spread_rad + spread[f].spread_rad + spread[f].beyond_rad)
        most = spread[f].beyond_rad;
    }
    return most;
  }
  /// Whether a place, relative to the apex, is visible; none: not certain.
  std::optional<bool> sees(const glm::dvec3& to_m) const {
    const double range = glm::length(to_m);
    const glm::dvec3 direction = to_m / range;
    bool sure = true;
    for (FacetId f = 0; f < spread.size(); ++f) {
      const FacetEnclosure& facet = all.facets[f];
      if (facet.state == State::unproven || facet.nearest_m >= range) continue;
      const double beyond = spread[f].beyond_rad;
      if (angle_between(direction, spread[f].axis) > spread[f].spread_rad + beyond) continue;
      const double turn = glm::dot(glm::cross(facet.seen[0], facet.seen[1]), facet.seen[2]) < 0 ? -1 : 1;
      double inside = infinite;
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 wall = glm::cross(facet.seen[k], facet.seen[(k + 1) % 3]);
        inside = std::min(inside, turn * glm::dot(wall, direction) / glm::length(wall));
      }
      if (facet.state == State::proven) {
        if (inside < -beyond) continue;
        const double at_m = facet.plane_m / glm::dot(facet.normal, direction);
        if (at_m - facet.shift_m > range) continue;
        if (inside > beyond && at_m + facet.shift_m < range) return false;
      }
      sure = false;
    }
    for (const FacetEnclosure& facet : all.unproven) sure = sure && facet.nearest_m >= range;
    return sure ? std::optional(true) : std::nullopt;
  }

  BistaticEnd end;
  ApparentEnclosures all;
  std::vector<Spread> spread;
};

EnclosedImages::~EnclosedImages() = default;

EnclosedImages::EnclosedImages(RefractedImages& images, const EchoModel& model,
                               std::span<const double> reflection,
                               std::initializer_list<std::span<const Image>> lists)
    : images_(images), model_(model) {
  for (const std::span<const Image> list : lists)
    for (const Image& image : list) {
      if (image.seen.empty()) continue;
      const Seabed& seabed = seabed_of(image);
      double& beyond = beyond_[image.mirror_path];
      beyond = std::max(beyond, off_rad(image));
      look_at_windows(image, seabed, reflection, beyond);
    }
}

void EnclosedImages::look_at_windows(const Image& image, const Seabed& seabed,
                                     std::span<const double> reflection, double& off_rad) {
  const double unit_m = images_.grid().unit_m();
  const tubefoot::Unknown without_ray(seabed.all.unproven, seabed.end.rays);
  double known_to_m = infinite;
  for (std::uint32_t tube = 0; tube < image.seen.size(); ++tube) {
    stop_if_wanted();
    TubeSet own = image.windows;
    own.tubes = {image.windows.tubes[tube]};
    known_to_m = std::min(known_to_m, without_ray.begins_m(Sector(own, unit_m)));
    const TubeVisibility& seen = image.seen[tube];
    const NameContext context{*image.mesh, image.windows.apex, seen.rays};
    const auto add = [&](const NamedPiece& piece) {
      for (std::uint32_t k = 0; k < piece.count; ++k) {
        const CornerName &c = seen.corners[piece.first + k],
                         &d = seen.corners[piece.first + (k + 1) % piece.count];
        const std::vector<PlaneName> planes = between(c, d);
        if (std::ranges::any_of(planes, is_wall)) continue;
        const glm::dvec3 from = glm::normalize(direction_of(context, c)),
                         to = glm::normalize(direction_of(context, d)), sum = from + to;
        if (!(glm::length(sum) > 0)) continue;
        off_rad = std::max(
            off_rad, seabed.beyond_rad(glm::normalize(sum), angle_between(from, to) / 2 + enclosure_slack));
        // At an intersection of two facets, the errors of their ranges bound the displacement of the border.
        for (const PlaneName& plane : planes)
          if (plane.depth) {
            const FacetEnclosure &one = seabed.all.facets[plane.a], &two = seabed.all.facets[plane.b];
            const double steep = glm::length(one.plane_m * two.normal - two.plane_m * one.normal),
                         off = 1.1 * (one.shift_m + two.shift_m) / steep;
            off_rad = std::max(off_rad, off < most_off_rad ? off : most_off_rad);
          }
      }
    };
    for (const NamedPiece& open : seen.open) add(open);
    if (!reflection.empty())
      for (const NamedPiece& piece : seen.pieces)
        if (reflection[image.mesh->material[piece.facet]] > 0) add(piece);
  }
  off_rad = std::min(off_rad, most_off_rad);
  if (known_to_m < infinite) unknown_.push_back({image.mirrors, known_to_m});
}

const EnclosedImages::Seabed& EnclosedImages::seabed_of(const Image& image) {
  auto& seabed = seabeds_[image.mirror_path];
  if (!seabed) seabed = std::make_unique<const Seabed>(images_.seabed_between(image, image), model_);
  return *seabed;
}

double EnclosedImages::off_rad(const Image& image) const {
  const auto before = images_.way_before(image);
  if (!before) return 0;
  const auto found = beyond_.find(*before);
  return found == beyond_.end() ? 0 : found->second;
}

bool EnclosedImages::is_near_border(const Image& image, std::span<const std::uint32_t> fans,
                                    std::uint32_t fan, glm::dvec3 direction) const {
  const double near = off_rad(image) + 1e-7;  // plus the rounding of rays
  const TubeSet& windows = image.windows;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> walls;
  for (std::uint32_t w = 0; w < windows.tubes.size(); ++w) {
    if (!fans.empty() && fans[image.own_tube[w]] != fan) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t a = windows.tubes[w][k], b = windows.tubes[w][(k + 1) % 4];
      ++walls[{std::min(a, b), std::max(a, b)}];
    }
  }
  const auto ray = [&](std::uint32_t r) {
    return glm::normalize(
        glm::dvec3(double(windows.rays[r].x), double(windows.rays[r].y), double(windows.rays[r].z)));
  };
  const auto in_window = [&](const glm::dvec3& towards) {
    const glm::dvec3 far = towards * 0x1p30;
    const GridPoint point{std::int32_t(far.x), std::int32_t(far.y), std::int32_t(far.z)};
    for (std::uint32_t w = 0; w < windows.tubes.size(); ++w)
      if ((fans.empty() || fans[image.own_tube[w]] == fan) && holds(windows, w, point, window_border_rad))
        return true;
    return false;
  };
  return std::ranges::any_of(walls, [&](const auto& wall) {
    const glm::dvec3 from = ray(wall.first.first), to = ray(wall.first.second);
    if (wall.second != 1 || distance_rad(direction, from, to) > near) return false;
    // Two windows may adjoin along parts of their walls.
    const glm::dvec3 beside = 2 * near * glm::normalize(glm::cross(from, to));
    return !in_window(glm::normalize(direction + beside)) || !in_window(glm::normalize(direction - beside));
  });
}

EnclosedImages::Ray EnclosedImages::ray_to(const Image& image, GridPoint place) {
  const WorldGrid& grid = images_.grid();
  const ApparentMap& water = images_.water_of(image);
  const RayEnclosure& enclosure = images_.rays_of(image);
  Ray found;
  const glm::dvec3 at_m = grid.to_metres(place);
  if (!water.unfolding().may_reach(at_m.z, at_m.z)) return found;
  FacetEnclosure point;
  glm::dvec3 way = water.unfolded(at_m) - water.apex_m();
  way.z *= water.unfolding().sign;
  point.seen = {way, way, way};
  found.soonest_m = point.nearest_m = glm::length(way) * enclosure.least_stretch() * (1 - enclosure_slack);
  const tubefoot::Unknown anywhere({&point, 1}, enclosure);
  found.may_be_seen = anywhere.begins_m(Sector(image.windows, grid.unit_m())) < infinite;
  if (!found.may_be_seen) return found;
  const std::vector<MirroredRay> rays = images_.all_rays_to(image, place);
  if (rays.size() != 1) return found;
  found.enclosed = enclose_ray(water, enclosure, at_m);
  if (!found.enclosed) return found;
  found.ray = rays.front();
  found.passes = seabed_of(image).sees(2 * rays.front().half_path_m * rays.front().sent);
  return found;
}

}  // namespace tubefoot
