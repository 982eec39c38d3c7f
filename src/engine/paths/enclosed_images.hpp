// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/certified_arrival.hpp"
#include "engine/paths/refracted_images.hpp"
#include "engine/scattering/echo_model.hpp"

// What is proven of images in refracting water. docs/paths.md, "Certified paths"
namespace tubefoot {

/// Windows of images are made of what apparent facets leave of mirrors, and so may be off by as much as
/// those.
class EnclosedImages {
 public:
  /// `lists`: images, each end's by increasing number of mirrors; they and all else outlive this. `model`:
  /// that of the mirrors' seabed; `reflection`: by material, as Mirrors has it.
  EnclosedImages(RefractedImages& images, const EchoModel& model, std::span<const double> reflection,
                 std::initializer_list<std::span<const Image>> lists);
  ~EnclosedImages();

  BistaticSurface seabed_between(const Image& sent, const Image& received) const {
    return images_.seabed_between(sent, received);
  }
  /// No wall of its windows is farther from where it should be; 0 of an end's own tubes.
  double off_rad(const Image& image) const;
  /// Whether a direction is so near to where the windows of a fan end that it may be in one of them or not.
  /// `fans`: by window, empty: one fan.
  bool is_near_border(const Image& image, std::span<const std::uint32_t> fans, std::uint32_t fan,
                      glm::dvec3 direction) const;

  /// Of ways over more mirrors than that, nothing is known of what comes along rays longer than that.
  struct Unknown {
    std::size_t mirrors = 0;
    double from_m = 0;
  };
  const std::vector<Unknown>& unknown() const { return unknown_; }

  /// The ray from an image to a place.
  struct Ray {
    std::optional<MirroredRay> ray{};  ///< in doubles; none: there may be others, or none
    std::optional<EnclosedRay> enclosed{};
    double soonest_m = 0;      ///< no ray is shorter
    bool may_be_seen = false;  ///< whether any window looks where it may be
    /// Whether it passes all facets; none: that is not certain.
    std::optional<bool> passes{};
  };
  Ray ray_to(const Image& image, GridPoint place);

 private:
  struct Seabed;
  const Seabed& seabed_of(const Image& image);
  void look_at_windows(const Image& image, const Seabed& seabed, std::span<const double> reflection,
                       double& off_rad);

  RefractedImages& images_;
  const EchoModel& model_;
  std::map<std::size_t, std::unique_ptr<const Seabed>> seabeds_;  ///< by way
  std::map<std::size_t, double> beyond_;                          ///< by way: of windows that its images make
  std::vector<Unknown> unknown_;
};

}  // namespace tubefoot
