// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/image_adjoint.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "geometry/footprints/corner_derivatives.hpp"
#include "geometry/numbers/grid_vector.hpp"

// Transposes the steps of ImageMotion, in the opposite order. Each image passes its derivatives to its parent
// image, to the points of its mirror and to those of its windows.

namespace tubefoot {
namespace {

/// Derivative of by . (S' d) by the velocity of the normal n, for the velocity S' of a reflection.
glm::dvec3 by_normal_of_turn(glm::dvec3 normal, glm::dvec3 direction, glm::dvec3 by) {
  return -2.0 * (glm::dot(normal, direction) * by + glm::dot(by, normal) * direction);
}

}  // namespace

ImageAdjoint::ImageAdjoint(const FacetMesh& mesh, double unit_m, GridPoint transmit_apex,
                           std::span<const Image> images)
    : mesh_(mesh),
      unit_m_(unit_m),
      transmit_apex_(transmit_apex),
      images_(images),
      by_vertex_(mesh.vertices.size(), glm::dvec3(0)),
      by_ray_(images.front().windows.rays.size(), glm::dvec3(0)) {
  for (const Image& image : images) {
    at_m_.push_back(displacement_m(transmit_apex, image.windows.apex, unit_m));
    Sums sums;
    sums.by_rough_normal.assign(image.leg.loss.rough_normals.size(), glm::dvec3(0));
    sums_.emplace_back(image.windows.tubes.size(), sums);
  }
}

glm::dvec3 ImageAdjoint::place_of(VertexId vertex) const {
  return displacement_m(transmit_apex_, mesh_.vertices[vertex], unit_m_);
}

void ImageAdjoint::add_rough_normal(std::size_t image, std::uint32_t window, std::size_t normal,
                                    glm::dvec3 by) {
  sums_[image][window].by_rough_normal[normal] += by;
}

void ImageAdjoint::add_point(std::size_t image, std::uint32_t window, PointId id, glm::dvec3 by,
                             std::uint32_t first_ray) {
  Sums& own = sums_[image][window];
  if (id & ray_bit) {
    const std::uint32_t ray = (id & ~ray_bit) - first_ray;
    if (ray < 4) own.by_ray[ray] += by;
    return;
  }
  own.by_apex -= by;
  const std::size_t vertices = mesh_.vertices.size();
  if (id < vertices) {
    by_vertex_[id] += by;
    return;
  }
  // The point at which the last mirror cuts a line.
  const PartVertex& cut = images_[image].vertex[id - vertices];
  const glm::dvec3 unit = images_[image].last->unit_normal(), from = place_of(cut.from),
                   along = place_of(cut.to) - from;
  const double rise = glm::dot(unit, along),
               share =
                   (offset_m(*images_[image].last, transmit_apex_, unit_m_) - glm::dot(unit, from)) / rise,
               by_shift = glm::dot(by, along) / rise;
  own.by_offset += by_shift;
  own.by_normal -= by_shift * (from + share * along);
  const glm::dvec3 by_line = by - by_shift * unit;
  by_vertex_[cut.from] += (1 - share) * by_line;
  by_vertex_[cut.to] += share * by_line;
}

void ImageAdjoint::finish_rays(std::size_t number, std::uint32_t window) {
  const Image &image = images_[number], &parent = images_[image.parent];
  const WindowOrigin& origin = image.origins[window];
  Sums& own = sums_[number][window];
  if (origin.third_is_sum) {
    own.by_ray[1] += own.by_ray[2];
    own.by_ray[3] += own.by_ray[2];
    own.by_ray[2] = glm::dvec3(0);
  }
  const NameContext context{mesh_, parent.windows.apex, parent.seen[origin.parent_window].rays};
  const NamedPoints points(context, unit_m_, part_of(parent));
  CornerAdjoint corners(
      points, [&](PointId id, glm::dvec3 by) { add_point(image.parent, origin.parent_window, id, by, 0); });
  const glm::dmat3 reflect = image.last->reflection();
  const glm::dvec3 unit = image.last->unit_normal();
  for (std::size_t k = 0; k < 4; ++k) {
    if (own.by_ray[k] == glm::dvec3(0)) continue;
    const WindowCorner& corner = origin.corners[k];
    const glm::dvec3 one = points.direction(corner.name),
                     other = corner.other ? points.direction(*corner.other) : glm::dvec3(0),
                     direction = corner.other ? one.z * other - other.z * one : one;
    const glm::dvec3 mirrored = reflect * direction;
    const glm::dvec3 ray = displacement({}, image.windows.rays[image.windows.tubes[window][k]]);
    const double scale = glm::dot(ray, mirrored) / glm::dot(mirrored, mirrored);
    const glm::dvec3 by = scale * own.by_ray[k], by_direction = reflect * by;
    own.by_normal += by_normal_of_turn(unit, direction, by);
    if (!corner.other) {
      corners.add_direction(corner.name, by_direction);
      continue;
    }
    const glm::dvec3 up(0, 0, 1);
    corners.add_direction(corner.name, glm::dot(by_direction, other) * up - other.z * by_direction);
    corners.add_direction(*corner.other, one.z * by_direction - glm::dot(by_direction, one) * up);
  }
}

/// Converts derivatives by the plane of the last mirror.
void ImageAdjoint::finish_mirror(const Image& image, const WindowOrigin& origin, const Sums& own) {
  const glm::dvec3 unit = image.last->unit_normal();
  if (origin.mirror == no_facet) {
    by_local_motion_ -= own.by_offset * unit;
    return;
  }
  const auto& [a, b, c] = mesh_.facets[origin.mirror];
  const glm::dvec3 at = place_of(a), to_b = place_of(b) - at, to_c = place_of(c) - at,
                   by_normal = own.by_normal + own.by_offset * at;
  const double length = glm::dot(unit, glm::cross(to_b, to_c));
  const glm::dvec3 by_turn = (by_normal - glm::dot(unit, by_normal) * unit) / length,
                   by_b = glm::cross(to_c, by_turn), by_c = glm::cross(by_turn, to_b);
  by_vertex_[a] += own.by_offset * unit - by_b - by_c;
  by_vertex_[b] += by_b;
  by_vertex_[c] += by_c;
}

void ImageAdjoint::finish() {
  for (std::size_t number = images_.size() - 1; number > 0; --number) {
    const Image& image = images_[number];
    const glm::dvec3 unit = image.last->unit_normal(), parent_m = at_m_[image.parent];
    const glm::dmat3 reflect = image.last->reflection();
    const std::size_t of_parent = images_[image.parent].leg.loss.rough_normals.size();
    for (std::uint32_t window = 0; window < image.origins.size(); ++window) {
      const WindowOrigin& origin = image.origins[window];
      Sums& own = sums_[number][window];
      Sums& parent = sums_[image.parent][origin.parent_window];
      finish_rays(number, window);
      for (std::size_t k = 0; k < of_parent; ++k) {
        const glm::dvec3 by = own.by_rough_normal[k];
        own.by_normal += by_normal_of_turn(unit, reflect * image.leg.loss.rough_normals[k], by);
        parent.by_rough_normal[k] += reflect * by;
      }
      const double along = glm::dot(unit, own.by_apex);
      parent.by_apex += own.by_apex - 2 * along * unit;
      own.by_normal -=
          2.0 * ((glm::dot(unit, parent_m) - offset_m(*image.last, transmit_apex_, unit_m_)) * own.by_apex +
                 along * parent_m);
      own.by_offset += 2 * along;
      finish_mirror(image, origin, own);
    }
  }
  const TubeSet& tubes = images_.front().windows;
  for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube) {
    by_apex_ += sums_[0][tube].by_apex;
    for (std::size_t k = 0; k < 4; ++k) by_ray_[tubes.tubes[tube][k]] += sums_[0][tube].by_ray[k];
  }
}

}  // namespace tubefoot
