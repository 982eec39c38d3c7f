// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <span>

#include "engine/scattering/density.hpp"
#include "engine/scattering/echo_model.hpp"
#include "engine/visibility/common_visibility.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/integrals/path_cut.hpp"

// Defines the geometry and the integrand of a path on the plane of one facet. It covers bistatic sonars,
// mirrors and refracting water. The integrand for one area element is in `density.hpp`.

namespace tubefoot {

/// Position of an apex above a facet's plane.
struct EndOverPlane {
  PathCutter::Receiver over;  ///< distance from the plane, and foot point
  LyingPlane seen;            ///< plane as the apex sees it, relative to the apex
  bool flattened = false;     ///< ranges differ from distances of apparent positions (BistaticFacet)

  double range(const glm::dvec2& p) const {
    return std::hypot(over.distance, p.x - over.foot.x, p.y - over.foot.y);
  }
  /// Unit vector to p at the range `range_m`.
  glm::dvec3 direction(const glm::dvec2& p, double range_m) const {
    return flattened ? seen.towards(p) : seen.at(p) / range_m;
  }
};

/// Path on the plane of one facet, in coordinates of a PlaneFrame. Its origin is the foot point of the
/// transmit leg's apex, and for a pair of channels that of the first channel. Computes the echo of an area
/// element (density.hpp) with all factors except patterns.
struct PathOnFacet {
  EndOverPlane tx, rx;
  SurfaceProperties seabed;
  LyingPlane lies;  ///< true plane, for the texture
  double beta_per_m = 0;
  const MirrorLoss *tx_loss = nullptr, *rx_loss = nullptr;  ///< null: no loss

  PathOnFacet() = default;
  /// For a facet at its true position. `plane`: as seen from the origin of the frame.
  PathOnFacet(const FacetPlane& plane, const PlaneFrame& frame, const PathCutter::Receiver& tx_over,
              const PathCutter::Receiver& rx_over, FacetId facet, const EchoModel& model);
  /// For a facet that both ends see at different apparent positions.
  PathOnFacet(const BistaticFacet& bistatic, FacetId facet, const EchoModel& model);

  /// For a uniform surface without mirrors.
  double density_at(double tx_range_m, double rx_range_m) const {
    return density_between(tx.over.distance, rx.over.distance, tx_range_m, rx_range_m);
  }
  /// The same for apexes at other distances from the plane.
  double density_between(double tx_distance_m, double rx_distance_m, double tx_range_m,
                         double rx_range_m) const {
    const auto two_way = TwoWayRange<double>::of(tx_range_m, rx_range_m);
    if (seabed.scattering == nullptr)
      return seabed.mu * tx_distance_m * rx_distance_m * lambert_density(two_way, beta_per_m);
    const double sigma = std::sqrt(cross_section(*seabed.scattering, tx_distance_m, tx_range_m) *
                                   cross_section(*seabed.scattering, rx_distance_m, rx_range_m));
    return seabed.factor * density(sigma, two_way, beta_per_m);
  }
  double texture_at(const glm::dvec2& p) const {
    return seabed.texture == nullptr ? 1 : seabed.texture->factor(lies.at(p));
  }
  /// Unit vectors from both apexes to a point.
  struct Directions {
    glm::dvec3 tx{0}, rx{0};
  };
  Directions directions(const glm::dvec2& p, double tx_range_m, double rx_range_m) const {
    return {tx.direction(p, tx_range_m), rx.direction(p, rx_range_m)};
  }
  /// Energy factor of the mirrors.
  double passed(const Directions& towards) const {
    double part = 1;
    if (tx_loss != nullptr) part *= tx_loss->at(towards.tx);
    if (rx_loss != nullptr) part *= rx_loss->at(towards.rx);
    return part;
  }
  /// Energy of 1 m² without patterns. `factor`: texture. Directions are read only over mirrors.
  double energy(double tx_range_m, double rx_range_m, const Directions& towards, double factor = 1) const {
    return density_at(tx_range_m, rx_range_m) * factor * passed(towards);
  }
  bool over_mirrors() const { return tx_loss != nullptr || rx_loss != nullptr; }

 private:
  void finish(const EchoModel& model);
};

/// Path on facet `number` of a bistatic visibility. `frame`: frame of the facet's plane.
PathOnFacet path_on(const CommonVisibility& visibility, std::size_t number, const PlaneFrame& frame,
                    const EchoModel& model);
/// Distance of a point from a plane, and its foot point. `at_m`: position relative to the origin of the
/// frame.
PathCutter::Receiver over_plane(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 at_m);
/// Assigns the polygon of a part of a facet that the transmit leg sees. `bistatic`: facet that both ends see
/// at different apparent positions; null: true position.
void assign(PlanarPolygon& polygon, std::span<const glm::dvec3> corners_m, const FacetPlane& plane,
            const PlaneFrame& frame, const BistaticFacet* bistatic);

/// Largest angle, at most 1, for which `growth` of half the angle is at most 3. `growth` describes an
/// integrand in the complex plane. Rules with few nodes resolve such an angle.
template <class Growth>
double resolution_of(const Growth& growth) {
  double angle = 1;
  while (growth(angle / 2) > 3 && angle > 1e-6) angle /= 2;
  return angle;
}

/// Angle over which the losses of rough mirrors change little. They change by the factor e if the sum of the
/// squared sines changes by 1 / roughness. The result is 1 without rough mirrors. It has a lower limit,
/// below which cells are halved as the loss requires.
double smooth_angle_rad(const Path& path);

/// Smoothness of an integrand over a facet.
struct Smoothness {
  double angle_rad = 1;   ///< angle at either apex over which the integrand is smooth
  bool cornered = false;  ///< model with kinks
  bool tables = false;    ///< tabulated patterns
  bool textured = false;  ///< texture: analytic over its cells, with unknown extent in the complex plane
  bool limited = false;   ///< gains below a limit count as 0 (BeamPatterns::least)

  void take(const SurfaceProperties& seabed);
  /// For the product of both patterns.
  void take(const Directivity& sent, const Directivity& received);
  PathCutter::Work work(double tolerance) const;
};

}  // namespace tubefoot
