// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/image_motion.hpp"

#include <glm/geometric.hpp>
#include <utility>

#include "geometry/footprints/corner_derivatives.hpp"
#include "geometry/numbers/grid_vector.hpp"

// Moves images with their mirrors, generation by generation. A reflection maps the parent image and the
// directions in which it sees the corners of the mirror.

namespace tubefoot {

double offset_m(const MirrorPlane& plane, GridPoint from, double unit_m) {
  const glm::dvec3 normal(double(plane.normal.x), double(plane.normal.y), double(plane.normal.z));
  return -static_cast<double>(plane.side(from)) / glm::length(normal) * unit_m;
}

const FacetMesh* part_of(const Image& image) { return image.vertex.empty() ? nullptr : image.mesh; }

std::vector<std::uint32_t> first_rays_of(const Image& image) {
  std::vector<std::uint32_t> first;
  std::size_t rays = 0;
  for (const TubeVisibility& seen : image.seen) {
    first.push_back(static_cast<std::uint32_t>(rays));
    rays += seen.rays.size();
  }
  return first;
}

ImageMotion::ImageMotion(const FacetMesh& mesh, double unit_m, GridPoint transmit_apex,
                         std::span<const Image> images, std::span<const EchoParameter> parameters)
    : mesh_(mesh),
      unit_m_(unit_m),
      transmit_apex_(transmit_apex),
      images_(images),
      parameters_(parameters),
      velocities_(images.size()),
      of_normals_(images.size()) {
  for (const Image& image : images)
    at_m_.push_back(displacement_m(transmit_apex, image.windows.apex, unit_m));
  add_root(images.front(), images.front().windows.apex == transmit_apex);
  for (std::size_t number = 1; number < images.size(); ++number) add_image(number);
}

void ImageMotion::add_root(const Image& root, bool is_transmitter) {
  for (std::size_t window = 0; window < root.windows.tubes.size(); ++window)
    for (const EchoParameter& parameter : parameters_)
      velocities_[0].emplace_back().apex =
          !is_transmitter && parameter.velocity ? parameter.velocity(receive_apex, at_m_[0]) : glm::dvec3(0);
}

void ImageMotion::add_image(std::size_t number) {
  const Image& image = images_[number];
  const glm::dvec3 normal = image.last->unit_normal();
  const double offset = offset_m(*image.last, transmit_apex_, unit_m_);
  const glm::dmat3 reflect = image.last->reflection();
  const std::vector<glm::dvec3>& rough = image.leg.loss.rough_normals;
  const std::size_t of_parent = images_[image.parent].leg.loss.rough_normals.size();
  const glm::dvec3 parent_m = at_m_[image.parent];
  velocities_[number].resize(image.origins.size() * parameters_.size());
  for (std::uint32_t window = 0; window < image.origins.size(); ++window) {
    const WindowOrigin& origin = image.origins[window];
    const std::span<Velocities> own =
        std::span(velocities_[number]).subspan(window * parameters_.size(), parameters_.size());
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      add_mirror(image, origin, n, own[n]);
      const glm::dvec3 parent = of_image(image.parent, origin.parent_window, n);
      own[n].apex =
          parent -
          2.0 * (own[n].normal * (glm::dot(normal, parent_m) - offset) +
                 normal * (glm::dot(own[n].normal, parent_m) + glm::dot(normal, parent) - own[n].offset));
      const glm::dmat3 turn = of_reflection(image, own[n]);
      // A rough mirror adds its own normal, which is at rest, after those of the parent.
      for (std::size_t k = 0; k < rough.size(); ++k)
        of_normals_[number].push_back(
            k < of_parent ? turn * (reflect * rough[k]) +
                                reflect * of_rough_normal(image.parent, origin.parent_window, n, k)
                          : glm::dvec3(0));
    }
    add_rays(image, window, own);
  }
}

/// Sets the velocity of the last mirror's plane, with the side of its normal.
void ImageMotion::add_mirror(const Image& image, const WindowOrigin& origin, std::size_t parameter,
                             Velocities& to) const {
  const glm::dvec3 unit = image.last->unit_normal();
  const EchoParameter& by = parameters_[parameter];
  if (origin.mirror == no_facet) {
    to.offset = -glm::dot(unit, by.apex_velocity);
    return;
  }
  if (!by.velocity) return;
  std::array<glm::dvec3, 3> at{}, moved{};
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexId vertex = mesh_.facets[origin.mirror][k];
    at[k] = displacement_m(transmit_apex_, mesh_.vertices[vertex], unit_m_);
    moved[k] = by.velocity(vertex, at[k]);
  }
  const glm::dvec3 to_b = at[1] - at[0], to_c = at[2] - at[0],
                   turned = glm::cross(moved[1] - moved[0], to_c) + glm::cross(to_b, moved[2] - moved[0]);
  const double length = glm::dot(unit, glm::cross(to_b, to_c));
  to.normal = (turned - glm::dot(unit, turned) * unit) / length;
  to.offset = glm::dot(to.normal, at[0]) + glm::dot(unit, moved[0]);
}

glm::dmat3 ImageMotion::of_reflection(const Image& image, const Velocities& of) const {
  const glm::dvec3 unit = image.last->unit_normal();
  return -2.0 * (glm::outerProduct(of.normal, unit) + glm::outerProduct(unit, of.normal));
}

/// A ray of a window is the reflected direction in which the parent sees a corner. Only the part of its
/// velocity across the ray has an effect.
void ImageMotion::add_rays(const Image& image, std::uint32_t window, std::span<Velocities> to) const {
  const Image& parent = images_[image.parent];
  const WindowOrigin& origin = image.origins[window];
  const NameContext context{mesh_, parent.windows.apex, parent.seen[origin.parent_window].rays};
  const NamedPoints points(context, unit_m_, part_of(parent));
  std::vector<PointVelocity> velocities;
  for (std::size_t n = 0; n < parameters_.size(); ++n)
    velocities.push_back([this, &image, &origin, n](PointId id, glm::dvec3 at) {
      return of_point(image.parent, origin.parent_window, n, id, at, 0);
    });
  CornerVelocities corners(points, std::move(velocities));
  const glm::dmat3 reflect = image.last->reflection();
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == 2 && origin.third_is_sum) continue;
    const WindowCorner& corner = origin.corners[k];
    glm::dvec3 direction = points.direction(corner.name);
    std::vector<glm::dvec3> by = corners.of_direction(corner.name);
    if (corner.other) {
      const glm::dvec3 other = points.direction(*corner.other), one = direction;
      const std::vector<glm::dvec3>& by_other = corners.of_direction(*corner.other);
      direction = one.z * other - other.z * one;
      for (std::size_t n = 0; n < by.size(); ++n)
        by[n] = by[n].z * other + one.z * by_other[n] - by_other[n].z * one - other.z * by[n];
    }
    const glm::dvec3 mirrored = reflect * direction,
                     ray = displacement({}, image.windows.rays[image.windows.tubes[window][k]]);
    const double scale = glm::dot(ray, mirrored) / glm::dot(mirrored, mirrored);
    for (std::size_t n = 0; n < by.size(); ++n)
      to[n].ray[k] = scale * (reflect * by[n] + of_reflection(image, to[n]) * direction);
  }
  for (Velocities& own : to)
    if (origin.third_is_sum) own.ray[2] = own.ray[1] + own.ray[3];
}

glm::dvec3 ImageMotion::of_rough_normal(std::size_t image, std::uint32_t window, std::size_t parameter,
                                        std::size_t normal) const {
  const std::size_t normals = images_[image].leg.loss.rough_normals.size();
  return of_normals_[image][(window * parameters_.size() + parameter) * normals + normal];
}

/// Velocity of the point at which the last mirror cuts a line of the mesh.
glm::dvec3 ImageMotion::of_cut(std::size_t image, std::size_t parameter, const Velocities& own,
                               const PartVertex& vertex, glm::dvec3 at_m) const {
  const MirrorPlane& plane = *images_[image].last;
  const glm::dvec3 unit = plane.unit_normal();
  const auto place = [&](VertexId id) { return displacement_m(transmit_apex_, mesh_.vertices[id], unit_m_); };
  const auto moved = [&](VertexId id) {
    const PointVelocity& velocity = parameters_[parameter].velocity;
    return velocity ? velocity(id, place(id)) : glm::dvec3(0);
  };
  const glm::dvec3 along = place(vertex.to) - place(vertex.from);
  const double rise = glm::dot(unit, along),
               share = (offset_m(plane, transmit_apex_, unit_m_) - glm::dot(unit, place(vertex.from))) / rise;
  const glm::dvec3 with_line = (1 - share) * moved(vertex.from) + share * moved(vertex.to);
  return with_line + (own.offset - glm::dot(own.normal, at_m) - glm::dot(unit, with_line)) / rise * along;
}

glm::dvec3 ImageMotion::of_point(std::size_t image, std::uint32_t window, std::size_t parameter, PointId id,
                                 glm::dvec3 at, std::uint32_t first_ray) const {
  const PointVelocity& velocity = parameters_[parameter].velocity;
  const Velocities& own = of(image, window, parameter);
  if (id & ray_bit) {
    if (image == 0) return velocity ? velocity(id, at) : glm::dvec3(0);
    // Further rays divide windows and move nothing.
    const std::uint32_t ray = (id & ~ray_bit) - first_ray;
    return ray < 4 ? own.ray[ray] : glm::dvec3(0);
  }
  const glm::dvec3 at_m = at + at_m_[image];
  const std::size_t vertices = mesh_.vertices.size();
  if (id >= vertices)
    return of_cut(image, parameter, own, images_[image].vertex[id - vertices], at_m) - own.apex;
  return (velocity ? velocity(id, at_m) : glm::dvec3(0)) - own.apex;
}

bool MovingImage::select(std::uint32_t window) {
  return std::exchange(window_, window) != window && image_ != 0;
}

}  // namespace tubefoot
