// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/flat_facet.hpp"

// A facet as one end of a path sees it, and as it is flattened between two.
namespace tubefoot {

/// Rays from an end over a box of a facet's plane. In the unfolded water: over an odd number of mirrors
/// upside down.
struct EndPatch {
  RayJets rays;
  Jet distance2;                      ///< of places from the apex
  Jet sine_m;                         ///< of the grazing angle where they arrive, times the distance
  Interval speed;                     ///< of sound there
  Interval log_speed_a, log_speed_b;  ///< slopes of its logarithm
  std::array<Interval, 3> place;      ///< from the apex
};

/// A facet as one end sees it.
class EndOfFacet {
 public:
  /// `lies`: its corners, in the local frame, each known to within `pad_m`; `seen`: where the end sees them,
  /// relative to it.
  EndOfFacet(const BistaticEnd& end, const FlatFacet& flat, const FacetCorners& lies, double pad_m,
             const FacetCorners& seen);

  /// None where it is not proven that there is one ray.
  std::optional<EndPatch> over(const Interval& a, const Interval& b) const {
    return over(padded(centre_), a, b);
  }
  bool valid() const { return valid_; }
  const EndPatch& middle() const { return middle_; }
  const EndPatch& corner(int k) const { return corner_[k]; }
  /// At a place as lies() has them, which is taken to be just there.
  std::optional<EndPatch> at(const glm::dvec3& place) const {
    return over({place.x, place.y, place.z}, 0.0, 0.0);
  }
  /// How ranges change with their places on a patch.
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

/// Where a facet's plane is laid out, by (a, b) from its middle, about one apex's foot point.
struct Flattened {
  glm::dvec2 middle, along_a, along_b;
  double height = 0;

  Flattened(const FlatFacet& flat, const std::array<glm::dvec2, 3>& corner, const glm::dvec2& foot,
            double above)
      : height(above) {
    const glm::dvec2 p = flat.at[1] - flat.at[0], q = flat.at[2] - flat.at[0], s = corner[1] - corner[0],
                     t = corner[2] - corner[0];
    const double det = cross(p, q);
    along_a = (s * q.y - t * p.y) / det;
    along_b = (t * p.x - s * q.x) / det;
    middle = (corner[0] + corner[1] + corner[2]) / 3.0 - foot;
  }
  /// Squared ranges.
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
