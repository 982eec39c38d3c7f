// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <tuple>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/flat_facet.hpp"

// Encloses a facet as one end of a path sees it through stratified water. The enclosures contain ranges,
// grazing angles and sound speeds, with derivatives over the facet's plane. It also describes the facet's
// plane after flattening between two ends. See docs/notes/certified-energies.md, section "Of two ends".
namespace tubefoot {

/// Rays from an end over a box of a facet's plane, in the unfolded water. Over an odd number of mirrors the
/// box is flipped vertically.
struct EndPatch {
  RayJets rays;
  Jet distance2;                      ///< squared distance of points from the apex
  Jet sine_m;                         ///< sine of the grazing angle on arrival, times the distance
  Interval speed;                     ///< sound speed at the points
  Interval log_speed_a, log_speed_b;  ///< slopes of the logarithm of the sound speed
  std::array<Interval, 3> place;      ///< relative to the apex
};

/// A facet as one end of a path sees it.
class EndOfFacet {
 public:
  /// `lies`: true corners in the local frame, each known to within `pad_m`. `seen`: apparent corners
  /// relative to the end.
  EndOfFacet(const BistaticEnd& end, const FlatFacet& flat, const FacetCorners& lies, double pad_m,
             const FacetCorners& seen);

  /// Returns nothing if it is not proven that one ray leads to each point.
  std::optional<EndPatch> over(const Interval& a, const Interval& b) const {
    return over(padded(centre_), a, b);
  }
  bool valid() const { return valid_; }
  const EndPatch& middle() const { return middle_; }
  const EndPatch& corner(int k) const { return corner_[k]; }
  /// Encloses the ray to a single point, in the coordinates of lies(). The point counts as exact.
  std::optional<EndPatch> at(const glm::dvec3& place) const {
    return over({place.x, place.y, place.z}, 0.0, 0.0);
  }
  /// Encloses the gradient of the range with respect to position over a patch.
  std::array<Interval, 3> change(const EndPatch& patch) const;
  const FacetCorners& lies() const { return lies_; }
  const glm::dvec3& seen_normal() const { return seen_normal_; }
  double facing() const { return facing_; }
  double off_m() const { return off_m_; }
  double reference_speed() const { return end_.rays.reference_speed_m_s(); }

 private:
  glm::dvec3 turned(const glm::dvec3& x) const { return {x.x, x.y, sign_ * x.z}; }
  glm::dvec3 way_to(const glm::dvec3& place_m) const {
    return end_.water.unfolded(place_m) - end_.water.apex_m();
  }
  std::array<Interval, 3> padded(const glm::dvec3& p) const {
    std::array<Interval, 3> box;
    for (int i = 0; i < 3; ++i) box[std::size_t(i)] = Interval(p[i] - pad_m_, p[i] + pad_m_);
    return box;
  }
  std::optional<EndPatch> over(const std::array<Interval, 3>& origin, const Interval& a,
                               const Interval& b) const;

  const BistaticEnd& end_;
  double sign_;
  glm::dvec3 u_, v_, normal_, centre_{0}, seen_normal_{0};
  double source_depth_m_, pad_m_;
  FacetCorners lies_{}, seen_{};
  std::array<EndPatch, 3> corner_;
  EndPatch middle_;
  double facing_ = 0, off_m_ = 0;
  bool alone_ = false, valid_ = false;
};

/// Affine map from offsets (a, b) from the middle of a facet's plane to the flattened plane, relative to the
/// foot point of one apex.
struct Flattened {
  glm::dvec2 middle, along_a, along_b;
  double height = 0;

  Flattened(const FlatFacet& flat, const std::array<glm::dvec2, 3>& corner, const glm::dvec2& foot,
            double above)
      : height(above) {
    std::tie(along_a, along_b) = flat.slopes_to(corner);
    middle = (corner[0] + corner[1] + corner[2]) / 3.0 - foot;
  }
  /// Squared flattened ranges.
  Jet range2(const Interval& a, const Interval& b) const {
    Jet sum(Interval(height) * height);
    for (int k = 0; k < 2; ++k) {
      Jet x;
      x.v = middle[k] + a * along_a[k] + b * along_b[k];
      x.a = along_a[k];
      x.b = along_b[k];
      sum = sum + squared(x);
    }
    return sum;
  }
};

}  // namespace tubefoot
