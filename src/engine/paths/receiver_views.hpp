// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "engine/paths/image_tree.hpp"
#include "engine/paths/visible_surface.hpp"
#include "engine/scattering/facet_map.hpp"
#include "geometry/integrals/measure.hpp"

// What receives the last scattering, and how a facet is met from anywhere, through whatever water.
// docs/paths.md
namespace tubefoot {

/// What an image of a receiver sees, or those of both ends of a receiver pair in the same mirrors, by facet,
/// in coordinates of the plane that the facet lies in: made once for all points that light it.
class ReceiverViews {
 public:
  /// `apex_m`: where the image is, in the frame of the points that will be asked about; `seabed`: what it
  /// sees.
  ReceiverViews(const Image& received, glm::dvec3 apex_m, VisibleSurface seabed);
  /// What two images both see, told as the upper one tells it.
  ReceiverViews(const ReceiverViews& upper, const ReceiverViews& lower);

  struct End {
    const Image* image;
    glm::dvec3 apex_m;
    std::shared_ptr<const std::vector<RefractedFacet>> refracted;  ///< empty where rays are straight
  };
  /// Part of a facet: what lies in all of its polygons.
  struct Piece {
    std::uint32_t tube = 0;                     ///< of the (upper) image
    std::array<std::size_t, 2> seen_as{};       ///< by end: bent facet, where rays are bent
    std::vector<std::vector<glm::dvec2>> seen;  ///< by end
    glm::dvec2 low{0}, high{0};                 ///< holds it
  };
  struct Facet {
    FacetId facet = 0;
    FacetPlane plane;  ///< from the (upper) image; in refracting water that may be behind it
    PlaneFrame frame{FacetPlane{}};
    std::array<double, 2> height_m{};  ///< of each end over it
    std::vector<Piece> pieces;
  };
  /// Null if the side of a facet that a normal points to is not seen.
  const Facet* find(FacetId facet, glm::dvec3 normal) const;
  /// The upper one first.
  const std::vector<End>& ends() const { return ends_; }
  const Image& image() const { return *ends_.front().image; }
  /// Image::largest, of the end that has less.
  double largest() const;
  /// Null where rays are straight.
  const RefractedFacet* refracted_of(const Piece& piece, std::size_t end) const {
    const std::vector<RefractedFacet>& refracted = *ends_[end].refracted;
    return refracted.empty() ? nullptr : &refracted[piece.seen_as[end]];
  }

 private:
  std::vector<End> ends_;
  std::vector<Facet> facets_;  // by id
};

/// A point, or an image of a receiver, over a facet; places on that in coordinates of its frame.
class OverFacet {
 public:
  OverFacet() = default;
  /// `from_received_m`: where it is, from the (upper) image that `facet` is reported by; `refracted`: how it
  /// sees the facet, null where rays are straight.
  OverFacet(const ReceiverViews::Facet& facet, glm::dvec3 from_received_m, double height_m,
            const RefractedFacet* refracted);

  /// Where a place is seen, or seems to be, from here.
  const LyingPlane& seen() const { return seen_; }
  double range(glm::dvec2 p) const {
    if (refracted_ != nullptr) return glm::length(seen_.at(p));
    const glm::dvec2 away = p - foot_;
    return std::sqrt(height_ * height_ + glm::dot(away, away));
  }
  /// Of the range, which is known.
  glm::dvec2 slope(glm::dvec2 p, double range) const {
    if (refracted_ == nullptr) return (p - foot_) / range;
    const glm::dvec3 at = seen_.at(p);
    return glm::dvec2(glm::dot(at, seen_.u), glm::dot(at, seen_.v)) / range;
  }
  /// No less than the range changes over a metre.
  double steepest() const { return steepest_; }

  /// A place as it is met from here.
  struct Met {
    double range = 0, sine = 0;
    glm::dvec3 direction{0};  ///< in which it is seen, unit vector
    glm::dvec3 lies_m{0};     ///< from here
    double tx = 1, rx = 1;    ///< spreading and absorption over those of the straight way
  };
  Met meet(glm::dvec2 p) const {
    if (refracted_ != nullptr) return meet_refracted(p);
    Met met;
    const glm::dvec2 away = p - foot_;
    met.range = std::sqrt(height_ * height_ + glm::dot(away, away));
    const double per_range = 1 / met.range;
    met.sine = height_ * per_range;
    met.lies_m = lies_.at(away);
    met.direction = met.lies_m * per_range;
    return met;
  }

 private:
  Met meet_refracted(glm::dvec2 p) const;

  double height_ = 0;   // over the plane
  glm::dvec2 foot_{0};  // its foot point
  const RefractedFacet* refracted_ = nullptr;
  LyingPlane seen_;  // where the plane's points are seen, from here
  LyingPlane lies_;  // where they lie; in isovelocity water from the foot point on
  double steepest_ = 1;
};

/// Twice the area of a polygon; below 0 if it turns the other way.
double turning(const std::vector<glm::dvec2>& polygon);

}  // namespace tubefoot
