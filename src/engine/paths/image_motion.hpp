// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/gradient/bistatic_gradient.hpp"
#include "engine/paths/image_tree.hpp"

namespace tubefoot {

/// Returns the offset of a mirror's plane from a point, along its unit normal.
double offset_m(const MirrorPlane& plane, GridPoint from, double unit_m);
/// Returns the part of the mesh that an image sees, with points of its own (NamedPoints), or null.
const FacetMesh* part_of(const Image& image);
/// Returns by window the number of rays of all previous windows (SharedFootprints::transmit_rays).
std::vector<std::uint32_t> first_rays_of(const Image& image);

/// Velocities of an apex and of its images, for several parameters at once. A window moves with the facet in
/// which its mirror lies, and with the corners from which it was made. The sea surface is horizontal and at
/// rest in the local frame. Source: docs/notes/gradients.md, "Mirrors".
class ImageMotion {
 public:
  /// `images`: a result of ImageFinder::images_of() with VisibilityOptions::corner_names. All arguments must
  /// outlive this object.
  ImageMotion(const FacetMesh& mesh, double unit_m, GridPoint transmit_apex, std::span<const Image> images,
              std::span<const EchoParameter> parameters);

  std::span<const Image> images() const { return images_; }
  /// Returns the place of an image relative to the transmitter.
  glm::dvec3 place(std::size_t image) const { return at_m_[image]; }
  /// Returns the velocity of an image relative to the transmitter, for one of its windows.
  glm::dvec3 of_image(std::size_t image, std::uint32_t window, std::size_t parameter) const {
    return of(image, window, parameter).apex;
  }
  /// Returns the velocity of MirrorLoss::rough_normals.
  glm::dvec3 of_rough_normal(std::size_t image, std::uint32_t window, std::size_t parameter,
                             std::size_t normal) const;
  /// Returns the velocity of a point relative to an image. Ray r of a name is number r - `first_ray` of
  /// TubeVisibility::rays.
  glm::dvec3 of_point(std::size_t image, std::uint32_t window, std::size_t parameter, PointId id,
                      glm::dvec3 at, std::uint32_t first_ray) const;

 private:
  /// Velocities for one window and one parameter. `normal` and `offset` are those of the last mirror.
  struct Velocities {
    glm::dvec3 apex{0}, normal{0};
    double offset = 0;
    std::array<glm::dvec3, 4> ray{};
  };
  const Velocities& of(std::size_t image, std::uint32_t window, std::size_t parameter) const {
    return velocities_[image][window * parameters_.size() + parameter];
  }
  void add_root(const Image& root, bool is_transmitter);
  void add_image(std::size_t number);
  void add_mirror(const Image& image, const WindowOrigin& origin, std::size_t parameter,
                  Velocities& to) const;
  void add_rays(const Image& image, std::uint32_t window, std::span<Velocities> to) const;
  glm::dmat3 of_reflection(const Image& image, const Velocities& of) const;
  glm::dvec3 of_cut(std::size_t image, std::size_t parameter, const Velocities& own, const PartVertex& vertex,
                    glm::dvec3 at_m) const;

  const FacetMesh& mesh_;
  double unit_m_;
  GridPoint transmit_apex_;
  std::span<const Image> images_;
  std::span<const EchoParameter> parameters_;
  std::vector<glm::dvec3> at_m_;                     // by image
  std::vector<std::vector<Velocities>> velocities_;  // [image][window, parameter]
  std::vector<std::vector<glm::dvec3>> of_normals_;  // [image][window, parameter, rough normal]
};

/// One of these images as the end of paths.
class MovingImage : public EndMotion {
 public:
  MovingImage(const ImageMotion& motion, std::size_t image)
      : motion_(motion), image_(image), first_ray_(first_rays_of(motion.images()[image])) {}

  bool select(std::uint32_t window) override;
  glm::dvec3 of_end(std::size_t parameter) const override {
    return motion_.of_image(image_, window_, parameter);
  }
  glm::dvec3 of_point(std::size_t parameter, PointId id, glm::dvec3 at) const override {
    return motion_.of_point(image_, window_, parameter, id, at, first_ray_[window_]);
  }
  glm::dvec3 of_rough_normal(std::size_t parameter, std::size_t normal) const override {
    return motion_.of_rough_normal(image_, window_, parameter, normal);
  }
  const FacetMesh* part() const override { return part_of(motion_.images()[image_]); }

 private:
  const ImageMotion& motion_;
  std::size_t image_;
  std::uint32_t window_ = 0;
  std::vector<std::uint32_t> first_ray_;  // by window
};

}  // namespace tubefoot
