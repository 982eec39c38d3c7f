// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/paths/image_motion.hpp"

namespace tubefoot {

/// Derivatives of one value by the motion of an apex and of its images, in reverse mode (ImageMotion).
class ImageAdjoint {
 public:
  /// See ImageMotion. All arguments must outlive this object.
  ImageAdjoint(const FacetMesh& mesh, double unit_m, GridPoint transmit_apex, std::span<const Image> images);

  std::span<const Image> images() const { return images_; }
  /// Returns the place of an image relative to the transmitter.
  glm::dvec3 place(std::size_t image) const { return at_m_[image]; }
  /// Adds derivatives of the value: by the velocity of an image, of a point and of a rough normal.
  void add_image(std::size_t image, std::uint32_t window, glm::dvec3 by) {
    sums_[image][window].by_apex += by;
  }
  /// Ray r of a name is number r - `first_ray` of TubeVisibility::rays.
  void add_point(std::size_t image, std::uint32_t window, PointId id, glm::dvec3 by, std::uint32_t first_ray);
  void add_rough_normal(std::size_t image, std::uint32_t window, std::size_t normal, glm::dvec3 by);

  /// Converts all derivatives to those by vertices and by the tubes of the apex.
  void finish();
  /// By vertices of the mesh, relative to the transmitter.
  const std::vector<glm::dvec3>& by_vertex() const { return by_vertex_; }
  /// By TubeSet::rays of the apex.
  const std::vector<glm::dvec3>& by_ray() const { return by_ray_; }
  /// By a receive apex, relative to the transmitter.
  glm::dvec3 by_apex() const { return by_apex_; }
  /// By EchoParameter::apex_velocity.
  glm::dvec3 by_local_motion() const { return by_local_motion_; }

 private:
  /// Derivatives by the velocities of one window.
  struct Sums {
    glm::dvec3 by_apex{0}, by_normal{0};
    double by_offset = 0;
    std::array<glm::dvec3, 4> by_ray{};
    std::vector<glm::dvec3> by_rough_normal{};
  };
  void finish_rays(std::size_t number, std::uint32_t window);
  void finish_mirror(const Image& image, const WindowOrigin& origin, const Sums& own);
  glm::dvec3 place_of(VertexId vertex) const;

  const FacetMesh& mesh_;
  double unit_m_;
  GridPoint transmit_apex_;
  std::span<const Image> images_;
  std::vector<glm::dvec3> at_m_;         // by image
  std::vector<std::vector<Sums>> sums_;  // [image][window]
  std::vector<glm::dvec3> by_vertex_, by_ray_;
  glm::dvec3 by_apex_{0}, by_local_motion_{0};
};

/// One of these images as the end of paths.
class MovingImageAdjoint : public EndAdjoint {
 public:
  MovingImageAdjoint(ImageAdjoint& adjoint, std::size_t image)
      : adjoint_(adjoint), image_(image), first_ray_(first_rays_of(adjoint.images()[image])) {}

  void select(std::uint32_t window) override { window_ = window; }
  void add_end(glm::dvec3 by) override { adjoint_.add_image(image_, window_, by); }
  void add_point(PointId id, glm::dvec3 by) override {
    adjoint_.add_point(image_, window_, id, by, first_ray_[window_]);
  }
  void add_rough_normal(std::size_t normal, glm::dvec3 by) override {
    adjoint_.add_rough_normal(image_, window_, normal, by);
  }
  const FacetMesh* part() const override { return part_of(adjoint_.images()[image_]); }

 private:
  ImageAdjoint& adjoint_;
  std::size_t image_;
  std::uint32_t window_ = 0;
  std::vector<std::uint32_t> first_ray_;  // by window
};

}  // namespace tubefoot
