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

// Stores the surface that receivers of the last scattering see, per facet, and computes ranges, slopes and
// grazing angles on a facet from any point. Works in isovelocity and in refracting water. Source:
// docs/notes/multiple-paths.md, "Several scatterings".
namespace tubefoot {

/// Surface that an image of a receiver sees, or that both ends of a receiver pair over the same mirrors see.
/// Polygons are stored per facet in coordinates of the facet's plane. They are computed once for all points
/// that insonify the facet.
class ReceiverViews {
 public:
  /// `apex_m`: position of the image in the frame of these points. `seabed`: surface that the image sees.
  ReceiverViews(const Image& received, glm::dvec3 apex_m, VisibleSurface seabed);
  /// Common visibility of two images, in the coordinates of the upper one.
  ReceiverViews(const ReceiverViews& upper, const ReceiverViews& lower);

  struct End {
    const Image* image;
    glm::dvec3 apex_m;
    std::shared_ptr<const std::vector<RefractedFacet>> refracted;  ///< empty if rays are straight
  };
  /// Part of a facet: intersection of its polygons.
  struct Piece {
    std::uint32_t tube = 0;                     ///< tube of the (upper) image
    std::array<std::size_t, 2> seen_as{};       ///< index of the refracted facet per end, if rays are
                                                ///< refracted
    std::vector<std::vector<glm::dvec2>> seen;  ///< polygon per end
    glm::dvec2 low{0}, high{0};                 ///< bounding box
  };
  struct Facet {
    FacetId facet = 0;
    FacetPlane plane;  ///< from the (upper) image, which may lie behind it in refracting water
    PlaneFrame frame{FacetPlane{}};
    std::array<double, 2> height_m{};  ///< height of each end above the plane
    std::vector<Piece> pieces;
  };
  /// Returns the facet with its side that `normal` points to, or null if this side is not visible.
  const Facet* find(FacetId facet, glm::dvec3 normal) const;
  /// The upper end first.
  const std::vector<End>& ends() const { return ends_; }
  const Image& image() const { return *ends_.front().image; }
  /// Smaller value of Image::largest of the ends.
  double largest() const;
  /// Null if rays are straight.
  const RefractedFacet* refracted_of(const Piece& piece, std::size_t end) const {
    const std::vector<RefractedFacet>& refracted = *ends_[end].refracted;
    return refracted.empty() ? nullptr : &refracted[piece.seen_as[end]];
  }

 private:
  std::vector<End> ends_;
  std::vector<Facet> facets_;  // sorted by id
};

/// Geometry of a point, or of an image of a receiver, above a facet. Places have coordinates in the facet's
/// frame.
class OverFacet {
 public:
  OverFacet() = default;
  /// `from_received_m`: position of the point relative to the (upper) image of `facet`. `refracted`: facet
  /// as refracted for the point, or null if rays are straight.
  OverFacet(const ReceiverViews::Facet& facet, glm::dvec3 from_received_m, double height_m,
            const RefractedFacet* refracted);

  /// Plane of the apparent positions, from the point.
  const LyingPlane& seen() const { return seen_; }
  double range(glm::dvec2 p) const {
    if (refracted_ != nullptr) return glm::length(seen_.at(p));
    const glm::dvec2 away = p - foot_;
    return std::sqrt(height_ * height_ + glm::dot(away, away));
  }
  /// Gradient of the range at a place. `range`: range of this place.
  glm::dvec2 slope(glm::dvec2 p, double range) const {
    if (refracted_ == nullptr) return (p - foot_) / range;
    const glm::dvec3 at = seen_.at(p);
    return glm::dvec2(glm::dot(at, seen_.u), glm::dot(at, seen_.v)) / range;
  }
  /// Upper bound of the gradient's length.
  double steepest() const { return steepest_; }

  /// Properties of the ray to a place.
  struct Met {
    double range = 0, sine = 0;
    glm::dvec3 direction{0};  ///< apparent direction of the place, unit vector
    glm::dvec3 lies_m{0};     ///< position from the point
    double tx = 1, rx = 1;    ///< transmit and receive factors of spreading and absorption, relative to a
                              ///< straight path
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

  double height_ = 0;   // above the plane
  glm::dvec2 foot_{0};  // foot point of the perpendicular on the plane
  const RefractedFacet* refracted_ = nullptr;
  LyingPlane seen_;  // apparent positions of the plane, from the point
  LyingPlane lies_;  // true positions; in isovelocity water from the foot point
  double steepest_ = 1;
};

/// Twice the signed area of a polygon.
double turning(const std::vector<glm::dvec2>& polygon);

}  // namespace tubefoot
