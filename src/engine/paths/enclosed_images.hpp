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

// Encloses images in refracting water for the reference. Source: docs/notes/certified-energies.md, "Over
// level mirrors".
namespace tubefoot {

/// Bounds of images. Apparent facets form the borders of windows, so a window has the same angular error as
/// these facets.
class EnclosedImages {
 public:
  /// `lists`: images of each end, in the order of their number of mirrors. `model`: model of the seabed of
  /// `images`. `reflection`: per material, as in Mirrors. All arguments must outlive this object.
  EnclosedImages(RefractedImages& images, const EchoModel& model, std::span<const double> reflection,
                 std::initializer_list<std::span<const Image>> lists);
  ~EnclosedImages();

  BistaticSurface seabed_between(const Image& sent, const Image& received) const {
    return images_.seabed_between(sent, received);
  }
  /// Bound of the angular error of the walls of its windows; 0 for the tubes of an end.
  double off_rad(const Image& image) const;
  /// Whether a direction is so near to the outer border of the windows of a fan that it may lie inside or
  /// outside. `fans`: fan per window; empty: one fan.
  bool is_near_border(const Image& image, std::span<const std::uint32_t> fans, std::uint32_t fan,
                      glm::dvec3 direction) const;

  /// On paths over more than `mirrors` mirrors, nothing is known of the energy along rays longer than
  /// `from_m`.
  struct Unknown {
    std::size_t mirrors = 0;
    double from_m = 0;
  };
  const std::vector<Unknown>& unknown() const { return unknown_; }

  /// Ray from an image to a place.
  struct Ray {
    std::optional<MirroredRay> ray{};  ///< in doubles; none: the number of rays is not proven to be one
    std::optional<EnclosedRay> enclosed{};
    double soonest_m = 0;      ///< lower bound of the length of a ray
    bool may_be_seen = false;  ///< whether a window contains a possible direction
    /// Whether no facet hides the ray; none: not certain.
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
  std::map<std::size_t, std::unique_ptr<const Seabed>> seabeds_;  ///< per chain of mirrors
  std::map<std::size_t, double> beyond_;                          ///< per chain of mirrors: error of the
                                                                  ///< windows that its images make
  std::vector<Unknown> unknown_;
};

}  // namespace tubefoot
